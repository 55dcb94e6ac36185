// SPDX-License-Identifier: Apache-2.0
// Covariance matrices: validity, Mahalanobis distance. No inverse is ever formed.
#pragma once

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

namespace detail {

template <typename Covariance, typename Vector>
struct Elimination {
  double squared = 0.0;          // d' P^-1 d, NaN where P is not positive definite
  double log_determinant = 0.0;  // of P

  // Gaussian elimination; only the lower triangle of P is read. Eigen's decompositions are made for larger matrices and
  // spend most of their time here on set-up.
  Elimination(Covariance P, Vector d) {
    for (Eigen::Index k = 0; k < P.rows(); ++k) {
      const double pivot = P(k, k) > 0.0 ? P(k, k) : std::numeric_limits<double>::quiet_NaN();
      const double inverse = 1.0 / pivot;
      squared += d(k) * d(k) * inverse;
      log_determinant += std::log(pivot);
      for (Eigen::Index i = k + 1; i < P.rows(); ++i) {
        const double factor = P(i, k) * inverse;
        d(i) -= factor * d(k);
        for (Eigen::Index j = k + 1; j <= i; ++j) P(i, j) -= factor * P(j, k);
      }
    }
  }
};

}  // namespace detail

/// d' P^-1 d, or NaN where P is not positive definite.
template <typename DerivedP, typename DerivedD>
double mahalanobis_squared(const Eigen::MatrixBase<DerivedP>& P, const Eigen::MatrixBase<DerivedD>& d) {
  using Elimination = detail::Elimination<typename DerivedP::PlainObject, typename DerivedD::PlainObject>;
  return Elimination(P, d).squared;
}

/// ln |S|, or NaN where S is not positive definite.
template <typename Derived>
double log_determinant(const Eigen::MatrixBase<Derived>& S) {
  if constexpr (Derived::RowsAtCompileTime == 1) return std::log(S(0, 0));
  if constexpr (Derived::RowsAtCompileTime == 2) return std::log(S(0, 0) * S(1, 1) - S(1, 0) * S(0, 1));
  using Vector = Eigen::Matrix<double, Derived::RowsAtCompileTime, 1, 0, Derived::MaxRowsAtCompileTime, 1>;
  return detail::Elimination<typename Derived::PlainObject, Vector>(S, Vector::Zero(S.rows())).log_determinant;
}

/// Logarithm of the density of N(0, S) at nu, or NaN where S is not positive definite.
template <typename DerivedS, typename DerivedNu>
double log_density(const Eigen::MatrixBase<DerivedS>& S, const Eigen::MatrixBase<DerivedNu>& nu) {
  using Elimination = detail::Elimination<typename DerivedS::PlainObject, typename DerivedNu::PlainObject>;
  const Elimination eliminated(S, nu);
  const double size = static_cast<double>(nu.size());
  return -0.5 * (eliminated.squared + eliminated.log_determinant + size * std::log(2.0 * std::numbers::pi));
}

}  // namespace truebearing
