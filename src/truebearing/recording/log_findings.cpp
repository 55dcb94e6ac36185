// SPDX-License-Identifier: Apache-2.0
// What of a measurement log's values is no measurement, and what is told of it.
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <string_view>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/farthest.hpp"
#include "truebearing/recording/recording_csv.hpp"

namespace truebearing {
namespace {

std::string count_of(std::size_t count, std::string_view what) {
  return count == 0 ? std::string() : fmt::format("{} {}", count, what);
}

std::string too_far_note(std::size_t rows) {
  if (rows == 0) return {};
  return fmt::format("{} row{} farther than {:g} m from the origin, where no tracker follows: subtract an origin", rows,
                     rows == 1 ? "" : "s", kFarthest_m);
}

}  // namespace

std::string LogFindings::note() const {
  std::vector<std::string> parts{left_out_note(left_out),
                                 count_of(late, "late rows put in order"),
                                 count_of(impossible, "impossible values taken for missing"),
                                 count_of(not_available, "values that say \"not available\""),
                                 count_of(at_zero, "plots at 0, 0 taken for missing"),
                                 too_far_note(too_far),
                                 count_of(of_others, "rows of other targets passed over")};
  std::erase(parts, std::string());
  return fmt::format("{}", fmt::join(parts, "; "));
}

// What no sensor measures is missing. Bearings that go on beyond a turn may come to 511 degrees, single ones do not.
void MeasurementLog::remove_impossible(Measurement& measurement) {
  constexpr double kTurn_deg = 360.0, kMostBearing_deg = 1e6;
  constexpr std::array kNoBearing_deg{511.0, -999.0, 999.0, -9999.0, 9999.0};
  for (std::size_t i = 0; i < layout_.z.size(); ++i) {
    const std::string& quantity = layout_.z[i].quantity;
    double& z = measurement.z(static_cast<Eigen::Index>(i));
    const double bearing_deg = quantity == "bearing_deg" ? degrees(z) : 0.0;
    const bool is_sentinel =
        !is_unwrapped_ && std::any_of(kNoBearing_deg.begin(), kNoBearing_deg.end(),
                                      [&](double none_deg) { return std::abs(bearing_deg - none_deg) < 1e-6; });
    const bool is_impossible = (quantity == "range_m" && z <= 0.0) || (quantity == "frequency_hz" && z <= 0.0) ||
                               std::abs(bearing_deg) > kMostBearing_deg;
    findings_.not_available += is_sentinel;
    findings_.impossible += is_impossible;
    if (is_sentinel || is_impossible)
      z = kNaN;
    else if (quantity == "bearing_deg" && !std::isnan(z))
      is_unwrapped_ = std::abs(bearing_deg) > kTurn_deg;
  }
}

// A plot at 0, 0, which says that there is none, amid others that are far from there: farther than a target that goes on
// as it came could be in some steps. And how many lie where no tracker follows.
void MeasurementLog::look_at_place(Measurement& measurement) {
  constexpr double kNear_m = 1000.0, kFewSteps = 10.0;
  double east_m = kNaN, north_m = kNaN;
  bool is_far = false;
  for (std::size_t i = 0; i < layout_.z.size(); ++i) {
    const std::string& quantity = layout_.z[i].quantity;
    const double z = measurement.z(static_cast<Eigen::Index>(i));
    if (quantity == "east_m") east_m = z;
    if (quantity == "north_m") north_m = z;
    is_far |= quantity.ends_with("_m") && std::abs(z) > kFarthest_m;
  }
  findings_.too_far += is_far;
  if (std::isnan(east_m) || std::isnan(north_m)) return;
  const Eigen::Vector2d place_m(east_m, north_m);
  if (place_m.isZero(0.0) && last_place_m_.norm() > std::max(kNear_m, kFewSteps * last_stride_m_)) {
    measurement.z.setConstant(kNaN);
    ++findings_.at_zero;
    return;
  }
  last_stride_m_ = (place_m - last_place_m_).norm();  // not a number before there are two
  last_place_m_ = place_m;
}

}  // namespace truebearing
