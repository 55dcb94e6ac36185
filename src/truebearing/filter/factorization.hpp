// SPDX-License-Identifier: Apache-2.0
// The three small factorizations the filters stand on, for fixed sizes, without heap and branch-free: A = L D L' with
// its solve, the square root of a positive semi-definite matrix, and orthogonal triangularization (Golub and Van Loan
// 2013, sections 4.1 and 5.1). Sizes are so small that Eigen's general solvers spend most of their time on set-up.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "truebearing/filter/product.hpp"
#include "truebearing/filter/small_matrix.hpp"

namespace truebearing {

/// A = L D L' (n x n) of a positive definite matrix by elimination; only the lower triangle of A is read.
template <int N, typename Scalar>
struct Ldlt {
  using Matrix = Eigen::Matrix<Scalar, N, N>;
  using Vector = Eigen::Matrix<Scalar, N, 1>;

  Matrix L;  ///< strictly lower part only
  Vector inverse_D;
  bool valid = true;  ///< all pivots were finite and at least `least`

  EIGEN_ALWAYS_INLINE Ldlt(const Matrix& A, const Vector& least) {
    copy(A, L);  // one by one, as A was stored
    for (int k = 0; k < N; ++k) {
      valid &= (L(k, k) >= least(k)) & (L(k, k) <= std::numeric_limits<Scalar>::max());
      inverse_D(k) = 1 / L(k, k);
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
    for (int i = 0; i < N; ++i) b(i) *= inverse_D(i);
    for (int i = N - 2; i >= 0; --i)
      for (int j = i + 1; j < N; ++j) b(i) -= L(j, i) * b(j);
    return b;
  }

  /// X = B A^-1, row by row.
  template <int Rows>
  EIGEN_ALWAYS_INLINE void solve_rows(const Eigen::Matrix<Scalar, Rows, N>& B,
                                      Eigen::Matrix<Scalar, Rows, N>& X) const {
    for (int row = 0; row < Rows; ++row) {
      Vector b;
      for (int i = 0; i < N; ++i) b(i) = B(row, i);
      put(transposed(solve(b)), X, row, 0);
    }
  }
};

/// What rounding can leave of a pivot that should be zero: n eps of the variance, and something above zero for a
/// variance of zero, which then allows no covariance.
template <int N, typename Scalar>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, N, 1> semidefinite_slack(const Eigen::Matrix<Scalar, N, N>& A) {
  constexpr Scalar kTolerance = 8 * N * std::numeric_limits<Scalar>::epsilon();
  Eigen::Matrix<Scalar, N, 1> slack;
  for (int i = 0; i < N; ++i) slack(i) = kTolerance * A(i, i) + std::numeric_limits<Scalar>::min();
  return slack;
}

/// True where A is finite and positive definite: elimination of one variable after the other; reads the lower triangle.
template <int N, typename Scalar>
EIGEN_ALWAYS_INLINE bool is_positive_definite(const Eigen::Matrix<Scalar, N, N>& A) {
  bool valid = (A(0, 0) > 0) & (A(0, 0) <= std::numeric_limits<Scalar>::max());
  if constexpr (N > 1) {
    const Scalar inverse_pivot = 1 / A(0, 0);
    Eigen::Matrix<Scalar, N - 1, N - 1> schur;
    for (int j = 1; j < N; ++j) {
      const Scalar factor = A(j, 0) * inverse_pivot;
      for (int i = j; i < N; ++i) schur(i - 1, j - 1) = A(i, j) - A(i, 0) * factor;
    }
    valid &= is_positive_definite<N - 1, Scalar>(schur);
  }
  return valid;
}

namespace detail {

/// Of a variance, given those before it, that is a smaller share of itself alone: what is found of it without a division
/// may be rounding.
template <typename Scalar>
inline constexpr Scalar kPlainShare = Scalar(1) / 1024;

/// Says that A is positive definite, or nothing: two variables are eliminated at a time and nothing is divided, for
/// which rest is det(B) times the Schur complement of the leading block B (2 x 2). Each variance must be more than
/// `least`, so that rounding is far from having the say. What leaves the range of Scalar on the way, as products of up
/// to N variances may, is not said to be.
template <int N, typename Scalar>
EIGEN_ALWAYS_INLINE bool is_plainly_positive_definite(const Eigen::Matrix<Scalar, N, N>& A,
                                                      const Eigen::Matrix<Scalar, N, 1>& least) {
  if constexpr (N == 1) {
    return (A(0, 0) > least(0)) & (A(0, 0) <= std::numeric_limits<Scalar>::max());
  } else {
    const Scalar whole = A(0, 0) * A(1, 1), det = whole - A(1, 0) * A(1, 0);
    // The determinant is at most the product, so that its share says of the product that it is finite and above zero:
    // of two variances that need only be positive it takes the first to say the second.
    bool leads = (A(0, 0) > least(0)) & (det > kPlainShare<Scalar> * whole);
    if (!is_known_zero(least(1))) leads &= A(1, 1) > least(1);
    if constexpr (N == 2) {
      return leads;
    } else {
      Eigen::Matrix<Scalar, N - 2, N - 2> rest;
      Eigen::Matrix<Scalar, N - 2, 1> rest_least;
      for (int j = 2; j < N; ++j) {  // det B^-1 A_j, and its products with the others
        const Scalar u = A(1, 1) * A(j, 0) - A(1, 0) * A(j, 1), v = A(0, 0) * A(j, 1) - A(1, 0) * A(j, 0);
        for (int i = j; i < N; ++i) rest(i - 2, j - 2) = det * A(i, j) - (u * A(i, 0) + v * A(i, 1));
        rest_least(j - 2) = det * (kPlainShare<Scalar> * A(j, j) + least(j));
      }
      return leads & is_plainly_positive_definite<N - 2, Scalar>(rest, rest_least);
    }
  }
}

template <int N, typename Scalar>
EIGEN_ALWAYS_INLINE bool is_positive_definite_when_lifted(Eigen::Matrix<Scalar, N, N> A) {
  const Eigen::Matrix<Scalar, N, 1> slack = semidefinite_slack<N, Scalar>(A);
  for (int i = 0; i < N; ++i) A(i, i) += slack(i);
  return is_positive_definite<N, Scalar>(A);
}

/// The same, kept out of a filter's step, which it would push out of registers.
template <int N, typename Scalar>
[[gnu::noinline, gnu::cold]] bool is_positive_definite_when_lifted_aside(const Eigen::Matrix<Scalar, N, N>& A) {
  return is_positive_definite_when_lifted<N, Scalar>(A);
}

}  // namespace detail

/// True where A is finite and its correlation matrix has no eigenvalue below -8 n eps, which is about as far as
/// rounding takes one that was positive semi-definite. Nearly every matrix of a filter is plainly so: its divisions
/// took most of a step's time.
template <int N, typename Scalar>
EIGEN_ALWAYS_INLINE bool is_positive_semidefinite(const Eigen::Matrix<Scalar, N, N>& A) {
  Eigen::Matrix<Scalar, N, 1> least;
  fill(least, Scalar(0));
  if (detail::is_plainly_positive_definite<N, Scalar>(A, least)) [[likely]]
    return true;
  if constexpr (N > 2) {
    const Eigen::Matrix<Scalar, N, N> copy = A;  // so that A itself has no address
    return detail::is_positive_definite_when_lifted_aside<N, Scalar>(copy);
  } else {
    return detail::is_positive_definite_when_lifted<N, Scalar>(A);
  }
}

namespace detail {

/// Kept out of a filter's step, as above.
template <int N, typename Scalar>
[[gnu::noinline, gnu::cold]] bool is_positive_semidefinite_aside(const Eigen::Matrix<Scalar, N, N>& A) {
  return is_positive_semidefinite<N, Scalar>(A);
}

/// The root of A by elimination from the first variable to the last, which is lower triangular, or from the last to the
/// first, upper. No pivot waits for a root: they are drawn beside the elimination.
template <bool from_last, int N, typename Scalar>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, N, N> triangular_root(const Eigen::Matrix<Scalar, N, N>& A) {
  constexpr int kTerms = N * N * N;
  constexpr auto at = [](int step) { return from_last ? N - 1 - step : step; };
  const Eigen::Matrix<Scalar, N, 1> slack = semidefinite_slack<N, Scalar>(A);
  Eigen::Matrix<Scalar, N, N> L;
  each<N, kTerms>([&](int j) __attribute__((always_inline)) {
    each<N, kTerms>([&](int i)
                        __attribute__((always_inline)) { L(at(i), at(j)) = i < j ? Scalar(0) : A(at(i), at(j)); });
  });
  bool valid = true;
  each<N, kTerms>([&](int k) __attribute__((always_inline)) {
    const Scalar pivot = L(at(k), at(k)), least = slack(at(k));
    valid &= (pivot > -least) & (pivot <= std::numeric_limits<Scalar>::max());
    const Scalar lifted = pivot > least ? pivot : least, inverse = 1 / lifted, root = std::sqrt(lifted);
    each<N, kTerms>([&](int i) __attribute__((always_inline)) {
      if (i <= k || is_known_zero(L(at(i), at(k)))) return;
      const Scalar factor = L(at(i), at(k)) * inverse;
      each<N, kTerms>([&](int j) __attribute__((always_inline)) {
        if (k < j && j <= i && !is_known_zero(L(at(j), at(k)))) L(at(i), at(j)) -= factor * L(at(j), at(k));
      });
    });
    each<N, kTerms>([&](int i) __attribute__((always_inline)) {
      if (i > k && !is_known_zero(L(at(i), at(k)))) L(at(i), at(k)) = (L(at(i), at(k)) * inverse) * root;
    });
    // A variance of zero keeps a root of zero: its slack only served the division.
    L(at(k), at(k)) = A(at(k), at(k)) > 0 ? root : Scalar(0);
  });
  if (!valid) [[unlikely]] {  // its pivots refuse some that is_positive_semidefinite() takes
    const Eigen::Matrix<Scalar, N, N> copy = A;
    const bool refused = !is_positive_semidefinite_aside<N, Scalar>(copy);
    each<N, kTerms>([&](int j) __attribute__((always_inline)) {
      each<N, kTerms>([&](int i) __attribute__((always_inline)) {
        if (refused && !is_known_zero(L(i, j))) L(i, j) = std::numeric_limits<Scalar>::quiet_NaN();
      });
    });
  }
  return L;
}

}  // namespace detail

/// Lower triangular L with L L' = A, up to some n eps of the variances. Where A is not positive semi-definite L is NaN,
/// but for zeros that the compiler knows.
template <int N, typename Scalar>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, N, N> semidefinite_root(const Eigen::Matrix<Scalar, N, N>& A) {
  return detail::triangular_root<false, N, Scalar>(A);
}

/// Upper triangular U with U U' = A: the same from the last variable to the first.
template <int N, typename Scalar>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, N, N> upper_semidefinite_root(const Eigen::Matrix<Scalar, N, N>& A) {
  return detail::triangular_root<true, N, Scalar>(A);
}

/// A coefficient, the radius, into which others of its row are rotated (Givens). The radii are the roots of the partial
/// sums of squares, so that none waits for another (Carlson 1973).
template <typename Scalar>
class Rotations {
 public:
  EIGEN_ALWAYS_INLINE explicit Rotations(Scalar radius) : radius_(radius), square_(radius * radius) {}

