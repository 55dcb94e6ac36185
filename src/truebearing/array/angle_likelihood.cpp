// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/angle_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "truebearing/array/angle_likelihood_kernels.hpp"
#include "truebearing/array/column_product.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing {
namespace {

static_assert(kernels::kMostSignals == kMaxSignals);

// Twice the log likelihood that a signal adds, with Ns snapshots: a' R^-1 R_hat R^-1 a is `found`, a' R^-1 a
// `expected`, R without the signal.
double presence_of(double snapshots, double expected, double found) {
  const double ratio = found / expected;
  return ratio > 1.0 ? 2.0 * snapshots * (ratio - 1.0 - std::log(ratio)) : 0.0;
}

}  // namespace

void steer_real(const RealArray& array, double angle_rad, double* a, double* d) {
  const double wave = 2.0 * kPi * array.spacing_wavelengths;
  const double step = wave * std::sin(angle_rad), turn = wave * std::cos(angle_rad) * std::numbers::sqrt2;
  const double c1 = std::cos(step), s1 = std::sin(step);
  double c = array.middle ? c1 : std::cos(0.5 * step), s = array.middle ? s1 : std::sin(0.5 * step);
  std::fill(a, a + array.padded, 0.0);
  std::fill(d, d + array.padded, 0.0);
  for (int i = 0; i < array.pairs; ++i) {
    const double live = array.live[i], turning = live * turn * array.position(i);
    a[i] = live * std::numbers::sqrt2 * c;
    a[array.pairs + i] = live * std::numbers::sqrt2 * s;
    d[i] = -turning * s;
    d[array.pairs + i] = turning * c;
    const double next = c * c1 - s * s1;
    s = c * s1 + s * c1;
    c = next;
  }
  if (array.middle) a[2 * array.pairs] = array.live[2 * array.pairs];
}

void AngleLikelihood::resize(const RealArray& array, int N) {
  const int lanes = padded_to_widest(N), M = array.rows();
  for (Eigen::MatrixXd* rows : {&A_, &D_, &W_, &V_, &RW_})
    if (rows->size() < lanes * M) rows->resize(padded_to_widest(kMaxSignals), M);
  for (LaneMatrix* matrix : {&AA_, &DA_, &DD_, &C_, &Et_, &aRa_, &dRa_, &dRd_, &angles_, &angle_power_, &powers_})
    matrix->resize(lanes, N);
  for (LaneVector* vector : {&theta_, &p_, &found_a_, &found_d_, &explained_}) vector->resize(lanes);
}

// Steering vectors, their Gram matrices and C.
bool AngleLikelihood::prepare_block(const RealArray& array, const RealCovariance& block, const SignalVector& m,
                                    const SignalVector* rate, double middle_s, double noise_power) {
  const int N = static_cast<int>(m.size()) / 2, lanes = padded_to_widest(N), M = array.rows();
  resize(array, N);
  theta_.setZero();
  p_.setOnes();
  for (int n = 0; n < N; ++n) {
    theta_[n] = m[n] + (rate ? (block.time_s - middle_s) * (*rate)[n] : 0.0);
    p_[n] = std::exp(m[N + n]);
  }
  kernels::steer_signals({N, lanes, array.pairs, array.middle, 2.0 * kPi * array.spacing_wavelengths, array.live.data(),
                          theta_.data(), A_.data(), D_.data()});
  bool is_positive_definite = false;
  kernels::couple({N, lanes, M, noise_power, A_.data(), D_.data(), p_.data(), AA_.data(), DA_.data(), DD_.data(),
                   C_.data(), &log_det_, &is_positive_definite});
  return is_positive_definite;
}

