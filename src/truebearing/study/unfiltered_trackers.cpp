// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/unfiltered_trackers.hpp"

#include <fmt/format.h>
#include <string>
#include <vector>

#include "truebearing/core/bounded.hpp"
#include "truebearing/tracker/raw_tracker.hpp"
#include "truebearing/tracker/recorded_tracker.hpp"

namespace truebearing {

std::unique_ptr<Tracker> make_raw_tracker(TableReader& table) {
  const std::vector<std::string> components = table.texts("components");
  const std::vector<double> sigma = table.numbers("sigma", static_cast<int>(components.size()), kPositive);
  if (components.size() > kMaxDimension)
    throw table.error("components", "are too many", fmt::format("at most {}", kMaxDimension));
  return std::make_unique<RawTracker>(
      state_space_of_components(components),
      BoundedVector(Eigen::Map<const Eigen::VectorXd>(sigma.data(), static_cast<Eigen::Index>(sigma.size()))));
}

std::unique_ptr<Tracker> make_recorded_tracker(TableReader& table) {
  if (!table.has("file")) {
    const std::vector<std::string> components = table.texts("components");
    if (!table.has("innovation")) throw table.error("innovation", "is missing", "true or false, or a key `file`");
    return std::make_unique<RecordedTracker>(state_space_of_components(components),
                                             table.boolean_or("innovation", false));
  }
  const std::string file = table.text("file");
  return std::make_unique<RecordedTracker>(read_step_log(table.resolve(file), table.text_or("tracker", "")));
}

}  // namespace truebearing