  Scalar radius() const { return radius_; }

  /// Rotates w into the radius: w becomes zero. False where it was: there is nothing to rotate, and what the compiler
  /// can see to be zero costs nothing.
  EIGEN_ALWAYS_INLINE bool take(Scalar& w) {
    if (detail::is_known_zero(w)) return false;
    const Scalar taken = w, square = w * w;
    w = 0;
    if (square <= 0) return false;
    square_ += square;
    const Scalar next = std::sqrt(square_), inverse = 1 / next;
    cosine_ = radius_ * inverse;
    sine_ = taken * inverse;
    radius_ = next;
    return true;
  }

  /// The same for the coefficients of another row, of which `pivot` is in the radius's column and `other` in that of w.
  EIGEN_ALWAYS_INLINE void turn(Scalar& pivot, Scalar& other) const {
    if (detail::is_known_zero(other)) {
      if (detail::is_known_zero(pivot)) return;
      other = -(sine_ * pivot);
      pivot = cosine_ * pivot;
    } else if (detail::is_known_zero(pivot)) {
      pivot = sine_ * other;
      other = cosine_ * other;
    } else {
      const Scalar turned = cosine_ * pivot + sine_ * other;
      other = cosine_ * other - sine_ * pivot;
      pivot = turned;
    }
  }

