// The three small factorizations the filters stand on, for fixed sizes, without heap and branch-free: A = L D L' with its
// solve, the square root of a positive semi-definite matrix, and orthogonal triangularization (Golub and Van Loan 2013,
// sections 4.1 and 5.1). Sizes are so small that Eigen's general solvers spend most of their time on set-up.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace truebearing {

/// A = L D L' (n x n) by elimination; only the lower triangle of A is read. A pivot below `floor` is replaced by it:
/// the factors are then those of A plus a diagonal, and `valid` tells the two uses apart.
template <int N, typename Scalar>
struct Ldlt {
  using Matrix = Eigen::Matrix<Scalar, N, N>;
  using Vector = Eigen::Matrix<Scalar, N, 1>;

  Matrix L;           ///< strictly lower part only
  Vector D;
  Vector inverse_D;
  bool valid = true;  ///< all pivots were finite and at least `least`

  EIGEN_ALWAYS_INLINE Ldlt(const Matrix& A, const Vector& floor, const Vector& least) : L(A) {
    for (int k = 0; k < N; ++k) {
      const Scalar pivot = L(k, k);
      valid &= (pivot >= least(k)) & (pivot <= std::numeric_limits<Scalar>::max());
      D(k) = pivot > floor(k) ? pivot : floor(k);
      inverse_D(k) = 1 / D(k);
      for (int i = k + 1; i < N; ++i) {
        const Scalar factor = L(i, k) * inverse_D(k);
        for (int j = k + 1; j <= i; ++j) L(i, j) -= factor * L(j, k);
      }
      for (int i = k + 1; i < N; ++i) L(i, k) *= inverse_D(k);
    }
  }

  /// A^-1 b.
  EIGEN_ALWAYS_INLINE Vector solve(Vector b) const {
    for (int i = 1; i < N; ++i)
      for (int j = 0; j < i; ++j) b(i) -= L(i, j) * b(j);
    b.array() *= inverse_D.array();
    for (int i = N - 2; i >= 0; --i)
      for (int j = i + 1; j < N; ++j) b(i) -= L(j, i) * b(j);
    return b;
  }
};

/// What rounding can leave of a pivot that should be zero: n eps of the variance, and something above zero for a variance
/// of zero, which then allows no covariance.
template <int N, typename Scalar>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, N, 1> semidefinite_slack(const Eigen::Matrix<Scalar, N, N>& A) {
  constexpr Scalar kTolerance = 8 * N * std::numeric_limits<Scalar>::epsilon();
  Eigen::Matrix<Scalar, N, 1> slack;
  for (int i = 0; i < N; ++i) slack(i) = kTolerance * A(i, i) + std::numeric_limits<Scalar>::min();
  return slack;
}

/// True where A is finite and its correlation matrix has no eigenvalue below some -n eps, which is as far as rounding can take
/// one that was positive semi-definite. Elimination of one variable after the other; reads the lower triangle.
template <int N, typename Scalar>
EIGEN_ALWAYS_INLINE bool is_positive_semidefinite(const Eigen::Matrix<Scalar, N, N>& A,
                                                  const Eigen::Matrix<Scalar, N, 1>& slack) {
  bool valid = (A(0, 0) >= -slack(0)) & (A(0, 0) <= std::numeric_limits<Scalar>::max());
  if constexpr (N > 1) {
    const Scalar inverse_pivot = 1 / (A(0, 0) > slack(0) ? A(0, 0) : slack(0));
    Eigen::Matrix<Scalar, N - 1, N - 1> schur;
    Eigen::Matrix<Scalar, N - 1, 1> slack_left;
    for (int j = 1; j < N; ++j) {
      const Scalar factor = A(j, 0) * inverse_pivot;
      slack_left(j - 1) = slack(j);
      for (int i = j; i < N; ++i) schur(i - 1, j - 1) = A(i, j) - A(i, 0) * factor;
    }
    valid &= is_positive_semidefinite<N - 1, Scalar>(schur, slack_left);
  }
  return valid;
}

template <int N, typename Scalar>
EIGEN_ALWAYS_INLINE bool is_positive_semidefinite(const Eigen::Matrix<Scalar, N, N>& A) {
  return is_positive_semidefinite<N, Scalar>(A, semidefinite_slack<N, Scalar>(A));
}

/// Lower triangular L with L L' = A; NaN where A is not positive semi-definite.
template <int N, typename Scalar>
Eigen::Matrix<Scalar, N, N> semidefinite_root(const Eigen::Matrix<Scalar, N, N>& A) {
  const Eigen::Matrix<Scalar, N, 1> slack = semidefinite_slack<N, Scalar>(A);
  const Ldlt<N, Scalar> factors(A, slack, -slack);
  Eigen::Matrix<Scalar, N, N> L = Eigen::Matrix<Scalar, N, N>::Zero();
  for (int k = 0; k < N; ++k) {
    // A variance of exactly zero keeps a root of exactly zero; its floor only served the division.
    L(k, k) = A(k, k) == 0 ? Scalar(0) : std::sqrt(factors.D(k));
    for (int i = k + 1; i < N; ++i) L(i, k) = factors.L(i, k) * L(k, k);
  }
  if (!factors.valid) L.setConstant(std::numeric_limits<Scalar>::quiet_NaN());
  return L;
}

/// W (rows x cols, cols >= rows) becomes W Theta = [0, U] with Theta orthogonal, U upper triangular, diagonal >= 0: row by
/// row from the last, Givens rotations of the columns. Rotations, because they multiply where a Householder reflection
/// subtracts: columns of very different size keep their digits (Bierman's example: 1e-15 against 1e-7).
template <int Rows, int Cols, typename Scalar>
void triangularize(Eigen::Matrix<Scalar, Rows, Cols>& W) {
  static_assert(Cols >= Rows);
  for (int row = Rows - 1; row >= 0; --row) {
    const int pivot = row + Cols - Rows;
    for (int j = 0; j < pivot; ++j) {
      // Nothing to rotate: the identity, so that what is triangular already stays as it is, to the bit.
      const bool rotate = !(W(row, j) == 0);
      const Scalar radius = std::sqrt(W(row, pivot) * W(row, pivot) + W(row, j) * W(row, j));
      const Scalar cosine = rotate ? W(row, pivot) / radius : std::copysign(Scalar(1), W(row, pivot));
      const Scalar sine = rotate ? W(row, j) / radius : Scalar(0);
      for (int i = 0; i <= row; ++i) {
        const Scalar rotated = cosine * W(i, pivot) + sine * W(i, j);
        W(i, j) = cosine * W(i, j) - sine * W(i, pivot);
        W(i, pivot) = rotated;
      }
      W(row, j) = 0;
    }
  }
}

}  // namespace truebearing
