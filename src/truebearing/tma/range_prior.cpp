// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/range_prior.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace truebearing {
namespace {

double density(double u) {
  return std::exp(-0.5 * u * u) / std::sqrt(2.0 * std::numbers::pi);
}
// P(N(0, 1) > u), accurate in the tail.
double above(double u) {
  return 0.5 * std::erfc(u / std::numbers::sqrt2);
}

// Mean and covariance of a point at `length` in `direction`, from their standard deviations.
struct Polar {
  Eigen::Vector2d mean;
  Eigen::Matrix2d covariance;
};
Polar cartesian(double length, double length_sigma, double direction_rad, double direction_sigma) {
  const Eigen::Vector2d along(std::sin(direction_rad), std::cos(direction_rad)), across(along.y(), -along.x());
  // Across: the mean square of the length, since a guess may be as wide as it is long.
  const double squared = length * length + length_sigma * length_sigma;
  return {length * along, length_sigma * length_sigma * along * along.transpose() +
                              squared * direction_sigma * direction_sigma * across * across.transpose()};
}

}  // namespace

TruncatedNormal truncated_normal(double mean, double sigma, double low, double high) {
  double a = (low - mean) / sigma, b = (high - mean) / sigma;
  // Mirrored where both ends are below the mean, so that tails are differences of small numbers.
  const double side = b < 0.0 ? -1.0 : 1.0;
  if (side < 0.0) {
    const double swapped = -a;
    a = -b;
    b = swapped;
  }
  const double mass = above(a) - above(b);
  const double width = high - low;
  if (!(mass > 1e-280)) return {side < 0.0 ? high : low, width / std::sqrt(12.0), 0.0};
  const double shift = (density(a) - density(b)) / mass;
  const double edge = (std::isfinite(a) ? a * density(a) : 0.0) - (std::isfinite(b) ? b * density(b) : 0.0);
  const double variance = 1.0 + edge / mass - shift * shift;
  // Far out in a tail the difference cancels: no wider than uniform, no narrower than rounding allows.
  return {mean + side * sigma * shift, sigma * std::sqrt(std::max(variance, 1e-12)), mass};
}

bool RangePrior::suffices_with(const std::optional<TargetGuess>& guess) const {
  const bool speed_known = !course || std::isfinite(course->speed_mps) || (guess && std::isfinite(guess->speed_mps));
  return (guess || std::isfinite(range_m)) && speed_known;
}

TruncatedNormal RangePrior::range(const std::optional<TargetGuess>& guess) const {
  const double mean = guess ? guess->range_m : range_m, sigma = guess ? guess->range_sigma_m : range_sigma_m;
  if (!between) return {mean, sigma, 1.0};
  return truncated_normal(mean, sigma, between->low_m, between->high_m);
}

GaussianState RangePrior::state(double bearing_rad, double sigma_rad, const SensorState& sensor,
                                const std::optional<TargetGuess>& guess) const {
  const TruncatedNormal believed = range(guess);
  return state_at(believed.mean, believed.sigma, bearing_rad, sigma_rad, sensor, guess);
}

GaussianState RangePrior::state_at(double mean_m, double sigma_m, double bearing_rad, double sigma_rad,
                                   const SensorState& sensor, const std::optional<TargetGuess>& guess) const {
  const Polar position = cartesian(mean_m, sigma_m, bearing_rad, sigma_rad);
  GaussianState state{Eigen::Vector4d::Zero(), Eigen::Matrix4d::Zero()};
  state.x.head<2>() = sensor.position_m + position.mean;
  state.P.topLeftCorner<2, 2>() = position.covariance;
  if (!course) {
    state.P.bottomRightCorner<2, 2>() = velocity_sigma_mps * velocity_sigma_mps * Eigen::Matrix2d::Identity();
    return state;
  }
  const bool guessed = guess && std::isfinite(guess->speed_mps);
  const Polar velocity = cartesian(guessed ? guess->speed_mps : course->speed_mps,
                                   guessed ? guess->speed_sigma_mps : course->speed_sigma_mps,
                                   bearing_rad + course->from_bearing_rad, course->sigma_rad);
  state.x.tail<2>() = velocity.mean;
  state.P.bottomRightCorner<2, 2>() = velocity.covariance;
  return state;
}

}  // namespace truebearing
