// limit_kappa: the proven bound. Whatever a network says, the published estimate is at most kappa standard deviations
// of the reference away from the reference.
#pragma once

#include <cmath>
#include <limits>

#include "truebearing/core/bounded.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing {

struct Limited {
  BoundedVector d;
  double distance_sigmas = 0.0;  ///< of the returned d
  bool limited = false;
};

/// d (n) scaled down to a Mahalanobis length of at most kappa under P (n x n), the reference's covariance; zero where d
/// or its length is not finite or P is not positive definite. kappa = infinity leaves a finite d as it is, and wants no
/// P.
inline Limited limit_kappa(const BoundedMatrix& P, const BoundedVector& d, double kappa) {
  const double distance_sigmas = std::sqrt(mahalanobis_squared(P, d));
  const bool bounded = kappa < std::numeric_limits<double>::infinity();
  const Limited nothing{BoundedVector::Zero(d.size()), 0.0, true};
  if (!d.allFinite() || (bounded && !std::isfinite(distance_sigmas))) return nothing;
  if (!(distance_sigmas > kappa)) return {d, distance_sigmas, false};
  // At the ends of the range of double a vector and its length need not scale together: measured again, not trusted.
  const Limited shortened{d * (kappa / distance_sigmas), kappa, true};
  return std::sqrt(mahalanobis_squared(P, shortened.d)) <= kappa * (1.0 + 1e-9) ? shortened : nothing;
}

}  // namespace truebearing
