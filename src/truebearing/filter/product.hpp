// Products and copies of small fixed-size matrices. Up to three rows coefficient by coefficient: there Eigen's packets
// cost more in moves than they save, and keep the compiler from holding a filter in registers. From four rows on they
// pay.
#pragma once

#include <Eigen/Core>

namespace truebearing {

template <typename Scalar, int Rows, int Cols>
EIGEN_ALWAYS_INLINE void copy(const Eigen::Matrix<Scalar, Rows, Cols>& A, Eigen::Matrix<Scalar, Rows, Cols>& B) {
  for (int j = 0; j < Cols; ++j)
    for (int i = 0; i < Rows; ++i) B(i, j) = A(i, j);
}

/// C + Sign A B into C.
template <int Sign, typename Scalar, int Rows, int Inner, int Cols>
EIGEN_ALWAYS_INLINE void add_product(const Eigen::Matrix<Scalar, Rows, Inner>& A,
                                     const Eigen::Matrix<Scalar, Inner, Cols>& B,
                                     Eigen::Matrix<Scalar, Rows, Cols>& C) {
  if constexpr (Rows > 3) {
    C.noalias() += (Scalar(Sign) * A).lazyProduct(B);
  } else {
    for (int j = 0; j < Cols; ++j)
      for (int k = 0; k < Inner; ++k)
        for (int i = 0; i < Rows; ++i) C(i, j) += Sign * (A(i, k) * B(k, j));
  }
}

/// A B.
template <typename Scalar, int Rows, int Inner, int Cols>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, Rows, Cols> product(const Eigen::Matrix<Scalar, Rows, Inner>& A,
                                                              const Eigen::Matrix<Scalar, Inner, Cols>& B) {
  Eigen::Matrix<Scalar, Rows, Cols> C;
  if constexpr (Rows > 3) {
    C.noalias() = A.lazyProduct(B);
  } else {
    for (int j = 0; j < Cols; ++j) {
      for (int i = 0; i < Rows; ++i) C(i, j) = A(i, 0) * B(0, j);
      for (int k = 1; k < Inner; ++k)
        for (int i = 0; i < Rows; ++i) C(i, j) += A(i, k) * B(k, j);
    }
  }
  return C;
}

/// A', as a matrix of its own.
template <typename Scalar, int Rows, int Cols>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, Cols, Rows> transposed(const Eigen::Matrix<Scalar, Rows, Cols>& A) {
  Eigen::Matrix<Scalar, Cols, Rows> B;
  for (int j = 0; j < Cols; ++j)
    for (int i = 0; i < Rows; ++i) B(j, i) = A(i, j);
  return B;
}

}  // namespace truebearing
