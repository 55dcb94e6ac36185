// SPDX-License-Identifier: Apache-2.0
// A figure that a problem has besides, an entry of `metrics` in the results; and what two trackers differ by, one of
// `paired`.
#pragma once

#include <limits>
#include <optional>
#include <string>

namespace truebearing {

/// Where a figure is printed; in the results they all are.
enum class MetricTable : unsigned char { figures, tracks, none };

struct Metric {
  std::string name;  ///< "range_error_mean"
  std::string unit;  ///< "m", "percent"
  std::optional<double> time_s = std::nullopt;
  double value = std::numeric_limits<double>::quiet_NaN();
  double se = std::numeric_limits<double>::quiet_NaN();
  MetricTable table = MetricTable::figures;
};

/// Of two trackers a and b over the same runs: the mean over runs of a figure of a's run minus that of b's.
struct PairedDifference {
  std::string quantity;  ///< what the results call it: "position_m", "angle_deg2_clean_crossing"
  double mean = 0.0;
  double se = 0.0;         ///< the standard error of the mean
  std::string title = {};  ///< what tables call it: "position m", "angle deg^2, crossing"
  std::optional<double> time_s = std::nullopt;
  MetricTable table = MetricTable::figures;
};

/// Of a quantity with its unit ("velocity_mps"): the unit as it is printed ("m/s"), and the rest ("velocity").
std::string unit_of(const std::string& quantity);
/// The unit of its square: "(m/s)^2".
std::string squared_unit_of(const std::string& quantity);
std::string name_of(const std::string& quantity);
/// Both, as tables have them: "velocity m/s".
std::string title_of(const std::string& quantity);

}  // namespace truebearing
