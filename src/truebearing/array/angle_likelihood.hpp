// SPDX-License-Identifier: Apache-2.0
// The stochastic likelihood of N uncorrelated signals at angles theta with powers exp(l), in noise of power sigma^2,
// and its scores: R = sum_n exp(l_n) a_n a_n' + sigma^2 I, all of it real (real_covariance.hpp).
//     log L = -Ns [log det R + tr(R^-1 R_hat)]
//     d log L / d theta_i = 2 Ns p_i (d_i' R^-1 R_hat R^-1 a_i - d_i' R^-1 a_i),  d = d a / d theta
//     d log L / d l_i     =   Ns p_i (a_i' R^-1 R_hat R^-1 a_i - a_i' R^-1 a_i)
// Fisher information J (Stoica and Nehorai 1990), with R^-1 by Woodbury's identity:
//     J(theta_i, theta_j) = 2 Ns p_i p_j [(a_j' R^-1 d_i)(a_i' R^-1 d_j) + (d_j' R^-1 d_i)(a_i' R^-1 a_j)]
//     J(theta_i, l_j)     = 2 Ns p_i p_j (a_j' R^-1 d_i)(a_i' R^-1 a_j)
//     J(l_i, l_j)         =   Ns p_i p_j (a_i' R^-1 a_j)^2
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "truebearing/array/real_covariance.hpp"
#include "truebearing/core/simd_width.hpp"

namespace truebearing {

inline constexpr int kMaxSignals = 12;
inline constexpr int kMaxAngleStates = 3 * kMaxSignals;
/// Of the joint states of all signals; no heap.
using SignalVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxAngleStates, 1>;
using SignalMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxAngleStates, kMaxAngleStates>;

class AngleLikelihood {
 public:
  /// Adds up over the blocks of an interval the log likelihood, its gradient (2N) and J (2N x 2N) at m = [theta, l]
  /// (2N). Block b has its targets at theta + (its time - middle_s) rate, with rate (N) or nothing. Returns false where
  /// a number is not finite or R is not positive definite. Allocates where the array is larger than any before.
  bool evaluate(const RealInterval& interval, const SignalVector& m, const SignalVector* rate, double middle_s,
                double noise_power);

  double log_likelihood() const { return log_likelihood_; }
  const SignalVector& gradient() const { return gradient_; }
  const SignalMatrix& information() const { return J_; }

  /// Of signal n by itself, summed over blocks: twice the log likelihood that it adds to the others, were its power the
  /// best for this interval. Of the last evaluate().
  double presence(int n) const;

  /// Estimate of the noise power from what of the last interval the signals do not explain.
  double residual_power() const { return residual_power_; }

  /// The best of one more signal on a grid of angles, as presence(), beside those of the last evaluate() (whose
  /// arguments these are). Targets are taken to stand still. log_power: what its power would be.
  struct Newcomer {
    double angle_rad = 0.0;
    double log_power = 0.0;
    double presence = 0.0;
  };
  Newcomer search(const RealInterval& interval, const SignalVector& m, const SignalVector* rate, double middle_s,
                  double noise_power, std::span<const double> grid_rad);

 private:
  using LaneVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, padded_to_widest(kMaxSignals), 1>;
  using LaneMatrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, padded_to_widest(kMaxSignals), kMaxSignals>;

  bool prepare_block(const RealArray& array, const RealCovariance& block, const SignalVector& m,
                     const SignalVector* rate, double middle_s, double noise_power);
  void resize(const RealArray& array, int N);

  double log_likelihood_ = 0.0;
  SignalVector gradient_;
  SignalMatrix J_;
  SignalVector expected_alone_, found_alone_;  // of each signal without the others, for its presence
  double snapshots_ = 0.0;
  double residual_power_ = 0.0;
  // Signals are lanes (angle_likelihood_kernels.hpp). Of the block at hand:
  Eigen::MatrixXd A_, D_, W_, V_, RW_;        // a, d, R^-1 a, R^-1 d, R_hat R^-1 a as rows (lanes x M)
  LaneVector theta_, p_;                      // angles and powers (lanes)
  LaneMatrix AA_, DA_, DD_;                   // A'A, D'A, D'D (lanes x N)
  LaneMatrix C_;                              // (sigma^2 P^-1 + A'A)^-1 (lanes x N)
  double log_det_ = 0.0;                      // of sigma^2 P^-1 + A'A
  LaneMatrix Et_, aRa_, dRa_, dRd_;           // D'A C, A' R^-1 A, D' R^-1 A, D' R^-1 D (lanes x N)
  LaneVector found_a_, found_d_, explained_;  // a' R^-1 R_hat R^-1 a, d' R^-1 R_hat R^-1 a, a' R_hat R^-1 a (lanes)
  LaneMatrix angles_, angle_power_, powers_;  // J(theta, theta), J(theta, l), J(l, l) (lanes x N)
  Eigen::VectorXd a_, d_, w_, Rw_;            // of an angle of a search: a, d, R^-1 a, R_hat R^-1 a (padded M)
  std::vector<double> found_, expected_;      // over the grid of a search
};

/// The real steering vector a at that angle and its derivative d, (padded) each.
void steer_real(const RealArray& array, double angle_rad, double* a, double* d);

}  // namespace truebearing
