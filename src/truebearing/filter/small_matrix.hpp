// SPDX-License-Identifier: Apache-2.0
// What the filters do with small fixed-size matrices besides products (product.hpp), as plain loops. Eigen's expressions
// run no faster at these sizes, and each of them costs the compiler anew for every size of state and measurement:
// together most of the time that a file of filters took.
#pragma once

#include <Eigen/Core>
#include <type_traits>

namespace truebearing {

/// A becomes `value` throughout.
template <typename Scalar, int Rows, int Cols>
EIGEN_ALWAYS_INLINE void fill(Eigen::Matrix<Scalar, Rows, Cols>& A, Scalar value) {
  for (int j = 0; j < Cols; ++j)
    for (int i = 0; i < Rows; ++i) A(i, j) = value;
}

/// The block of `whole` whose first coefficient is (row, col) becomes A.
template <typename Scalar, int Rows, int Cols, int AllRows, int AllCols>
EIGEN_ALWAYS_INLINE void put(const Eigen::Matrix<Scalar, Rows, Cols>& A, Eigen::Matrix<Scalar, AllRows, AllCols>& whole,
                             int row, int col) {
  for (int j = 0; j < Cols; ++j)
    for (int i = 0; i < Rows; ++i) whole(row + i, col + j) = A(i, j);
}

/// A becomes the block of `whole` whose first coefficient is (row, col).
template <typename Scalar, int Rows, int Cols, int AllRows, int AllCols>
EIGEN_ALWAYS_INLINE void take(const Eigen::Matrix<Scalar, AllRows, AllCols>& whole, int row, int col,
                              Eigen::Matrix<Scalar, Rows, Cols>& A) {
  for (int j = 0; j < Cols; ++j)
    for (int i = 0; i < Rows; ++i) A(i, j) = whole(row + i, col + j);
}

template <typename Scalar, int Rows, int Cols>
EIGEN_ALWAYS_INLINE void copy(const Eigen::Matrix<Scalar, Rows, Cols>& A, Eigen::Matrix<Scalar, Rows, Cols>& B) {
  take(A, 0, 0, B);
}

/// A', as a matrix of its own.
template <typename Scalar, int Rows, int Cols>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, Cols, Rows> transposed(const Eigen::Matrix<Scalar, Rows, Cols>& A) {
  Eigen::Matrix<Scalar, Cols, Rows> B;
  for (int j = 0; j < Cols; ++j)
    for (int i = 0; i < Rows; ++i) B(j, i) = A(i, j);
  return B;
}

template <typename Scalar, int Rows, int Cols>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, Rows, 1> column(const Eigen::Matrix<Scalar, Rows, Cols>& A, int j) {
  Eigen::Matrix<Scalar, Rows, 1> a;
  take(A, 0, j, a);
  return a;
}

template <typename Scalar, int Rows, int Cols>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, Rows, Cols> plus(const Eigen::Matrix<Scalar, Rows, Cols>& A,
                                                           const Eigen::Matrix<Scalar, Rows, Cols>& B) {
  Eigen::Matrix<Scalar, Rows, Cols> C;
  for (int j = 0; j < Cols; ++j)
    for (int i = 0; i < Rows; ++i) C(i, j) = A(i, j) + B(i, j);
  return C;
}

template <typename Scalar, int Rows, int Cols>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, Rows, Cols> minus(const Eigen::Matrix<Scalar, Rows, Cols>& A,
                                                            const Eigen::Matrix<Scalar, Rows, Cols>& B) {
  Eigen::Matrix<Scalar, Rows, Cols> C;
  for (int j = 0; j < Cols; ++j)
    for (int i = 0; i < Rows; ++i) C(i, j) = A(i, j) - B(i, j);
  return C;
}

/// `a` as it is, computed by itself: GCC does not put it into one vector with its neighbour. For a column of two numbers
/// that gains nothing, and costs a shuffle wherever one of them is needed without the other.
template <typename Scalar>
EIGEN_ALWAYS_INLINE Scalar by_itself(Scalar a) {
#ifdef __has_builtin
#if __has_builtin(__builtin_assoc_barrier)
  if constexpr (std::is_floating_point_v<Scalar>) return __builtin_assoc_barrier(a);
#endif
#endif
  return a;
}

template <typename Scalar, int Rows>
EIGEN_ALWAYS_INLINE Scalar dot(const Eigen::Matrix<Scalar, Rows, 1>& x, const Eigen::Matrix<Scalar, Rows, 1>& y) {
  Scalar sum = x(0) * y(0);
  for (int i = 1; i < Rows; ++i) sum += x(i) * y(i);
  return sum;
}

template <typename Scalar, int Rows, int Cols>
EIGEN_ALWAYS_INLINE bool is_finite(const Eigen::Matrix<Scalar, Rows, Cols>& A) {
  Eigen::Matrix<Scalar, Rows, 1> zeros;  // of finite numbers only; a sum for each row, for none to wait on another
  fill(zeros, Scalar(0));
  for (int j = 0; j < Cols; ++j)
    for (int i = 0; i < Rows; ++i) zeros(i) += A(i, j) * 0;
  bool finite = true;
  for (int i = 0; i < Rows; ++i) finite &= zeros(i) == 0;
  return finite;
}

/// The matrix that stands at `data`, by columns.
template <int Rows, int Cols, typename Scalar>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, Rows, Cols> matrix_at(const Scalar* data) {
  Eigen::Matrix<Scalar, Rows, Cols> A;
  for (int j = 0; j < Cols; ++j)
    for (int i = 0; i < Rows; ++i) A(i, j) = *data++;
  return A;
}

}  // namespace truebearing