 private:
  Scalar radius_, square_, cosine_ = 1, sine_ = 0;
};

/// [A, B] (n x m and n x n) becomes [A, B] Theta = [0, U] with Theta orthogonal, U upper triangular: row by row from the
/// last, Givens rotations of the columns. Rotations, because they multiply where a Householder reflection subtracts:
/// columns of very different size keep their digits (Bierman's example: 1e-15 against 1e-7). What is triangular already
/// stays as it is, to the bit.
template <int N, int M, typename Scalar>
EIGEN_ALWAYS_INLINE void triangularize(Eigen::Matrix<Scalar, N, M>& A, Eigen::Matrix<Scalar, N, N>& B) {
  constexpr int kTerms = N * N * M;
  detail::each<N, kTerms>([&](int step) __attribute__((always_inline)) {
    const int row = N - 1 - step;
    Rotations<Scalar> rotations(B(row, row));
    const auto take = [&](auto& W, int j) __attribute__((always_inline)) {
      if (!rotations.take(W(row, j))) return;
      detail::each<N, kTerms>([&](int i) __attribute__((always_inline)) {
        if (i < row) rotations.turn(B(i, row), W(i, j));
      });
    };
    detail::each<M, kTerms>([&](int j) __attribute__((always_inline)) { take(A, j); });
    detail::each<N, kTerms>([&](int j) __attribute__((always_inline)) {
      if (j < row) take(B, j);
    });
    B(row, row) = rotations.radius();
  });
}

}  // namespace truebearing
