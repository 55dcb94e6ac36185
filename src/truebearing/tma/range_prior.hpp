// SPDX-License-Identifier: Apache-2.0
// What is believed of a target when its first bearing comes in: the range by guess, its velocity by a spread. As a
// Gaussian state [east, north, v_east, v_north] in m and m/s, for filters to start from, for maximum a posteriori
// estimates and for posterior bounds. Arulampalam, Ristic, Gordon and Mansell 2004, sec. 5 for the Cartesian form.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "truebearing/measurement/measurement.hpp"

namespace truebearing {

/// Mean, standard deviation and share of N(mean, sigma^2) between `low` and `high`. Where the share underflows: the
/// nearer end, and a twelfth of the width squared.
struct TruncatedNormal {
  double mean;
  double sigma;
  double mass;
};
TruncatedNormal truncated_normal(double mean, double sigma, double low, double high);

struct GaussianState {
  Eigen::Vector4d x;
  Eigen::Matrix4d P;
};

/// What is believed of the velocity alone.
struct VelocityPrior {
  double sigma_mps = 0.0;  ///< mean zero, per axis
};

struct RangePrior {
  /// Of the range, where the measurement carries no guess; NaN where it has to.
  double range_m = std::numeric_limits<double>::quiet_NaN();
  double range_sigma_m = std::numeric_limits<double>::quiet_NaN();
  /// Where ranges of a family lie, uniformly: the range is then what is left of the guess between these (a matched
  /// start).
  struct Interval {
    double low_m;
    double high_m;
  };
  std::optional<Interval> between;
  /// Mean zero, per axis; or a course.
  double velocity_sigma_mps = 0.0;
  /// A speed on a course that is believed relative to the bearing: pi for a target that comes closer.
  struct Course {
    double speed_mps;  ///< where the measurement carries no guess; NaN where it has to
    double speed_sigma_mps;
    double from_bearing_rad;
    double sigma_rad;
  };
  std::optional<Course> course;
  /// In space: of the climb, mean zero; NaN: as uncertain as a component of the velocity along the ground.
  double climb_sigma_mps = std::numeric_limits<double>::quiet_NaN();

  /// False where neither this nor the guess says what range, or with a course what speed, to believe in. Nothing can
  /// start then.
  bool suffices_with(const std::optional<TargetGuess>& guess) const;
  /// Mean and standard deviation of the range.
  TruncatedNormal range(const std::optional<TargetGuess>& guess) const;
  /// The state as the first bearing comes in.
  GaussianState state(double bearing_rad, double sigma_rad, const SensorState& sensor,
                      const std::optional<TargetGuess>& guess) const;
  /// The same with another mean and spread of the range: one hypothesis of a bank.
  GaussianState state_at(double range_m, double range_sigma_m, double bearing_rad, double sigma_rad,
                         const SensorState& sensor, const std::optional<TargetGuess>& guess) const;
};

}  // namespace truebearing
