// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/linear_algebra.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

namespace truebearing {
namespace {

// Any size up to 4, without the heap: one of Eigen's decompositions to compile, where fixed sizes were several.
template <int N>
inline constexpr int kMost = N == Eigen::Dynamic ? N : 4;
template <int N>
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost<N>, kMost<N>>;
template <int N>
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost<N>, 1>;

}  // namespace

template <int N>
SymmetricModes<N> symmetric_modes(const Eigen::Matrix<double, N, N>& A) {
  const Eigen::SelfAdjointEigenSolver<Small<N>> solver{Small<N>(A)};
  return {solver.eigenvalues(), solver.eigenvectors()};
}

// Eigen's own factorisation of small matrices, operation by operation. Its LLT brings the one of large matrices along,
// whose products of blocks take longer to compile than all else here.
template <int N>
bool cholesky(const Eigen::Matrix<double, N, N>& A, Eigen::Matrix<double, N, N>& L) {
  L = A.template triangularView<Eigen::Lower>();
  for (int k = 0; k < N; ++k) {
    double squares = 0.0;
    for (int j = 0; j < k; ++j) squares += L(k, j) * L(k, j);
    const double pivot = L(k, k) - squares;
    if (pivot <= 0.0) return false;
    L(k, k) = std::sqrt(pivot);
    for (int i = k + 1; i < N; ++i) {
      double products = 0.0;
      for (int j = 0; j < k; ++j) products += L(i, j) * L(k, j);
      L(i, k) = (L(i, k) - products) / L(k, k);
    }
  }
  return true;
}

template <int N>
Eigen::Matrix<double, N, 1> solve_positive(const Eigen::Matrix<double, N, N>& A, const Eigen::Matrix<double, N, 1>& b) {
  Eigen::Matrix<double, N, N> L;
  cholesky(A, L);
  Eigen::Matrix<double, N, 1> x = b;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < i; ++j) x(i) -= L(i, j) * x(j);
    x(i) /= L(i, i);
  }
  for (int i = N - 1; i >= 0; --i) {
    for (int j = i + 1; j < N; ++j) x(i) -= L(j, i) * x(j);
    x(i) /= L(i, i);
  }
  return x;
}

Eigen::MatrixXd solve_positive(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return A.llt().solve(B);
}

template <int N>
Eigen::Matrix<double, N, N> inverse_of_positive(const Eigen::Matrix<double, N, N>& A) {
  return solve_positive(Eigen::MatrixXd(A), Eigen::MatrixXd(Eigen::MatrixXd::Identity(A.rows(), A.cols())));
}

template <int N>
Eigen::Matrix<double, N, 1> solve_semidefinite(const Eigen::Matrix<double, N, N>& A,
                                               const Eigen::Matrix<double, N, 1>& b) {
  return Small<N>(A).ldlt().solve(SmallVector<N>(b));
}

RowMajorMatrix least_squares(const Eigen::MatrixXd& A, const RowMajorMatrix& B) {
  return A.completeOrthogonalDecomposition().solve(B);
}

template SymmetricModes<2> symmetric_modes(const Eigen::Matrix2d&);
template SymmetricModes<4> symmetric_modes(const Eigen::Matrix4d&);
template SymmetricModes<Eigen::Dynamic> symmetric_modes(const Eigen::MatrixXd&);

template bool cholesky(const Eigen::Matrix2d&, Eigen::Matrix2d&);
template bool cholesky(const Eigen::Matrix4d&, Eigen::Matrix4d&);

template Eigen::Matrix<double, 1, 1> solve_positive(const Eigen::Matrix<double, 1, 1>&,
                                                    const Eigen::Matrix<double, 1, 1>&);
template Eigen::Vector2d solve_positive(const Eigen::Matrix2d&, const Eigen::Vector2d&);
template Eigen::Vector3d solve_positive(const Eigen::Matrix3d&, const Eigen::Vector3d&);
template Eigen::Vector4d solve_positive(const Eigen::Matrix4d&, const Eigen::Vector4d&);
template Eigen::Matrix<double, 5, 1> solve_positive(const Eigen::Matrix<double, 5, 5>&,
                                                    const Eigen::Matrix<double, 5, 1>&);
template Eigen::Matrix<double, 6, 1> solve_positive(const Eigen::Matrix<double, 6, 6>&,
                                                    const Eigen::Matrix<double, 6, 1>&);

template Eigen::Matrix2d inverse_of_positive(const Eigen::Matrix2d&);
template Eigen::Matrix4d inverse_of_positive(const Eigen::Matrix4d&);
template Eigen::MatrixXd inverse_of_positive(const Eigen::MatrixXd&);

template Eigen::Vector3d solve_semidefinite(const Eigen::Matrix3d&, const Eigen::Vector3d&);
template Eigen::Vector4d solve_semidefinite(const Eigen::Matrix4d&, const Eigen::Vector4d&);

}  // namespace truebearing
