// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/modified_polar.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/angle.hpp"
#include "truebearing/tma/bearing_sums.hpp"

namespace truebearing {
namespace {

double scale_of(double way_m) {
  constexpr double kNear_m = 2500.0, kFar_m = 14000.0, kWays = 20.0;
  if (!(way_m > 0.0)) return 1.0;
  return std::clamp(1.0, way_m / kWays / kNear_m, kWays * way_m / kFar_m);
}

}  // namespace

void ModifiedPolar::look_at(const BearingWindow& window) {
  window_ = &window;
  origin_s_ = 0.5 * (window.first_time_s() + window.last_time_s());
  const std::size_t m = window.size();
  east_m_.resize(m);
  north_m_.resize(m);

  // Sums about the middle of the window and about its first sensor position and bearing, so that none cancels.
  const Eigen::Vector2d site0_m = window.site_m(0);
  const double bearing0 = window.bearing_rad(0), count = static_cast<double>(m);
  double t1 = 0.0, t2 = 0.0, b1 = 0.0, bt = 0.0, unwrapped = 0.0;
  Eigen::Vector2d m1 = Eigen::Vector2d::Zero(), mt = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < m; ++i) {
    const double t = window.time_s(i) - origin_s_;
    const double turned = window.bearing_rad(i) - bearing0 - unwrapped;
    unwrapped += std::abs(turned) <= kPi ? turned : wrap_pi(turned);  // the same, and most need no division
    t1 += t;
    t2 += t * t;
    b1 += unwrapped;
    bt += unwrapped * t;
    m1 += window.site_m(i) - site0_m;
    mt += t * (window.site_m(i) - site0_m);
  }
  const double determinant = count * t2 - t1 * t1;
  bearing_radps_ = (count * bt - t1 * b1) / determinant;
  bearing_rad_ = bearing0 + (b1 - bearing_radps_ * t1) / count;
  line_mps_ = (count * mt - t1 * m1) / determinant;
  line_m_ = site0_m + (m1 - t1 * line_mps_) / count;
  double squares = 0.0, way_m = 0.0;
  for (std::size_t i = 0; i < m; ++i) {
    const Eigen::Vector2d d = window.site_m(i) - line_m_ - (window.time_s(i) - origin_s_) * line_mps_;
    east_m_[i] = d.x();
    north_m_[i] = d.y();
    squares += d.squaredNorm();
    way_m = std::max(way_m, (window.site_m(i) - site0_m).squaredNorm());
  }
  departure_m_ = std::sqrt(squares / count);
  scale_ = scale_of(std::sqrt(way_m));
}

NormalEquations<4> ModifiedPolar::operator()(const Eigen::Vector4d& y) const {
  const ModifiedPolarSums sums =
      modified_polar_sums({window_->size(), window_->time_s_.data(), window_->sine_.data(), window_->cosine_.data(),
                           window_->weight_.data(), east_m_.data(), north_m_.data()},
                          y.data(), origin_s_, huber_sigmas_);
  NormalEquations<4> equations;
  equations.cost = sums.cost;
  equations.gradient = Eigen::Map<const Eigen::Vector4d>(sums.gradient);
  for (int row = 0, k = 0; row < 4; ++row)
    for (int column = 0; column <= row; ++column, ++k) equations.A(row, column) = equations.A(column, row) = sums.A[k];
  return equations;
}

Eigen::Vector4d ModifiedPolar::start(double range_m) const {
  return {bearing_rad_, bearing_radps_, 0.0, 1.0 / range_m};
}

Eigen::Vector4d ModifiedPolar::to_cartesian(const Eigen::Vector4d& y) const {
  const Eigen::Vector2d along(std::sin(y[0]), std::cos(y[0])), across(along.y(), -along.x());
  Eigen::Vector4d x;
  x << line_m_ + along / y[3], line_mps_ + (y[2] * along + y[1] * across) / y[3];
  return x;
}

Eigen::Matrix4d ModifiedPolar::jacobian(const Eigen::Vector4d& y) const {
  const Eigen::Vector2d along(std::sin(y[0]), std::cos(y[0])), across(along.y(), -along.x());
  const double r = 1.0 / y[3];
  Eigen::Matrix4d T = Eigen::Matrix4d::Zero();
  T.topRows<2>().col(0) = r * across;
  T.topRows<2>().col(3) = -r * r * along;
  T.bottomRows<2>().col(0) = r * (y[2] * across - y[1] * along);
  T.bottomRows<2>().col(1) = r * across;
  T.bottomRows<2>().col(2) = r * along;
  T.bottomRows<2>().col(3) = -r * r * (y[2] * along + y[1] * across);
  return T;
}

Eigen::Vector4d ModifiedPolar::from_cartesian(const Eigen::Vector4d& x) const {
  const Eigen::Vector2d p = x.head<2>() - line_m_, v = x.tail<2>() - line_mps_;
  const double squared = p.squaredNorm();
  return {std::atan2(p.x(), p.y()), (v.x() * p.y() - v.y() * p.x()) / squared, p.dot(v) / squared,
          1.0 / std::sqrt(squared)};
}

}  // namespace truebearing
