// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/limit_kappa.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "truebearing/core/with_count.hpp"

namespace truebearing {
namespace {

constexpr double kLeastVariance = 1e-290;  // below it, and above its inverse, quotients lose digits

// Of n = N components, or of as many as P has where N is 0.
template <int N, typename Real>
void eliminate(const BoundedMatrix& P, detail::Eliminated<Real>& elimination) {
  auto& [inverse_L, inverse_pivot, condition] = elimination;
  std::array<std::array<Real, kMaxDimension>, kMaxDimension> L, left;  // left: L diag(pivots)
  const auto n = static_cast<std::size_t>(N > 0 ? N : P.rows());
  const double* data = P.data();
  const auto at = [&](std::size_t i, std::size_t j) { return static_cast<Real>(data[i + j * n]); };
  bool positive = true;
  Real trace = 0;  // of C^-1
#pragma GCC unroll 8
  for (std::size_t i = 0; i < n; ++i) {
#pragma GCC unroll 8
    for (std::size_t j = 0; j <= i; ++j) {
      left[i][j] = at(i, j);
#pragma GCC unroll 8
      for (std::size_t k = 0; k < j; ++k) left[i][j] -= L[i][k] * left[j][k];
      if (j < i) L[i][j] = left[i][j] * inverse_pivot[j];
    }
    positive &= left[i][i] > 0;
    inverse_pivot[i] = 1 / left[i][i];
#pragma GCC unroll 8
    for (std::size_t j = 0; j < i; ++j) {
      inverse_L[i][j] = -L[i][j];
#pragma GCC unroll 8
      for (std::size_t k = j + 1; k < i; ++k) inverse_L[i][j] -= L[i][k] * inverse_L[k][j];
      trace += (inverse_L[i][j] * at(j, j)) * (inverse_L[i][j] * inverse_pivot[i]);
    }
    trace += at(i, i) * inverse_pivot[i];
  }
  condition = positive ? static_cast<Real>(n) * trace : static_cast<Real>(kInfinity);
}

}  // namespace

SafeDistance::SafeDistance(const BoundedMatrix& P) : P_(P), has_variances_(P.diagonal().minCoeff() > kLeastVariance) {
  quick_.condition = kInfinity;
  if (!has_variances_ || !(P.diagonal().maxCoeff() < 1.0 / kLeastVariance)) return;
  with_count(static_cast<int>(P.rows()), [&]<int N>(std::integral_constant<int, N>) { eliminate<N>(P, quick_); });
}

double SafeDistance::carefully(std::size_t n, const double* d) const {
  constexpr long double kForLongDouble = 1e8L;  // as kForDouble, of 64 binary digits
  if (!has_variances_ || !std::all_of(d, d + n, [](double number) { return std::isfinite(number); })) return kInfinity;
  detail::Eliminated<long double> careful;
  eliminate<0>(P_, careful);
  if (!(careful.condition <= kForLongDouble)) return kInfinity;
  const auto distance = static_cast<double>(std::sqrt(detail::squared_length<0>(careful, n, d)));
  return std::isfinite(distance) ? distance : kInfinity;
}

}  // namespace truebearing
