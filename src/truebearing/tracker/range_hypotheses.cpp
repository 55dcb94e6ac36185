// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/range_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace truebearing {
namespace {

// Of the interval number i of `count` between low and high in geometric progression. A guess from which all of them lie
// too far off to have a probability leaves the nearest.
TruncatedNormal range_cell(double mean, double sigma, double low, double high, int i, int count) {
  const auto edge = [&](int k) { return low * std::pow(high / low, static_cast<double>(k) / count); };
  TruncatedNormal cell = truncated_normal(mean, sigma, edge(i), edge(i + 1));
  const bool nearest = i == (mean < low ? 0 : count - 1);
  if (nearest && truncated_normal(mean, sigma, low, high).mass == 0.0) cell.mass = 1.0;
  return cell;
}

struct VelocityCell {
  Eigen::Vector2d mean;
  Eigen::Matrix2d covariance;
};

struct SpeedMoments {
  double mean;
  double square;
};

// Uniform between two ends, or of velocities that are normal about zero: Rayleigh distributed.
SpeedMoments speed_moments(const RangeHypotheses& hypotheses) {
  if (!hypotheses.speed_between_mps) {
    const double sigma = hypotheses.prior.velocity_sigma_mps;
    return {sigma * std::sqrt(std::numbers::pi / 2.0), 2.0 * sigma * sigma};
  }
  const auto [low, high] = *hypotheses.speed_between_mps;
  return {(low + high) / 2.0, (low * low + low * high + high * high) / 3.0};
}

// The moments of a velocity in one of `count` equal sectors: the course uniform within half a sector of the middle,
// independent of the speed.
VelocityCell velocity_cell(const SpeedMoments& speed, double middle_rad, int count) {
  const double half = std::numbers::pi / count;
  const double mean = speed.mean * std::sin(half) / half;
  const double squared_cosine = 0.5 + std::sin(2.0 * half) / (4.0 * half);
  const Eigen::Vector2d along(std::sin(middle_rad), std::cos(middle_rad)), across(along.y(), -along.x());
  return {mean * along, (speed.square * squared_cosine - mean * mean) * along * along.transpose() +
                            speed.square * (1.0 - squared_cosine) * across * across.transpose()};
}

}  // namespace

RangeHypotheses::Weighted RangeHypotheses::at(int i, double bearing_rad, double sigma_rad, const SensorState& sensor,
                                              const std::optional<TargetGuess>& guess) const {
  constexpr double kWidth = 2.5, kLeastShare = 0.05;
  const double mean = guess ? guess->range_m : prior.range_m;
  const double sigma = guess ? guess->range_sigma_m : prior.range_sigma_m;
  const double low =
      prior.between ? prior.between->low_m : std::max({mean - kWidth * sigma, kLeastShare * mean, least_range_m});
  const double high = prior.between ? prior.between->high_m : std::max(mean, low) + kWidth * sigma;
  const TruncatedNormal range = range_cell(mean, sigma, low, high, i / velocity_cells, ranges);
  Weighted weighted{prior.state_at(range.mean, range.sigma, bearing_rad, sigma_rad, sensor, guess),
                    std::log(range.mass)};
  if (velocity_cells == 1) return weighted;
  // Sectors begin along the line of sight, so that the bank turns with the picture.
  const double middle_rad = bearing_rad + 2.0 * std::numbers::pi * (i % velocity_cells) / velocity_cells;
  const VelocityCell velocity = velocity_cell(speed_moments(*this), middle_rad, velocity_cells);
  weighted.state.x.tail<2>() = velocity.mean;
  weighted.state.P.bottomRightCorner<2, 2>() = velocity.covariance;
  return weighted;
}

}  // namespace truebearing
