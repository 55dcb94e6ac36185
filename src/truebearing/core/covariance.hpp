// Covariance matrices: validity, Mahalanobis distance. No inverse is ever formed; Cholesky solves only.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <algorithm>
#include <limits>
#include <numbers>

namespace truebearing {

/// True where A is finite, symmetric and positive semi-definite, each up to `tolerance` relative to its diagonal.
/// Elimination without square roots; branch-free up to the result.
template <typename Derived>
bool is_covariance(const Eigen::MatrixBase<Derived>& A, double tolerance = 1e-9) {
  if (A.rows() != A.cols()) return false;
  typename Derived::PlainObject W = A;
  const Eigen::Index n = W.rows();
  bool valid = true;
  for (Eigen::Index i = 0; i < n; ++i) {
    valid &= A(i, i) >= 0.0;
    for (Eigen::Index j = 0; j < i; ++j)
      valid &= std::abs(A(i, j) - A(j, i)) <= tolerance * std::sqrt(A(i, i)) * std::sqrt(A(j, j));
  }
  for (Eigen::Index k = 0; k < n; ++k) {
    const double slack = tolerance * A(k, k);
    valid &= W(k, k) >= -slack;
    const double pivot = W(k, k) > slack ? W(k, k) : std::numeric_limits<double>::infinity();
    for (Eigen::Index i = k + 1; i < n; ++i) {
      // A vanishing pivot allows only a vanishing column: |W_ik|^2 <= W_kk W_ii up to the tolerance.
      valid &= W(i, k) * W(i, k) <= (std::max(W(k, k), 0.0) + slack) * (std::max(W(i, i), 0.0) + tolerance * A(i, i));
      for (Eigen::Index j = k + 1; j <= i; ++j) W(i, j) -= W(i, k) * W(j, k) / pivot;
    }
  }
  return valid && A.allFinite();
}

/// d' P^-1 d, or NaN where P is not positive definite.
template <typename DerivedP, typename DerivedD>
double mahalanobis_squared(const Eigen::MatrixBase<DerivedP>& P, const Eigen::MatrixBase<DerivedD>& d) {
  const Eigen::LLT<typename DerivedP::PlainObject> cholesky(P);
  if (cholesky.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  const typename DerivedD::PlainObject whitened = cholesky.matrixL().solve(d);
  return whitened.squaredNorm();
}

/// Logarithm of the density of N(0, S) at nu, or NaN where S is not positive definite.
template <typename DerivedS, typename DerivedNu>
double log_density(const Eigen::MatrixBase<DerivedS>& S, const Eigen::MatrixBase<DerivedNu>& nu) {
  const Eigen::LLT<typename DerivedS::PlainObject> cholesky(S);
  if (cholesky.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  const typename DerivedNu::PlainObject whitened = cholesky.matrixL().solve(nu);
  const double log_determinant = 2.0 * cholesky.matrixLLT().diagonal().array().log().sum();
  const double size = static_cast<double>(nu.size());
  return -0.5 * (whitened.squaredNorm() + log_determinant + size * std::log(2.0 * std::numbers::pi));
}

}  // namespace truebearing
