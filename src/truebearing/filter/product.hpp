// SPDX-License-Identifier: Apache-2.0
// Products of small fixed-size matrices, written out coefficient by coefficient: nothing keeps a filter out of
// registers, and a term with a factor of zero that the compiler can see is left out. So the structure of a model costs
// nothing and stands nowhere but in its own F and H: F P of four states at constant velocity takes 8 multiplications,
// not 64.
#pragma once

#include <Eigen/Core>
#include <utility>

#include "truebearing/core/status.hpp"
#include "truebearing/filter/small_matrix.hpp"

namespace truebearing {

/// Which coefficients of a product are formed: all, or those on and below the diagonal of a symmetric result.
enum class Part { all, lower };

namespace detail {

/// Products of more multiplications than this are loops that the optimiser unrolls, as far as it finds that worth
/// while: what is written out coefficient by coefficient takes the compiler longer with every one of them. A build
/// under the sanitizers, which add to every coefficient, has loops only.
#ifdef TRUEBEARING_PRODUCTS_AS_LOOPS
inline constexpr int kMostWrittenOut = 0;
#else
inline constexpr int kMostWrittenOut = 64;
#endif

/// body(0), ..., body(Count - 1), for a product of `multiplications`.
template <int Count, int multiplications, typename Body>
EIGEN_ALWAYS_INLINE void each(const Body& body) {
  if constexpr (multiplications <= kMostWrittenOut) {
    [&]<int... I>(std::integer_sequence<int, I...>) __attribute__((always_inline)) {
      (body(I), ...);
    }
    (std::make_integer_sequence<int, Count>());
  } else {
#pragma GCC unroll 64
    for (int i = 0; i < Count; ++i) body(i);
  }
}

/// A zero that a model never sets. False for whatever is known only at run time.
template <typename Scalar>
EIGEN_ALWAYS_INLINE bool is_known_zero(Scalar a) {
  return __builtin_constant_p(a) && a == 0;
}

}  // namespace detail

/// How a filter's step ends: x and what is carried of P become the new ones, where these are valid and x is finite.
template <typename Scalar, int N>
EIGEN_ALWAYS_INLINE StepStatus commit(bool valid, const Eigen::Matrix<Scalar, N, 1>& new_x,
                                      const Eigen::Matrix<Scalar, N, N>& new_P, Eigen::Matrix<Scalar, N, 1>& x,
                                      Eigen::Matrix<Scalar, N, N>& P) {
  Scalar zero = 0;  // of finite numbers only; from the first on, for pairs of them to be those that are stored together
  for (int i = 0; i < N; ++i) zero += new_x(i) - new_x(i);
  if (!(valid & (zero >= 0))) return StepStatus::failed;
  copy(new_x, x);
  copy(new_P, P);
  return StepStatus::ok;
}

/// C + Sign A B into C.
template <int Sign, Part part = Part::all, typename Scalar, int Rows, int Inner, int Cols>
EIGEN_ALWAYS_INLINE void add_product(const Eigen::Matrix<Scalar, Rows, Inner>& A,
                                     const Eigen::Matrix<Scalar, Inner, Cols>& B,
                                     Eigen::Matrix<Scalar, Rows, Cols>& C) {
  detail::each<Rows * Cols, Rows * Inner * Cols>([&](int index) __attribute__((always_inline)) {
    const int i = index % Rows, j = index / Rows;
    if (part == Part::lower && i < j) return;
    detail::each<Inner, Rows * Inner * Cols>([&](int k) __attribute__((always_inline)) {
      if (!detail::is_known_zero(A(i, k)) && !detail::is_known_zero(B(k, j))) C(i, j) += Sign * (A(i, k) * B(k, j));
    });
  });
}

/// C + Sign A B' into C: what is known of B's coefficients stays known, which it would not in a transposed copy.
template <int Sign, Part part = Part::all, typename Scalar, int Rows, int Inner, int Cols>
EIGEN_ALWAYS_INLINE void add_product_transposed(const Eigen::Matrix<Scalar, Rows, Inner>& A,
                                                const Eigen::Matrix<Scalar, Cols, Inner>& B,
                                                Eigen::Matrix<Scalar, Rows, Cols>& C) {
  detail::each<Rows * Cols, Rows * Inner * Cols>([&](int index) __attribute__((always_inline)) {
    const int i = index % Rows, j = index / Rows;
    if (part == Part::lower && i < j) return;
    detail::each<Inner, Rows * Inner * Cols>([&](int k) __attribute__((always_inline)) {
      if (!detail::is_known_zero(A(i, k)) && !detail::is_known_zero(B(j, k))) C(i, j) += Sign * (A(i, k) * B(j, k));
    });
  });
}

/// A B.
template <typename Scalar, int Rows, int Inner, int Cols>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, Rows, Cols> product(const Eigen::Matrix<Scalar, Rows, Inner>& A,
                                                              const Eigen::Matrix<Scalar, Inner, Cols>& B) {
  Eigen::Matrix<Scalar, Rows, Cols> C;
  detail::each<Rows * Cols, Rows * Inner * Cols>([&](int index) __attribute__((always_inline)) {
    const int i = index % Rows, j = index / Rows;
    Scalar sum = 0;
    bool empty = true;
    detail::each<Inner, Rows * Inner * Cols>([&](int k) __attribute__((always_inline)) {
      if (detail::is_known_zero(A(i, k)) || detail::is_known_zero(B(k, j))) return;
      sum = empty ? A(i, k) * B(k, j) : sum + A(i, k) * B(k, j);
      empty = false;
    });
    C(i, j) = sum;
  });
  return C;
}

}  // namespace truebearing
