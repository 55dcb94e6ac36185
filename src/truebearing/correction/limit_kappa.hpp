// The proven bound. Whatever a network says, the published estimate is at most kappa standard deviations of the reference
// away from the reference; and where the reference's covariance is not safely positive definite, it is the reference.
#pragma once

#include "truebearing/core/bounded.hpp"

namespace truebearing {

struct Limited {
  BoundedVector d;
  double distance_sigmas = 0.0;  ///< of the returned d
  bool limited = false;
};

/// sqrt(d' P^-1 d) of d (n) under P (n x n), to a relative error of 1e-9; infinity where d is not finite, or P not so
/// far from singular that this can be promised. Only the lower triangle of P is read.
double safe_distance(const BoundedMatrix& P, const BoundedVector& d);

/// d (n) scaled down to a Mahalanobis length of at most kappa under P (n x n), the reference's covariance; zero where
/// safe_distance() is infinite. kappa = infinity leaves a finite d as it is, and wants no P.
Limited limit_kappa(const BoundedMatrix& P, const BoundedVector& d, double kappa);

/// x_reference + d, or x_reference where d, once added, is more than kappa standard deviations long: a sum rounds to the
/// digits of x_reference, of which P may be far below.
BoundedVector within_kappa(const BoundedVector& x_reference, const BoundedMatrix& P, const BoundedVector& d,
                           double kappa);

}  // namespace truebearing