bool AngleLikelihood::evaluate(const RealInterval& interval, const SignalVector& m, const SignalVector* rate,
                               double middle_s, double noise_power) {
  const int N = static_cast<int>(m.size()) / 2, lanes = padded_to_widest(N);
  log_likelihood_ = 0.0;
  gradient_.setZero(2 * N);
  expected_alone_.setZero(N);
  found_alone_.setZero(N);
  snapshots_ = interval.snapshots();
  resize(interval.array(), N);
  for (LaneMatrix* information : {&angles_, &angle_power_, &powers_}) information->setZero();
  double residual = 0.0;
  const double inverse_noise = 1.0 / noise_power;

  for (int b = 0; b < interval.count(); ++b) {
    const RealCovariance& block = interval.block(b);
    if (!prepare_block(interval.array(), block, m, rate, middle_s, noise_power)) return false;
    const double Ns = block.snapshots;
    kernels::score_signals({N,
                            lanes,
                            interval.array().rows(),
                            inverse_noise,
                            A_.data(),
                            D_.data(),
                            block.R.data(),
                            interval.array().padded,
                            AA_.data(),
                            DA_.data(),
                            DD_.data(),
                            C_.data(),
                            p_.data(),
                            W_.data(),
                            V_.data(),
                            RW_.data(),
                            Et_.data(),
                            aRa_.data(),
                            dRa_.data(),
                            dRd_.data(),
                            found_a_.data(),
                            found_d_.data(),
                            explained_.data()});
    kernels::add_information({N, lanes, Ns, p_.data(), aRa_.data(), dRa_.data(), dRd_.data(), angles_.data(),
                              angle_power_.data(), powers_.data()});

    double explained = 0.0, log_p = 0.0;
    for (int i = 0; i < N; ++i) {
      const double p = p_[i], aRa = aRa_(i, i);
      explained += p * explained_[i];
      log_p += m[N + i];
      gradient_[i] += 2.0 * Ns * p * (found_d_[i] - dRa_(i, i));
      gradient_[N + i] += Ns * p * (found_a_[i] - aRa);
      const double without = 1.0 - p * aRa;  // R without signal i, by the same identity
      expected_alone_[i] += Ns * aRa / without;
      found_alone_[i] += Ns * found_a_[i] / (without * without);
    }
    residual += Ns * (block.trace - explained);
    log_likelihood_ -= Ns * ((interval.array().live_rows - N) * std::log(noise_power) + log_det_ + log_p +
                             (block.trace - explained) * inverse_noise);
  }
  J_.resize(2 * N, 2 * N);
  bool is_finite = true;
  kernels::assemble_information({N, lanes, angles_.data(), angle_power_.data(), powers_.data(), J_.data(), &is_finite});
  // E[sigma^2 tr(R^-1 R_hat)] is N sigma^2 + (M - N) times the true noise power.
  residual_power_ = (residual / interval.snapshots() - N * noise_power) / std::max(1, interval.array().live_rows - N);
  return std::isfinite(log_likelihood_) && gradient_.allFinite() && is_finite;
}

double AngleLikelihood::presence(int n) const {
  return presence_of(snapshots_, expected_alone_[n], found_alone_[n]);
}

AngleLikelihood::Newcomer AngleLikelihood::search(const RealInterval& interval, const SignalVector& m,
                                                  const SignalVector* rate, double middle_s, double noise_power,
                                                  std::span<const double> grid_rad) {
  const int N = static_cast<int>(m.size()) / 2, M = interval.array().rows(), padded = interval.array().padded;
  found_.assign(grid_rad.size(), 0.0);
  expected_.assign(grid_rad.size(), 0.0);
  if (a_.size() != padded)
    for (Eigen::VectorXd* vector : {&a_, &d_, &w_, &Rw_}) vector->resize(padded);
  for (int b = 0; b < interval.count(); ++b) {
    const RealCovariance& block = interval.block(b);
    if (!prepare_block(interval.array(), block, m, rate, middle_s, noise_power)) return {};
    for (std::size_t g = 0; g < grid_rad.size(); ++g) {
      steer_real(interval.array(), grid_rad[g], a_.data(), d_.data());
      SignalVector projected = SignalVector::Zero(N);
      const double* A_i = A_.data();  // what sensor i hears of the signals
      for (int i = 0; i < M; ++i, A_i += theta_.size())
        for (int n = 0; n < N; ++n) projected[n] += A_i[n] * a_[i];
      SignalVector coordinates = SignalVector::Zero(N);
      for (int k = 0; k < N; ++k) coordinates += C_.col(k).head(N) * projected[k];
      A_i = A_.data();
      w_ = a_;  // R^-1 a = (a - A C A'a) / sigma^2
      for (int i = 0; i < M; ++i, A_i += theta_.size())
        for (int n = 0; n < N; ++n) w_[i] -= A_i[n] * coordinates[n];
      w_ /= noise_power;
      Rw_.setZero();
      for (int i = 0; i < M; ++i) Rw_ += block.R.col(i) * w_[i];
      expected_[g] += block.snapshots * a_.dot(w_);
      found_[g] += block.snapshots * w_.dot(Rw_);
    }
  }
  Newcomer best;
  for (std::size_t g = 0; g < grid_rad.size(); ++g) {
    const double presence = presence_of(interval.snapshots(), expected_[g], found_[g]);
    if (!(presence > best.presence)) continue;
    const double s = expected_[g] / interval.snapshots();
    best = {grid_rad[g], std::log((found_[g] / expected_[g] - 1.0) / s), presence};
  }
  return best;
}

}  // namespace truebearing
