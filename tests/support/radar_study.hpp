// SPDX-License-Identifier: Apache-2.0
// A small study of the 1-D radar, as the text of its files: quick to run, with everything in it that a study can have.
#pragma once

#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace truebearing::testing {

inline const std::string kScenario = R"(kind = "line"
period_s = 1.0
steps = 40
process_noise_variance = [5.0, 0.1]

[target]
position_m = { normal = [0.0, 1000.0] }
velocity_mps = { uniform = [-400.0, 400.0] }

[sensor]
position_variance_m2 = 1e7
)";

inline const std::string kStudy = R"(name = "small"
scenario = "scenario.toml"
parameters = "small.parameters.toml"
runs = 20
seed = 5

[scoring]
pairs = ["nfnn - tuned"]
loss_thresholds = { position_m = 20000.0 }

[tuning]
runs = 20

[trackers.plain]
kind = "kalman"
motion = { model = "constant_velocity", noise = "fixed", variance = [5.0, 0.1], period_s = 1.0 }
measurement = { model = "position", variance_m2 = 1e7 }
start = { kind = "prior", x = [0.0, 0.0], variance = [999.0, 999.0] }

[trackers.tuned]
like = "plain"
tune = ["start.variance"]

[trackers.wide]
like = "plain"
show = false
start = { variance = [1e6, 53333.3] }

[trackers.nfnn]
kind = "corrected"
base = "plain"
reference = "tuned"
covariance_of = "wide"
kappa = 3.0
model = "small.nfnn.json"
features = [
  { kind = "log_step" },
  { kind = "companion_difference", companion = "wide", component = "velocity_mps", scale = 100.0 },
  { kind = "log_mean_nis", offset = 0.05 },
]

[trackers.nfnn.training]
rules = 4
runs = 20
iterations = 10
mirror = true
)";

/// A recurrent network beside them.
inline const std::string kRecurrentStudy = kStudy + R"(
[trackers.gru]
kind = "corrected"
network = "gru"
base = "plain"
reference = "tuned"
kappa = 3.0
model = "small.gru.json"
features = [
  { kind = "innovation" },
  { kind = "companion_difference", companion = "wide", component = "velocity_mps", scale = 100.0 },
]

[trackers.gru.training]
units = 4
runs = 20
epochs = 6
batch = 8
)";

inline const std::string kParameters = "[tuned]\n\"start.variance\" = [1e6, 53000.0]\n";

/// The text with the first `from` in it replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  if (place == std::string::npos) throw std::logic_error("the text holds no " + from);
  return text.replace(place, from.size(), to);
}

/// Writes scenario, parameters and study into the folder and returns the study's path.
inline std::filesystem::path write_study(const TemporaryFolder& folder, const std::string& study = kStudy) {
  folder.write("scenario.toml", kScenario);
  folder.write("small.parameters.toml", kParameters);
  return folder.write("small.toml", study);
}

}  // namespace truebearing::testing
