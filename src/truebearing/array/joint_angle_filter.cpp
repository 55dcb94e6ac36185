// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/joint_angle_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "truebearing/array/joint_angle_kernels.hpp"

namespace truebearing {
namespace {

// Of B = K D^-1 K', D the diagonal of K.
double log_determinant(const SignalMatrix& K) {
  return K.diagonal().array().log().sum();
}

constexpr double kLargestAngle_rad = 1.55;  // short of end-fire, where angles are no coordinates
constexpr double kLargestLogPower = 18.0;   // 80 dB
constexpr double kLargestStep_rad = 0.06;   // of one iteration, about half a beam
constexpr double kLargestLogPowerStep = 1.5;
constexpr double kConverged = 1e-4;  // squared step, in standard deviations of the prior

}  // namespace

void adapt(const JointAngleMotion& motion, const JointAngleState& prior, JointAngleState& posterior) {
  constexpr double kLargest = 5.0, kLeast = 0.3;
  const int N = prior.targets();
  for (int n = 0; n < N; ++n) {
    const EquivalentInnovation innovation = equivalent_innovation(prior, posterior, n);
    const double e = std::clamp(innovation.nu_rad / std::sqrt(innovation.S_rad2), -kLargest, kLargest);
    double& mean = posterior.innovations[n];
    mean += motion.alpha * (e - mean);
    const double s = std::max(mean * mean * (2.0 - motion.alpha) / motion.alpha, kLeast);
    bool close = false;
    for (int other = 0; other < N; ++other)
      close |= other != n && std::abs(prior.x[other] - prior.x[n]) < motion.close_rad;
    posterior.q[n] = std::clamp(motion.q0 * s * s, close ? motion.close_q_low : motion.q_low,
                                close ? motion.close_q_high : motion.q_high);
  }
}

void predict(JointAngleState& state, const JointAngleMotion& motion, double dt_s) {
  const int N = state.targets();
  SignalVector& x = state.x;
  SignalMatrix& P = state.P;
  const int r = 2 * N;
  for (int n = 0; n < N; ++n) x[n] = std::clamp(x[n] + dt_s * x[r + n], -kLargestAngle_rad, kLargestAngle_rad);
  for (int j = 0; j < 3 * N; ++j)  // rows: F P
    for (int n = 0; n < N; ++n) P(n, j) += dt_s * P(r + n, j);
  for (int n = 0; n < N; ++n)  // columns: F P F'
    for (int i = 0; i < 3 * N; ++i) P(i, n) += dt_s * P(i, r + n);
  for (int n = 0; n < N; ++n) {
    const double q = state.q[n];
    P(n, n) += q * dt_s * dt_s * dt_s / 3.0;
    P(n, r + n) += q * dt_s * dt_s / 2.0;
    P(r + n, n) += q * dt_s * dt_s / 2.0;
    P(r + n, r + n) += q * dt_s;
    P(N + n, N + n) += motion.log_power_variance_per_s * dt_s;
  }
}

namespace {

// The same state with its targets where `place` says, of those that were; -1 for one that was not there.
template <typename Place>
JointAngleState rearranged(const JointAngleState& state, int targets, const Place& place) {
  const int N = state.targets();
  JointAngleState other;
  other.x.setZero(3 * targets);
  other.P.setZero(3 * targets, 3 * targets);
  other.q.setZero(targets);
  other.innovations.setZero(targets);
  const auto from = [&](int i) { return place(i % targets) < 0 ? -1 : i / targets * N + place(i % targets); };
  for (int i = 0; i < 3 * targets; ++i) {
    if (from(i) < 0) continue;
    other.x[i] = state.x[from(i)];
    for (int j = 0; j < 3 * targets; ++j)
      if (from(j) >= 0) other.P(i, j) = state.P(from(i), from(j));
  }
  for (int n = 0; n < targets; ++n) {
    if (place(n) < 0) continue;
    other.q[n] = state.q[place(n)];
    other.innovations[n] = state.innovations[place(n)];
  }
  return other;
}

}  // namespace

void add_target(JointAngleState& state, const NewTarget& target) {
  const int N = state.targets();
  state = rearranged(state, N + 1, [&](int n) { return n < N ? n : -1; });
  const int angle = N, log_power = N + 1 + N, rate = 2 * (N + 1) + N;
  state.x[angle] = target.angle_rad;
  state.x[log_power] = target.log_power;
  state.P(angle, angle) = target.angle_sigma_rad * target.angle_sigma_rad;
  state.P(log_power, log_power) = target.log_power_sigma * target.log_power_sigma;
  state.P(rate, rate) = target.rate_sigma_radps * target.rate_sigma_radps;
  state.q[N] = target.q;
}

void remove_target(JointAngleState& state, int n) {
  state = rearranged(state, state.targets() - 1, [&](int i) { return i < n ? i : i + 1; });
}

void order_of_angles(const JointAngleState& state, std::array<int, kMaxSignals>& order) {
  const auto end = order.begin() + state.targets();
  std::iota(order.begin(), end, 0);
  std::sort(order.begin(), end, [&](int a, int b) { return state.x[a] < state.x[b]; });
}

void sort_targets(JointAngleState& state) {
  std::array<int, kMaxSignals> order{};
  order_of_angles(state, order);
  state = rearranged(state, state.targets(), [&](int n) { return order[static_cast<std::size_t>(n)]; });
}

bool JointAngleUpdate::take_prior(const JointAngleState& prior) {
  const int N = prior.targets(), n = 2 * N;
  if (N == 0) return true;
  Ut_ = prior.P.leftCols(n);
  Lt_.resize(n, n);
  bool is_positive_definite = false;
  kernels::prior_root(N, Ut_.data(), Lt_.data(), is_positive_definite);
  return is_positive_definite;
}

bool JointAngleUpdate::find_mode(const JointAngleState& prior, const RealInterval& interval, double middle_s,
                                 const SignalVector& start, const Options& options) {
  const int N = prior.targets(), n = 2 * N;
  if (N == 0) {
    m_.resize(0);
    log_evidence_ = 0.0;
    return likelihood_.evaluate(interval, SignalVector(0), nullptr, middle_s, options.noise_power);
  }
  const SignalVector m0 = prior.x.head(n), rate = prior.x.tail(N);
  bool is_positive_definite = false;
  m_ = start;
  u_ = m_ - m0;  // u = L^-1 (m - m0)
  for (int j = 0; j < n; ++j) {
    u_[j] /= Ut_(j, j);
    for (int i = j + 1; i < n; ++i) u_[i] -= Ut_(i, j) * u_[j];
  }
  JL_.resize(n, n);
  B_.resize(n, n);
  step_.resize(n);
  change_.resize(n);

  for (int iteration = 0;; ++iteration) {
    if (!likelihood_.evaluate(interval, m_, options.moving ? &rate : nullptr, middle_s, options.noise_power))
      return false;
    kernels::solve_model({N, Ut_.data(), Lt_.data(), likelihood_.information().data(), likelihood_.gradient().data(),
                          u_.data(), JL_.data(), B_.data(), step_.data(), change_.data(), &is_positive_definite});
    if (!is_positive_definite) return false;
    if (iteration == options.iterations || step_.squaredNorm() < kConverged) break;
    // No further than the quadratic model can be believed.
    double scale = 1.0;
    for (int i = 0; i < N; ++i) {
      scale = std::min(scale, kLargestStep_rad / std::max(std::abs(change_[i]), kLargestStep_rad));
      scale = std::min(scale, kLargestLogPowerStep / std::max(std::abs(change_[N + i]), kLargestLogPowerStep));
    }
    u_ += scale * step_;
    m_ += scale * change_;
    for (int i = 0; i < N; ++i) {
      if (std::abs(m_[i]) > kLargestAngle_rad || std::abs(m_[N + i]) > kLargestLogPower) return false;
    }
  }

  log_evidence_ = likelihood_.log_likelihood() - 0.5 * u_.squaredNorm() - 0.5 * log_determinant(B_);
  return true;
}

bool JointAngleUpdate::give_posterior(const JointAngleState& prior, JointAngleState& posterior) {
  const int N = prior.targets();
  if (N == 0) {
    posterior = prior;
    return true;
  }
  posterior.q = prior.q;
  posterior.innovations = prior.innovations;
  posterior.x = prior.x;
  posterior.P.resize(3 * N, 3 * N);
  Zt_ = Ut_;
  bool is_finite = true;
  kernels::take_posterior({N, Ut_.data(), B_.data(), u_.data(), prior.P.data(), Zt_.data(), posterior.x.data(),
                           posterior.P.data(), &is_finite});
  return is_finite;
}

EquivalentInnovation equivalent_innovation(const JointAngleState& prior, const JointAngleState& posterior, int n) {
  // A measurement that takes the variance from P to P+ has the gain 1 - P+/P and S = P / gain.
  const double P = prior.P(n, n);
  const double gain = std::clamp(1.0 - posterior.P(n, n) / P, kLeastGain, 1.0 - kLeastGain);
  return {(posterior.x[n] - prior.x[n]) / gain, P / gain, gain};
}

}  // namespace truebearing
