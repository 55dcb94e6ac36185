// SPDX-License-Identifier: Apache-2.0
// Eigen's decompositions, compiled once. Each takes the compiler seconds, and most files want no more of one than a
// solution; they include this and not Eigen's headers. Sizes N that are known beforehand: those instantiated at the end
// of linear_algebra.cpp.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>

namespace truebearing {

/// A = V diag(values) V' (N x N): eigenvalues, ascending, and the eigenvectors in the columns of V.
template <int N>
struct SymmetricModes {
  Eigen::Matrix<double, N, 1> values;
  Eigen::Matrix<double, N, N> vectors;
};
/// Of a symmetric matrix; only the lower triangle of A is read. N = 2, 4 or Eigen::Dynamic.
template <int N>
SymmetricModes<N> symmetric_modes(const Eigen::Matrix<double, N, N>& A);

/// L with L L' = A (N x N), and whether A is positive definite; where it is not, L means nothing. N = 2 or 4.
template <int N>
bool cholesky(const Eigen::Matrix<double, N, N>& A, Eigen::Matrix<double, N, N>& L);

/// A^-1 b by Cholesky; A (N x N) symmetric and positive definite, else the result means nothing. N = 1 to 6.
template <int N>
Eigen::Matrix<double, N, 1> solve_positive(const Eigen::Matrix<double, N, N>& A, const Eigen::Matrix<double, N, 1>& b);
/// A^-1 B (n x m).
Eigen::MatrixXd solve_positive(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// A^-1. N = 2, 4 or Eigen::Dynamic.
template <int N>
Eigen::Matrix<double, N, N> inverse_of_positive(const Eigen::Matrix<double, N, N>& A);

/// A^-1 b by L D L' with pivots, for A that rounding may have left just short of positive definite. N = 3 or 4.
template <int N>
Eigen::Matrix<double, N, 1> solve_semidefinite(const Eigen::Matrix<double, N, N>& A,
                                               const Eigen::Matrix<double, N, 1>& b);

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
/// The X (n x m) of least norm among those that minimise |A X - B|, for A of any rank.
RowMajorMatrix least_squares(const Eigen::MatrixXd& A, const RowMajorMatrix& B);

// The same of complex matrices (linear_algebra_complex.cpp).

struct HermitianModes {
  Eigen::VectorXd values;
  Eigen::MatrixXcd vectors;
};
HermitianModes hermitian_modes(const Eigen::MatrixXcd& A);

/// Each B (n x m) becomes A^-1 B; A (n x n) Hermitian and positive definite.
void solve_positive_in_place(const Eigen::MatrixXcd& A, std::span<Eigen::MatrixXcd> Bs);

/// X (n x m) that minimises |A X - B|, for A (k x n) of full rank.
Eigen::MatrixXcd least_squares(const Eigen::MatrixXcd& A, const Eigen::MatrixXcd& B);

/// The eigenvalues of a square matrix, in no order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXcd& A);

}  // namespace truebearing
