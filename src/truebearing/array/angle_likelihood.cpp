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
  for (Eigen::MatrixXd* columns : {&A_, &D_, &W_, &V_, &RW_})
    if (columns->rows() != array.padded) columns->resize(array.padded, kMaxSignals);
  for (SignalMatrix* gram : {&AA_, &DA_, &DD_, &C_}) gram->resize(N, N);
}

// Steering vectors, their Gram matrices and C.
bool AngleLikelihood::prepare_block(const RealArray& array, const RealCovariance& block, const SignalVector& m,
                                    const SignalVector* rate, double middle_s, double noise_power) {
  const int N = static_cast<int>(m.size()) / 2;
  resize(array, N);
  for (int n = 0; n < N; ++n) {
    const double moved = rate ? (block.time_s - middle_s) * (*rate)[n] : 0.0;
    steer_real(array, m[n] + moved, A_.col(n).data(), D_.col(n).data());
  }
  kernels::grams({array.padded, N, A_.data(), D_.data(), AA_.data(), DA_.data(), DD_.data()});
  SignalMatrix L(N, N);
  SignalVector p = m.tail(N).array().exp();
  bool is_positive_definite = false;
  kernels::coupling({N, noise_power, AA_.data(), p.data(), L.data(), C_.data(), &log_det_, &is_positive_definite});
  return is_positive_definite;
}

bool AngleLikelihood::evaluate(const RealInterval& interval, const SignalVector& m, const SignalVector* rate,
                               double middle_s, double noise_power) {
  const int N = static_cast<int>(m.size()) / 2, rows = interval.array().padded;
  log_likelihood_ = 0.0;
  gradient_.setZero(2 * N);
  J_.setZero(2 * N, 2 * N);
  presence_.setZero(N);
  SignalVector expected = SignalVector::Zero(N), found = SignalVector::Zero(N);
  double residual = 0.0;
  SignalMatrix K(N, N), E(N, N), aRa(N, N), dRa(N, N), dRd(N, N);
  SignalVector p(N), W_RW(N), V_RW(N), A_RW(N);
  for (int n = 0; n < N; ++n) p[n] = std::exp(m[N + n]);
  const double inverse_noise = 1.0 / noise_power;

  for (int b = 0; b < interval.count(); ++b) {
    const RealCovariance& block = interval.block(b);
    if (!prepare_block(interval.array(), block, m, rate, middle_s, noise_power)) return false;
    const double Ns = block.snapshots;
    kernels::inner({N, inverse_noise, AA_.data(), DA_.data(), DD_.data(), C_.data(), p.data(), K.data(), E.data(),
                    aRa.data(), dRa.data(), dRd.data()});
    kernels::products({rows, N, A_.data(), D_.data(), block.R.data(), K.data(), E.data(), inverse_noise, W_.data(),
                       V_.data(), RW_.data(), W_RW.data(), V_RW.data(), A_RW.data()});

    double explained = 0.0, log_p = 0.0;
    for (int i = 0; i < N; ++i) {
      const double found_a = W_RW[i], found_d = V_RW[i];  // a' R^-1 R_hat R^-1 a and d' R^-1 R_hat R^-1 a
      explained += p[i] * A_RW[i];
      log_p += m[N + i];
      gradient_[i] += 2.0 * Ns * p[i] * (found_d - dRa(i, i));
      gradient_[N + i] += Ns * p[i] * (found_a - aRa(i, i));
      const double without = 1.0 - p[i] * aRa(i, i);  // R without signal i, by the same identity
      expected[i] += Ns * aRa(i, i) / without;
      found[i] += Ns * found_a / (without * without);
    }
    residual += Ns * (block.trace - explained);
    log_likelihood_ -= Ns * ((interval.array().live_rows - N) * std::log(noise_power) + log_det_ + log_p +
                             (block.trace - explained) * inverse_noise);
    for (int j = 0; j < N; ++j)
      for (int i = 0; i < N; ++i) {
        const double pp = Ns * p[i] * p[j];
        J_(i, j) += 2.0 * pp * (dRa(i, j) * dRa(j, i) + dRd(i, j) * aRa(i, j));
        J_(i, N + j) += 2.0 * pp * dRa(i, j) * aRa(i, j);
        J_(N + i, N + j) += pp * aRa(i, j) * aRa(i, j);
      }
  }
  J_.bottomLeftCorner(N, N) = J_.topRightCorner(N, N).transpose();
  for (int i = 0; i < N; ++i) presence_[i] = presence_of(interval.snapshots(), expected[i], found[i]);
  // E[sigma^2 tr(R^-1 R_hat)] is N sigma^2 + (M - N) times the true noise power.
  residual_power_ = (residual / interval.snapshots() - N * noise_power) / std::max(1, interval.array().live_rows - N);
  return std::isfinite(log_likelihood_) && gradient_.allFinite() && J_.allFinite();
}

AngleLikelihood::Newcomer AngleLikelihood::search(const RealInterval& interval, const SignalVector& m,
                                                  const SignalVector* rate, double middle_s, double noise_power,
                                                  std::span<const double> grid_rad) {
  const int N = static_cast<int>(m.size()) / 2, rows = interval.array().padded;
  found_.assign(grid_rad.size(), 0.0);
  expected_.assign(grid_rad.size(), 0.0);
  for (int b = 0; b < interval.count(); ++b) {
    const RealCovariance& block = interval.block(b);
    if (!prepare_block(interval.array(), block, m, rate, middle_s, noise_power)) return {};
    auto a = V_.col(0), d = V_.col(1), w = W_.col(0), Rw = RW_.col(0);
    for (std::size_t g = 0; g < grid_rad.size(); ++g) {
      steer_real(interval.array(), grid_rad[g], a.data(), d.data());
      SignalVector projected(N);
      for (int n = 0; n < N; ++n) projected[n] = A_.col(n).dot(a);
      w = a;  // R^-1 a = (a - A C A'a) / sigma^2
      for (int i = 0; i < N; ++i) {
        double coordinate = 0.0;
        for (int k = 0; k < N; ++k) coordinate += C_(i, k) * projected[k];
        w -= A_.col(i) * coordinate;
      }
      w /= noise_power;
      Rw.setZero();
      for (int i = 0; i < rows; ++i) Rw += block.R.col(i) * w[i];
      expected_[g] += block.snapshots * a.dot(w);
      found_[g] += block.snapshots * w.dot(Rw);
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
