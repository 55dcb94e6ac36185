// SPDX-License-Identifier: Apache-2.0
#include "app/tma_answer.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/linear_algebra.hpp"
#include "truebearing/evaluation/target_motion.hpp"

namespace truebearing {
namespace {

double compass_deg(double angle_rad) {
  const double angle_deg = std::fmod(degrees(angle_rad), 360.0);
  return angle_deg < 0.0 ? angle_deg + 360.0 : angle_deg;
}

}  // namespace

Motion::Motion(const Eigen::Vector4d& x, const SensorState& own_ship) {
  const Eigen::Vector2d offset_m = x.head<2>() - own_ship.position_m;
  range_m = offset_m.norm();
  bearing_deg = compass_deg(std::atan2(offset_m.x(), offset_m.y()));
  course_deg = compass_deg(std::atan2(x(2), x(3)));
  speed_mps = x.tail<2>().norm();
}

MotionSigmas::MotionSigmas(const Eigen::Vector4d& x, const Eigen::Matrix4d& P, const SensorState& own_ship) {
  const TargetMotionVariance variance = target_motion_variance(x, P, own_ship);
  const Eigen::Vector2d offset_m = x.head<2>() - own_ship.position_m;
  const Eigen::Vector2d across = Eigen::Vector2d(offset_m.y(), -offset_m.x()) / offset_m.squaredNorm();
  range_m = std::sqrt(variance.range_percent2) / 100.0 * offset_m.norm();
  bearing_deg = degrees(std::sqrt(across.dot(P.topLeftCorner<2, 2>() * across)));
  course_deg = std::sqrt(variance.course_deg2);
  speed_mps = std::sqrt(variance.speed_m2ps2);
}

Ellipse::Ellipse(const Eigen::Matrix4d& P) {
  const SymmetricModes<2> modes = symmetric_modes<2>(P.topLeftCorner<2, 2>());
  const double scale = std::sqrt(chi_square_quantile(0.95, 2.0));
  semi_minor_m = scale * std::sqrt(std::max(modes.values[0], 0.0));
  semi_major_m = scale * std::sqrt(std::max(modes.values[1], 0.0));
  const Eigen::Vector2d axis = modes.vectors.col(1);
  orientation_deg = std::fmod(compass_deg(std::atan2(axis.x(), axis.y())), 180.0);
}

bool range_is_known(const VelocityChange& change, const SensorState& own_ship) {
  constexpr double kLargest = 0.5;
  return MotionSigmas(change.x, change.P, own_ship).range_m < kLargest * Motion(change.x, own_ship).range_m;
}

std::optional<double> true_frequency(const TmaAnswer& answer) {
  if (!answer.truth || answer.truth->size() < 5 || !std::isfinite((*answer.truth)[4])) return std::nullopt;
  return (*answer.truth)[4];
}

std::string figure(double value, double sigma, int decimals) {
  if (!std::isfinite(value)) return "unknown";
  if (sigma > 0.0 && sigma < std::pow(10.0, -decimals))
    decimals = std::min(1 - static_cast<int>(std::floor(std::log10(sigma))), 12);
  return fmt::format("{:.{}f}", value, decimals);
}

std::string motion_with_sigmas(const Eigen::Vector4d& x, const Eigen::Matrix4d& P, const SensorState& own_ship) {
  const Motion motion(x, own_ship);
  const MotionSigmas sigma(x, P, own_ship);
  return fmt::format("range {} +- {} m, course {:.1f} +- {:.1f} deg, speed {} +- {} m/s",
                     figure(motion.range_m, sigma.range_m, 0), figure(sigma.range_m, sigma.range_m, 0),
                     motion.course_deg, sigma.course_deg, figure(motion.speed_mps, sigma.speed_mps, 2),
                     figure(sigma.speed_mps, sigma.speed_mps, 2));
}

std::string seconds(double time_s) {
  return fmt::format("{:.12g}", time_s);
}

}  // namespace truebearing
