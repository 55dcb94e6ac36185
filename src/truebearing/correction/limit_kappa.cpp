#include "truebearing/correction/limit_kappa.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

// What a length that was measured in rounded arithmetic may lack.
constexpr double kSlack = 4e-10;
constexpr double kLeastVariance = 1e-290;  // below it quotients lose digits

// d' P^-1 d in the arithmetic of Real, of the correlation matrix C = D^-1 P D^-1 and D^-1 d, D = diag(sigma): its
// elimination C = L L' errs by the machine's epsilon times the condition number, at most n trace(C^-1), which L^-1 tells.
template <typename Real>
struct Whitened {
  Real squared = 0;
  Real condition = 0;

  Whitened(const BoundedMatrix& P, const BoundedVector& d) {
    std::array<std::array<Real, kMaxDimension>, kMaxDimension> L, inverse;  // lower triangles
    std::array<Real, kMaxDimension> sigma;
    const auto n = static_cast<std::size_t>(d.size());
    const auto at = [](const BoundedMatrix& matrix, std::size_t i, std::size_t j) {
      return static_cast<Real>(matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    };
    for (std::size_t i = 0; i < n; ++i) sigma[i] = std::sqrt(at(P, i, i));
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        Real sum = at(P, i, j) / (sigma[i] * sigma[j]);
        for (std::size_t k = 0; k < j; ++k) sum -= L[i][k] * L[j][k];
        if (i == j && !(sum > 0)) {
          condition = static_cast<Real>(kInfinity);
          return;
        }
        L[i][j] = i == j ? std::sqrt(sum) : sum / L[j][j];
      }
      Real whitened = 0;
      for (std::size_t j = 0; j <= i; ++j) {
        Real sum = i == j ? Real(1) : Real(0);
        for (std::size_t k = j; k < i; ++k) sum -= L[i][k] * inverse[k][j];
        inverse[i][j] = sum / L[i][i];
        condition += inverse[i][j] * inverse[i][j];
        whitened += inverse[i][j] * (static_cast<Real>(d[static_cast<Eigen::Index>(j)]) / sigma[j]);
      }
      squared += whitened * whitened;
    }
    condition *= static_cast<Real>(n);
  }
};

}  // namespace

double safe_distance(const BoundedMatrix& P, const BoundedVector& d) {
  // Beyond these condition numbers an arithmetic of 53 or of 64 binary digits no longer keeps the promise.
  constexpr double kForDouble = 1e5;
  constexpr long double kForLongDouble = 1e8L;
  if (!d.allFinite() || !(P.diagonal().minCoeff() > kLeastVariance)) return kInfinity;
  const Whitened<double> quick(P, d);
  if (quick.condition <= kForDouble && std::isfinite(quick.squared)) return std::sqrt(quick.squared);
  const Whitened<long double> careful(P, d);
  if (!(careful.condition <= kForLongDouble)) return kInfinity;
  const auto distance = static_cast<double>(std::sqrt(careful.squared));
  return std::isfinite(distance) ? distance : kInfinity;
}

Limited limit_kappa(const BoundedMatrix& P, const BoundedVector& d, double kappa) {
  const Limited nothing{BoundedVector::Zero(d.size()), 0.0, true};
  if (!d.allFinite()) return nothing;
  const double distance_sigmas = safe_distance(P, d);
  if (kappa == kInfinity) return {d, std::isfinite(distance_sigmas) ? distance_sigmas : kNaN, false};
  if (!std::isfinite(distance_sigmas)) return nothing;
  if (distance_sigmas <= kappa) return {d, distance_sigmas, false};
  return {d * (kappa / distance_sigmas), kappa, true};
}

BoundedVector within_kappa(const BoundedVector& x_reference, const BoundedMatrix& P, const BoundedVector& d,
                           double kappa) {
  const BoundedVector x = x_reference + d;
  if (kappa == kInfinity) return x;
  return safe_distance(P, BoundedVector(x - x_reference)) <= kappa * (1.0 + kSlack) ? x : x_reference;
}

}  // namespace truebearing
