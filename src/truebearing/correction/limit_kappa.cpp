// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/limit_kappa.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/with_count.hpp"

namespace truebearing {
namespace {

// What a length that was measured in rounded arithmetic may lack.
constexpr double kSlack = 4e-10;
constexpr double kLeastVariance = 1e-290;  // below it quotients lose digits

// Of n = N components, or of as many as P has where N is 0.
template <int N, typename Real>
void whiten(const BoundedMatrix& P, detail::Whitening<Real>& whitening) {
  auto& [sigma, inverse, condition] = whitening;
  std::array<std::array<Real, kMaxDimension>, kMaxDimension> L;  // the lower triangle
  const auto n = static_cast<std::size_t>(N > 0 ? N : P.rows());
  const double* data = P.data();
  const auto at = [&](std::size_t i, std::size_t j) { return static_cast<Real>(data[i + j * n]); };
  Real sum_of_squares = 0;
  for (std::size_t i = 0; i < n; ++i) sigma[i] = std::sqrt(at(i, i));
#pragma GCC unroll 8
  for (std::size_t i = 0; i < n; ++i) {
#pragma GCC unroll 8
    for (std::size_t j = 0; j <= i; ++j) {
      Real sum = at(i, j) / (sigma[i] * sigma[j]);
#pragma GCC unroll 8
      for (std::size_t k = 0; k < j; ++k) sum -= L[i][k] * L[j][k];
      if (i == j && !(sum > 0)) {
        condition = static_cast<Real>(kInfinity);
        return;
      }
      L[i][j] = i == j ? std::sqrt(sum) : sum / L[j][j];
    }
#pragma GCC unroll 8
    for (std::size_t j = 0; j <= i; ++j) {
      Real sum = i == j ? Real(1) : Real(0);
#pragma GCC unroll 8
      for (std::size_t k = j; k < i; ++k) sum -= L[i][k] * inverse[k][j];
      inverse[i][j] = sum / L[i][i];
      sum_of_squares += inverse[i][j] * inverse[i][j];
    }
  }
  condition = static_cast<Real>(n) * sum_of_squares;
}

// d' P^-1 d.
template <int N, typename Real>
Real squared_length(const detail::Whitening<Real>& whitening, const BoundedVector& d) {
  const auto& [sigma, inverse, condition] = whitening;
  const auto n = static_cast<std::size_t>(N > 0 ? N : d.size());
  std::array<Real, kMaxDimension> scaled;
  for (std::size_t i = 0; i < n; ++i) scaled[i] = static_cast<Real>(d.data()[i]) / sigma[i];
  Real squared = 0;
#pragma GCC unroll 8
  for (std::size_t i = 0; i < n; ++i) {
    Real whitened = 0;
#pragma GCC unroll 8
    for (std::size_t j = 0; j <= i; ++j) whitened += inverse[i][j] * scaled[j];
    squared += whitened * whitened;
  }
  return squared;
}

}  // namespace

SafeDistance::SafeDistance(const BoundedMatrix& P) : P_(P), has_variances_(P.diagonal().minCoeff() > kLeastVariance) {
  quick_.condition = kInfinity;
  if (!has_variances_) return;
  with_count(static_cast<int>(P.rows()), [&]<int N>(std::integral_constant<int, N>) { whiten<N>(P, quick_); });
}

double SafeDistance::of(const BoundedVector& d) const {
  // Beyond these condition numbers an arithmetic of 53 or of 64 binary digits no longer keeps the promise.
  constexpr double kForDouble = 1e5;
  constexpr long double kForLongDouble = 1e8L;
  if (!has_variances_ || !d.allFinite()) return kInfinity;
  if (quick_.condition <= kForDouble) {
    double squared = 0.0;
    with_count(static_cast<int>(d.size()),
               [&]<int N>(std::integral_constant<int, N>) { squared = squared_length<N>(quick_, d); });
    if (std::isfinite(squared)) return std::sqrt(squared);
  }
  detail::Whitening<long double> careful;
  whiten<0>(P_, careful);
  if (!(careful.condition <= kForLongDouble)) return kInfinity;
  const auto distance = static_cast<double>(std::sqrt(squared_length<0>(careful, d)));
  return std::isfinite(distance) ? distance : kInfinity;
}

Limited limit_kappa(const SafeDistance& distance, const BoundedVector& d, double kappa) {
  const Limited nothing{BoundedVector::Zero(d.size()), 0.0, true, kNaN};
  if (!d.allFinite()) return nothing;
  const double distance_sigmas = distance.of(d);
  const double wanted_sigmas = std::isfinite(distance_sigmas) ? distance_sigmas : kNaN;
  if (kappa == kInfinity) return {d, wanted_sigmas, false, wanted_sigmas};
  if (!std::isfinite(distance_sigmas)) return nothing;
  if (distance_sigmas <= kappa) return {d, distance_sigmas, false, wanted_sigmas};
  return {d * (kappa / distance_sigmas), kappa, true, wanted_sigmas};
}

BoundedVector within_kappa(const BoundedVector& x_reference, const SafeDistance& distance, const BoundedVector& d,
                           double kappa) {
  const BoundedVector x = x_reference + d;
  if (kappa == kInfinity) return x;
  return distance.of(x - x_reference) <= kappa * (1.0 + kSlack) ? x : x_reference;
}

}  // namespace truebearing
