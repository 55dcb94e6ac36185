// SPDX-License-Identifier: Apache-2.0
// Modified polar coordinates in the middle of a window of bearings (Aidala and Hammel 1983): what bearings determine
// well is kept apart from the range. Own ship's motion is its straight-line fit o(t) = a + b tau, tau = t - origin, and
// the rest d(t); relative to the line the target is at
//
//     y = [beta, beta', r'/r, rho = 1/r]  at origin
//     B = beta + atan2(beta' tau - rho d_perp, 1 + (r'/r) tau - rho d_par)
//
// with d_par, d_perp along and across (to starboard of) the direction beta. Where own ship has not manoeuvred, d = 0
// and rho drops out: the geometry does not determine the range.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <vector>

#include "truebearing/tma/bearing_window.hpp"
#include "truebearing/tma/normal_equations.hpp"

namespace truebearing {

class ModifiedPolar {
 public:
  /// Residuals beyond `huber_sigmas` count as those of a Huber loss.
  explicit ModifiedPolar(double huber_sigmas = std::numeric_limits<double>::infinity()) : huber_sigmas_(huber_sigmas) {}

  /// Two or more bearings at different times, which must outlive this or the next call. Allocates only where the window
  /// is longer than any before.
  void look_at(const BearingWindow& window);

  NormalEquations<4> operator()(const Eigen::Vector4d& y) const;

  double origin_s() const { return origin_s_; }
  /// Own ship's line: its position at origin_s() and its velocity.
  const Eigen::Vector2d& line_m() const { return line_m_; }
  const Eigen::Vector2d& line_mps() const { return line_mps_; }
  double length_s() const { return window_->last_time_s() - window_->first_time_s(); }
  /// Root mean square of d(t), m: how far own ship was from its line.
  double departure_m() const { return departure_m_; }
  /// The unit of the ranges that are worth looking at: 1 where own ship came between 700 m and 50 km far from where it
  /// began, and in proportion where it sailed less or more, so that 14 km is no more than twenty times its way, and
  /// 2.5 km no less than a twentieth. 1 where it did not move.
  double scale() const { return scale_; }
  /// rho worth looking at: of 1000 km, and of 10 m in that unit, for nearer there is only noise to explain.
  double least_inverse_range() const { return 1e-6 / std::max(scale_, 1.0); }
  double largest_inverse_range() const { return 0.1 / scale_; }

  /// beta and beta' by regression of the unwrapped bearings, r'/r = 0, at that range.
  Eigen::Vector4d start(double range_m) const;
  /// [east, north, v_east, v_north] at origin_s(), and its Jacobian dx/dy.
  Eigen::Vector4d to_cartesian(const Eigen::Vector4d& y) const;
  Eigen::Matrix4d jacobian(const Eigen::Vector4d& y) const;
  /// The way back; x not on own ship's line.
  Eigen::Vector4d from_cartesian(const Eigen::Vector4d& x) const;

 private:
  const BearingWindow* window_ = nullptr;
  double huber_sigmas_;
  double origin_s_ = 0.0;
  Eigen::Vector2d line_m_{0.0, 0.0}, line_mps_{0.0, 0.0};  // a, b
  std::vector<double> east_m_, north_m_;                   // d(t)
  double departure_m_ = 0.0, scale_ = 1.0;
  double bearing_rad_ = 0.0, bearing_radps_ = 0.0;  // of the regression, at origin_s_
};

}  // namespace truebearing
