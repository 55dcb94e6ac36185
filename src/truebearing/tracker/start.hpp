// How a filter begins: from a prior that belongs to a time, from its first measurement, or from its first two.
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

/// From one measured position z (d) with covariance R: x = [z, 0], P = diag(R, sigma^2).
struct OnePointStart {
  double velocity_sigma_mps = 0.0;  ///< per axis
  double rest_sigma = 0.0;          ///< of each component behind the velocities, which begin at 0
};

/// From another tracker's estimate (successor.hpp), and not before.
struct HandOverStart {
  double rest_sigma = 0.0;  ///< of each component that the other does not have; they begin at 0
};

/// Two-point differencing (Bar-Shalom, Li and Kirubarajan 2001, sec. 5.5.3) of measured positions z1, z2 (d), dt apart,
/// for states [position (d), velocity (d)]: x = [z2, (z2 - z1) / dt], P = [R2, R2/dt; R2/dt, (R1 + R2)/dt^2].
struct TwoPointStart {
  double rest_sigma = 0.0;  ///< of each component behind the velocities, which begin at 0
};

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

/// [x, 0] and diag(P, rest_sigma^2) with N components.
template <int N, int M>
PriorStart<N> lengthened(const Eigen::Matrix<double, M, 1>& x, const Eigen::Matrix<double, M, M>& P,
                         double rest_sigma) {
  static_assert(M <= N);
  PriorStart<N> start{Eigen::Matrix<double, N, 1>::Zero(),
                      rest_sigma * rest_sigma * Eigen::Matrix<double, N, N>::Identity()};
  start.x.template head<M>() = x;
  start.P.template topLeftCorner<M, M>() = P;
  return start;
}

}  // namespace truebearing
