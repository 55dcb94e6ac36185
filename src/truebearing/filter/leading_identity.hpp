// SPDX-License-Identifier: Apache-2.0
// H = [I, 0] (m x n) as a type: of a measurement of the first m components nothing is multiplied. A measurement model
// may give it in place of a matrix.
#pragma once

#include <Eigen/Core>
#include <type_traits>

#include "truebearing/filter/product.hpp"
#include "truebearing/filter/small_matrix.hpp"

namespace truebearing {

template <int M, int N, typename ScalarType = double>
struct LeadingIdentity {
  using Matrix = Eigen::Matrix<ScalarType, M, N>;
  operator Matrix() const { return Matrix::Identity(); }  // NOLINT
};

namespace detail {

/// P H' (n x m); P need not be symmetric.
template <typename Scalar, int N, int M>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, N, M> observed(const Eigen::Matrix<Scalar, N, N>& P,
                                                         const Eigen::Matrix<Scalar, M, N>& H) {
  return product(P, transposed(H));
}
template <typename Scalar, int N, int M>
EIGEN_ALWAYS_INLINE Eigen::Matrix<Scalar, N, M> observed(const Eigen::Matrix<Scalar, N, N>& P,
                                                         const LeadingIdentity<M, N, Scalar>&) {
  Eigen::Matrix<Scalar, N, M> PHt;
  take(P, 0, 0, PHt);
  return PHt;
}

/// S + H PHt into the lower part of S (m x m).
template <typename Scalar, int N, int M>
EIGEN_ALWAYS_INLINE void add_observed(const Eigen::Matrix<Scalar, M, N>& H, const Eigen::Matrix<Scalar, N, M>& PHt,
                                      Eigen::Matrix<Scalar, M, M>& S) {
  add_product<1, Part::lower>(H, PHt, S);
}
template <typename Scalar, int N, int M>
EIGEN_ALWAYS_INLINE void add_observed(const LeadingIdentity<M, N, Scalar>&, const Eigen::Matrix<Scalar, N, M>& PHt,
                                      Eigen::Matrix<Scalar, M, M>& S) {
  for (int j = 0; j < M; ++j)
    for (int i = j; i < M; ++i) S(i, j) += PHt(i, j);
}

/// sum_j H_ij^2 P_jj + R_ii: the size of the terms that S_ii is summed from.
template <typename Scalar, int N, int M>
EIGEN_ALWAYS_INLINE Scalar size_of_terms(const Eigen::Matrix<Scalar, M, N>& H, const Eigen::Matrix<Scalar, N, N>& P,
                                         Scalar R_ii, int i) {
  each<N, N>([&](int j) __attribute__((always_inline)) {
    if (!is_known_zero(H(i, j))) R_ii += H(i, j) * H(i, j) * P(j, j);
  });
  return R_ii;
}
template <typename Scalar, int N, int M>
EIGEN_ALWAYS_INLINE Scalar size_of_terms(const LeadingIdentity<M, N, Scalar>&, const Eigen::Matrix<Scalar, N, N>& P,
                                         Scalar R_ii, int i) {
  return R_ii + P(i, i);
}

/// What a model gives as its H: a matrix, unless it is known better.
template <typename Model>
EIGEN_ALWAYS_INLINE auto jacobian_of(const Model& model,
                                     const Eigen::Matrix<typename Model::Scalar, Model::kStates, 1>& x) {
  using Known = LeadingIdentity<Model::kMeasurements, Model::kStates, typename Model::Scalar>;
  if constexpr (std::is_same_v<decltype(model.H(x)), Known>)
    return Known();
  else
    return typename Known::Matrix(model.H(x));
}

}  // namespace detail

}  // namespace truebearing
