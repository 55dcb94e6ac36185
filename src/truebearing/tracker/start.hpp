// How a filter begins: from a prior that belongs to a time, or from its first two measurements.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace truebearing {

/// x ~ N(x, P) at time_s, before any measurement.
template <int N>
struct PriorStart {
  Eigen::Matrix<double, N, 1> x;
  Eigen::Matrix<double, N, N> P;
  double time_s = 0.0;
};

/// Two-point differencing (Bar-Shalom, Li and Kirubarajan 2001, sec. 5.5.3) of measured positions z1, z2 (d), dt apart,
/// for states [position (d), velocity (d)]: x = [z2, (z2 - z1) / dt], P = [R2, R2/dt; R2/dt, (R1 + R2)/dt^2].
struct TwoPointStart {};

template <int D>
struct TwoPointState {
  Eigen::Matrix<double, 2 * D, 1> x;
  Eigen::Matrix<double, 2 * D, 2 * D> P;
};

/// dt_s > 0.
template <int D>
TwoPointState<D> two_point_state(const Eigen::Matrix<double, D, 1>& z1, const Eigen::Matrix<double, D, D>& R1,
                                 const Eigen::Matrix<double, D, 1>& z2, const Eigen::Matrix<double, D, D>& R2,
                                 double dt_s) {
  TwoPointState<D> start;
  start.x << z2, (z2 - z1) / dt_s;
  start.P << R2, R2 / dt_s, R2 / dt_s, (R1 + R2) / (dt_s * dt_s);
  return start;
}

}  // namespace truebearing
