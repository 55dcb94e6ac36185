// SPDX-License-Identifier: Apache-2.0
// The proven bound. Whatever a network says, the published estimate is at most kappa standard deviations of the reference
// away from the reference; and where the reference's covariance is not safely positive definite, it is the reference.
#pragma once

#include <array>

#include "truebearing/core/bounded.hpp"

namespace truebearing {

namespace detail {

/// What d' P^-1 d asks of P (n x n): of the correlation matrix C = D^-1 P D^-1 = L L', D = diag(sigma), the inverse of L,
/// in the arithmetic of Real. The elimination errs by the machine's epsilon times the condition number, at most n
/// trace(C^-1), which L^-1 tells.
template <typename Real>
struct Whitening {
  std::array<Real, kMaxDimension> sigma;
  std::array<std::array<Real, kMaxDimension>, kMaxDimension> inverse_L;  // the lower triangle
  Real condition;  // infinity where P is not positive definite, and L^-1 means nothing
};

}  // namespace detail

/// sqrt(d' P^-1 d) of any number of vectors d (n) under one P (n x n), which is factored once. Only the lower triangle
/// of P is read; it must outlive this.
class SafeDistance {
 public:
  SafeDistance(const BoundedMatrix& P);  // NOLINT: for one vector, P says it all

  /// To a relative error of 1e-9; infinity where d is not finite, or P not so far from singular that this can be
  /// promised.
  double of(const BoundedVector& d) const;

 private:
  const BoundedMatrix& P_;
  bool has_variances_;  // of which quotients keep their digits
  detail::Whitening<double> quick_;
};

struct Limited {
  BoundedVector d;
  double distance_sigmas = 0.0;  ///< of the returned d
  bool limited = false;
  double wanted_sigmas = 0.0;  ///< of what was to be limited; NaN where it has no value
};

/// d (n) scaled down to a Mahalanobis length of at most kappa under the reference's covariance; zero where its distance
/// is infinite. kappa = infinity leaves a finite d as it is, and wants no covariance.
Limited limit_kappa(const SafeDistance& distance, const BoundedVector& d, double kappa);

/// x_reference + d, or x_reference where d, once added, is more than kappa standard deviations long: a sum rounds to the
/// digits of x_reference, of which P may be far below.
BoundedVector within_kappa(const BoundedVector& x_reference, const SafeDistance& distance, const BoundedVector& d,
                           double kappa);

}  // namespace truebearing
