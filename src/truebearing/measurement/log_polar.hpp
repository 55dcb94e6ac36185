// SPDX-License-Identifier: Apache-2.0
// Log-polar coordinates of a target in the plane relative to a sensor: y = [bearing, ln range, d bearing/dt, d ln
// range/dt] in rad, ln m and 1/s, from x = [east, north, v_east, v_north] in m and m/s. What a run of bearings alone
// tells and what it does not are different components here (Aidala and Hammel 1983, with ln range in place of
// 1/range).
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace truebearing {

/// y (4) of x (4); not finite at the sensor itself.
template <typename Scalar>
Eigen::Matrix<Scalar, 4, 1> log_polar(const Eigen::Matrix<Scalar, 4, 1>& x, const Eigen::Matrix<Scalar, 2, 1>& site_m,
                                      const Eigen::Matrix<Scalar, 2, 1>& site_velocity_mps) {
  const Eigen::Matrix<Scalar, 2, 1> d = x.template head<2>() - site_m, v = x.template tail<2>() - site_velocity_mps;
  const Scalar squared = d.squaredNorm();
  return {std::atan2(d.x(), d.y()), std::log(squared) / 2, (v.x() * d.y() - v.y() * d.x()) / squared,
          d.dot(v) / squared};
}

/// dy/dx (4 x 4) at x.
template <typename Scalar>
Eigen::Matrix<Scalar, 4, 4> log_polar_jacobian(const Eigen::Matrix<Scalar, 4, 1>& x,
                                               const Eigen::Matrix<Scalar, 2, 1>& site_m,
                                               const Eigen::Matrix<Scalar, 2, 1>& site_velocity_mps) {
  const Eigen::Matrix<Scalar, 2, 1> d = x.template head<2>() - site_m, v = x.template tail<2>() - site_velocity_mps;
  const Scalar inverse = 1 / d.squaredNorm();
  // With complex numbers d = north + i east, v alike: ln d = y1 + i y0 and w = v / d = y3 + i y2, so that d(ln d) = dd
  // / d and dw = dv / d - (w / d) dd, where 1 / d = a - i b and w / d = p + i q.
  const Scalar a = d.y() * inverse, b = d.x() * inverse;
  const Scalar turning = (v.x() * d.y() - v.y() * d.x()) * inverse, growing = d.dot(v) * inverse;
  const Scalar p = growing * a + turning * b, q = turning * a - growing * b;
  Eigen::Matrix<Scalar, 4, 4> G;
  G << a, -b, 0, 0,   //
      b, a, 0, 0,     //
      -p, -q, a, -b,  //
      q, -p, b, a;
  return G;
}

/// x (4) of y (4): the inverse.
template <typename Scalar>
Eigen::Matrix<Scalar, 4, 1> from_log_polar(const Eigen::Matrix<Scalar, 4, 1>& y,
                                           const Eigen::Matrix<Scalar, 2, 1>& site_m,
                                           const Eigen::Matrix<Scalar, 2, 1>& site_velocity_mps) {
  const Scalar range = std::exp(y(1));
  const Eigen::Matrix<Scalar, 2, 1> d(range * std::sin(y(0)), range * std::cos(y(0)));
  Eigen::Matrix<Scalar, 4, 1> x;
  x.template head<2>() = site_m + d;
  x(2) = site_velocity_mps.x() + y(3) * d.x() + y(2) * d.y();
  x(3) = site_velocity_mps.y() + y(3) * d.y() - y(2) * d.x();
  return x;
}

/// dx/dy (4 x 4) at y, which does not depend on the sensor.
template <typename Scalar>
Eigen::Matrix<Scalar, 4, 4> from_log_polar_jacobian(const Eigen::Matrix<Scalar, 4, 1>& y) {
  const Scalar range = std::exp(y(1)), east = range * std::sin(y(0)), north = range * std::cos(y(0));
  const Scalar v_east = y(3) * east + y(2) * north, v_north = y(3) * north - y(2) * east;
  Eigen::Matrix<Scalar, 4, 4> J;
  J << north, east, 0, 0,            //
      -east, north, 0, 0,            //
      v_north, v_east, north, east,  //
      -v_east, v_north, -east, north;
  return J;
}

}  // namespace truebearing
