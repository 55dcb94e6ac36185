// A figure that a problem has besides: an entry of `metrics` in the results.
#pragma once

#include <limits>
#include <optional>
#include <string>

namespace truebearing {

struct Metric {
  std::string name;  ///< "range_error_mean"
  std::string unit;  ///< "m", "percent"
  std::optional<double> time_s = std::nullopt;
  double value = std::numeric_limits<double>::quiet_NaN();
  double se = std::numeric_limits<double>::quiet_NaN();
};

/// Of a quantity with its unit ("velocity_mps"): the unit as it is printed ("m/s"), and the rest ("velocity").
std::string unit_of(const std::string& quantity);
/// The unit of its square: "(m/s)^2".
std::string squared_unit_of(const std::string& quantity);
std::string name_of(const std::string& quantity);

}  // namespace truebearing
