// SPDX-License-Identifier: Apache-2.0
// The proven bound. Whatever a network says, the published estimate is at most kappa standard deviations of the
// reference away from the reference; and where the reference's covariance is not safely positive definite, it is the
// reference.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "truebearing/core/bounded.hpp"
#include "truebearing/core/constants.hpp"

namespace truebearing {

namespace detail {

/// What d' P^-1 d asks of P (n x n) = L diag(pivots) L': L^-1, of unit diagonal, and the pivots' inverses, in the
/// arithmetic of Real. The elimination errs by the machine's epsilon times the condition number of the correlation
/// matrix C, whatever the scales of the components (Demmel 1989, "On floating point errors in Cholesky"); that is at
/// most n trace(C^-1) = n sum P_jj (P^-1)_jj.
template <typename Real>
struct Eliminated {
  std::array<std::array<Real, kMaxDimension>, kMaxDimension> inverse_L;  // below the diagonal
  std::array<Real, kMaxDimension> inverse_pivot;
  Real condition;  // no number <= anything where P is not positive definite
};

/// Of n = N components, or of as many as there are where N is not positive. Divides before it multiplies: squares may
/// be out of range.
template <int N, typename Real>
Real squared_length(const Eliminated<Real>& elimination, std::size_t size, const double* d) {
  const std::size_t n = N > 0 ? static_cast<std::size_t>(N) : size;
  Real squared = 0;
#pragma GCC unroll 8
  for (std::size_t i = 0; i < n; ++i) {
    Real left = static_cast<Real>(d[i]);
#pragma GCC unroll 8
    for (std::size_t j = 0; j < i; ++j) left += elimination.inverse_L[i][j] * static_cast<Real>(d[j]);
    squared += left * elimination.inverse_pivot[i] * left;
  }
  return squared;
}

}  // namespace detail

/// sqrt(d' P^-1 d) of any number of vectors d (n) under one P (n x n), which is eliminated once. Only the lower
/// triangle of P is read; it must outlive this.
class SafeDistance {
 public:
  SafeDistance(const BoundedMatrix& P);  // NOLINT: for one vector, P says it all

  /// To a relative error of 1e-9; infinity where d is not finite, or P not so far from singular that this can be
  /// promised.
  double of(const BoundedVector& d) const { return of<0>(d); }
  /// Where it is known that there are N > 0 components. Called, not inlined: a step asks several times, and is longer
  /// than the cache of instructions.
  template <int N, typename Vector>
  [[gnu::noinline]] double of(const Vector& d) const {
    if (quick_.condition <= kForDouble) {
      const double squared = detail::squared_length<N>(quick_, static_cast<std::size_t>(d.size()), d.data());
      if (std::isfinite(squared)) return std::sqrt(squared);
    }
    return carefully(static_cast<std::size_t>(d.size()), d.data());
  }

 private:
  // The largest condition number at which an arithmetic of 53 binary digits keeps the promise.
  static constexpr double kForDouble = 1e5;

  double carefully(std::size_t n, const double* d) const;

  const BoundedMatrix& P_;
  bool has_variances_;  // of which quotients keep their digits
  detail::Eliminated<double> quick_;
};

template <typename Vector>
struct LimitedVector {
  Vector d;
  double distance_sigmas = 0.0;  ///< of the returned d
  bool limited = false;
  double wanted_sigmas = 0.0;  ///< of what was to be limited; NaN where it has no value
};
using Limited = LimitedVector<BoundedVector>;

/// d (n) scaled down to a Mahalanobis length of at most kappa under the reference's covariance; zero where its distance
/// is infinite. kappa = infinity leaves a finite d as it is, and wants no covariance. N: as of SafeDistance::of().
template <int N, typename Vector>
LimitedVector<Vector> limit_kappa(const SafeDistance& distance, const Vector& d, double kappa) {
  const double distance_sigmas = distance.of<N>(d);
  const bool known = std::isfinite(distance_sigmas);
  const double wanted_sigmas = known ? distance_sigmas : kNaN;
  if (kappa == kInfinity && (known || d.allFinite())) return {d, wanted_sigmas, false, wanted_sigmas};
  if (!known) return {Vector::Zero(d.size()), 0.0, true, kNaN};
  if (distance_sigmas <= kappa) return {d, distance_sigmas, false, wanted_sigmas};
  return {d * (kappa / distance_sigmas), kappa, true, wanted_sigmas};
}
inline Limited limit_kappa(const SafeDistance& distance, const BoundedVector& d, double kappa) {
  return limit_kappa<0>(distance, d, kappa);
}

/// x_reference + d, or x_reference where d, once added, is more than kappa standard deviations long: a sum rounds to
/// the digits of x_reference, of which P may be far below.
template <int N, typename Vector>
Vector within_kappa(const Vector& x_reference, const SafeDistance& distance, const Vector& d, double kappa) {
  constexpr double kSlack = 4e-10;  // what a length that was measured in rounded arithmetic may lack
  const Vector x = x_reference + d;
  if (kappa == kInfinity) return x;
  return distance.of<N>(Vector(x - x_reference)) <= kappa * (1.0 + kSlack) ? x : x_reference;
}
inline BoundedVector within_kappa(const BoundedVector& x_reference, const SafeDistance& distance,
                                  const BoundedVector& d, double kappa) {
  return within_kappa<0>(x_reference, distance, d, kappa);
}

}  // namespace truebearing
