// SPDX-License-Identifier: Apache-2.0
// All targets' angles in one filter: x = [theta (N), l (N), rate (N)], l the logarithms of the signals' powers over
// that of the noise, and one covariance P (3N x 3N). An interval is used whole: its stochastic likelihood is maximised
// together with the prior by scoring, so that no angle has to be picked from a spectrum, and none associated.
//     m = [theta, l] = m0 + L u with L L' = P_mm;  u <- u + B^-1 (L' g - u),  B = I + L' J L
//     x = x0 + U' u,  P = [0 0; 0 P_rr - Y'Y] + Z'Z,  U = [L', Y],  Y = L^-1 P_mr,  B = B_L B_L',  Z = B_L^-1 U
// in which g and J are the likelihood's gradient and Fisher information at m, and prior coordinates u ~ N(0, I) spare
// the inverse of a covariance.
#pragma once

#include <array>

#include "truebearing/array/angle_likelihood.hpp"

namespace truebearing {

/// How targets move, and how their powers do. The spectral density of the angular acceleration follows a running mean
/// of the target's normalised innovations, a <- a + alpha (e - a): s = a^2 (2 - alpha) / alpha is about 1 while it goes
/// on as predicted, and grows where innovations keep to one side, as they do in a manoeuvre and not in noise.
struct JointAngleMotion {
  /// rad^2/s^3: clip(q0 max(s, .3)^2, q_low, q_high). Equal limits make it constant.
  double q0 = 0.0, q_low = 0.0, q_high = 0.0;
  double alpha = 0.3;
  /// Other limits while another target is predicted to be closer: what innovations say is of little worth then, and a
  /// rate that is forgotten in a crossing is what would tell the two apart after it.
  double close_rad = 0.0, close_q_low = 0.0, close_q_high = 0.0;
  double log_power_variance_per_s = 0.0;
};

struct JointAngleState {
  SignalVector x;
  SignalMatrix P;
  SignalVector q;            ///< process noise of each target until the next interval (N)
  SignalVector innovations;  ///< running means of the normalised innovations (N)

  int targets() const { return static_cast<int>(x.size()) / 3; }
  double angle(int n) const { return x[n]; }
  double log_power(int n) const { return x[targets() + n]; }
  double rate(int n) const { return x[2 * targets() + n]; }
};

/// Sets the process noise of `posterior` from what the interval said of `prior`.
void adapt(const JointAngleMotion& motion, const JointAngleState& prior, JointAngleState& posterior);

/// Crosses dt_s: the angles at constant rates, the powers at random.
void predict(JointAngleState& state, const JointAngleMotion& motion, double dt_s);

/// A target more, uncorrelated with the others and at rest.
struct NewTarget {
  double angle_rad, angle_sigma_rad;
  double log_power, log_power_sigma;
  double rate_sigma_radps;
  double q;
};
void add_target(JointAngleState& state, const NewTarget& target);
void remove_target(JointAngleState& state, int n);
/// The targets in the order of their angles.
void order_of_angles(const JointAngleState& state, std::array<int, kMaxSignals>& order);
/// Puts the targets in the order of their angles.
void sort_targets(JointAngleState& state);

class JointAngleUpdate {
 public:
  struct Options {
    int iterations = 5;
    double noise_power = 1.0;
    bool moving = false;  ///< blocks of the interval are moved apart by the predicted rates
  };

  /// The posterior of `prior`, whose angles are those at middle_s from the end of the interval. Scoring starts at
  /// `start` = [theta, l] (2N). False where the arithmetic fails; the posterior is then not to be used.
  bool run(const JointAngleState& prior, const RealInterval& interval, double middle_s, const SignalVector& start,
           const Options& options, JointAngleState& posterior) {
    return take_prior(prior) && find_mode(prior, interval, middle_s, start, options) &&
           give_posterior(prior, posterior);
  }
  /// The same in three steps. The first need not be repeated for another start, nor the last be taken for a mode that
  /// nobody wants.
  bool take_prior(const JointAngleState& prior);
  bool find_mode(const JointAngleState& prior, const RealInterval& interval, double middle_s, const SignalVector& start,
                 const Options& options);
  const SignalVector& mode() const { return m_; }  ///< [theta, l] (2N)
  bool give_posterior(const JointAngleState& prior, JointAngleState& posterior);

  /// Laplace's approximation of log p(interval | prior), at the mode that was found.
  double log_evidence() const { return log_evidence_; }
  const AngleLikelihood& likelihood() const { return likelihood_; }
  AngleLikelihood& likelihood() { return likelihood_; }

 private:
  AngleLikelihood likelihood_;
  double log_evidence_ = 0.0;
  SignalMatrix Ut_;                // [L; Y'] (3N x 2N)
  SignalMatrix Lt_, JL_, B_, Zt_;  // L', J L, the root of B (2N x 2N); Z' (3N x 2N)
  SignalVector u_, m_, step_, change_;
};

/// What an update made of target n, as one measurement of its angle by itself would have: its innovation, and the
/// variance of that. kLeastGain stands for none.
inline constexpr double kLeastGain = 1e-6;
struct EquivalentInnovation {
  double nu_rad = 0.0;
  double S_rad2 = 0.0;
  double gain = 0.0;
  double nis() const { return nu_rad * nu_rad / S_rad2; }
};
EquivalentInnovation equivalent_innovation(const JointAngleState& prior, const JointAngleState& posterior, int n);

}  // namespace truebearing
