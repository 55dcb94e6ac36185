// SPDX-License-Identifier: Apache-2.0
// The square-root covariance filter (SRCF) in array form, as a policy of KalmanFilter: carries the upper triangular U
// (n x n), P = U U', which reaches twice as many digits down as P does. Theta is orthogonal, found by
// triangularization:
//     predict  [Q^1/2, F U] Theta = [0, U]
//     update   [U, 0; H U, R^1/2] Theta = [U, K S^1/2; 0, S^1/2]
// Kailath, Sayed and Hassibi 2000, section 12.3, with the measurement last and upper triangles (Bierman's) for lower
// ones: his example loses half its digits in the rounding of H L.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "truebearing/filter/factorization.hpp"
#include "truebearing/filter/product.hpp"
#include "truebearing/filter/small_matrix.hpp"
#include "truebearing/filter/update.hpp"
#include "truebearing/motion/any_motion.hpp"

namespace truebearing {

struct SquareRoot {
  /// NaN where P is not positive semi-definite, so that every later step says `failed`.
  template <int N, typename Scalar>
  static Eigen::Matrix<Scalar, N, N> from_covariance(const Eigen::Matrix<Scalar, N, N>& P) {
    Eigen::Matrix<Scalar, N, N> U = semidefinite_root<N, Scalar>(P);
    triangularize<N, N, Scalar>(U);
    return U;
  }

  template <int N, typename Scalar>
  static Eigen::Matrix<Scalar, N, N> to_covariance(const Eigen::Matrix<Scalar, N, N>& U) {
    Eigen::Matrix<Scalar, N, N> P;
    for (int j = 0; j < N; ++j)
      for (int i = 0; i <= j; ++i) {
        P(i, j) = U(i, j) * U(j, j);
        for (int k = j + 1; k < N; ++k) P(i, j) += U(i, k) * U(j, k);
        P(j, i) = P(i, j);
      }
    return P;
  }

  template <int N, typename Scalar>
  static bool predict(const Eigen::Matrix<Scalar, N, N>& F, const Eigen::Matrix<Scalar, N, N>& Q,
                      Eigen::Matrix<Scalar, N, N>& U) {
    Eigen::Matrix<Scalar, N, 2 * N> array;
    put(upper_semidefinite_root<N, Scalar>(Q), array, 0, 0);  // as F U mostly is: less to rotate
    put(product(F, U), array, 0, N);
    triangularize<N, 2 * N, Scalar>(array);
    take(array, 0, N, U);
    return is_finite(U);
  }

  /// predict() across a motion whose type is not known here. x becomes f(x); `failed` leaves both as they were.
  template <int N>
  static StepStatus across(const SizedMotion<N>& motion, double dt_s, Eigen::Matrix<double, N, 1>& x,
                           Eigen::Matrix<double, N, N>& U, Transition<N>&) {
    Eigen::Matrix<double, N, N> new_U = U;
    const bool valid = predict<N, double>(motion.F(x, dt_s), motion.Q(dt_s), new_U);
    return commit<double, N>(valid, motion.f(x, dt_s), new_U, x, U);
  }

  /// False where R is not positive semi-definite, or where S^1/2 has lost its digits: its row i is rotated from terms
  /// of the size t_i^1/2, t_i = sum_j H_ij^2 P_jj + R_ii, so rounding leaves a pivot wrong by up to eps/2 t_i^1/2 /
  /// pivot, relatively.
  template <int N, int M, typename Scalar>
  EIGEN_ALWAYS_INLINE static bool update(Eigen::Matrix<Scalar, N, N>& U, const Eigen::Matrix<Scalar, M, N>& H,
                                         const Eigen::Matrix<Scalar, M, M>& R, Update<N, M, Scalar>& update) {
    // A relative error of up to 1/128, in the worst case; what is seen is a tenth of it.
    constexpr Scalar kLeastPivot = 64 * std::numeric_limits<Scalar>::epsilon();
    const Eigen::Matrix<Scalar, N, 1> variance = diagonal<N, Scalar>(U);
    Eigen::Matrix<Scalar, M, 1> t;
    for (int i = 0; i < M; ++i) {
      t(i) = R(i, i);
      for (int j = 0; j < N; ++j) t(i) += H(i, j) * H(i, j) * variance(j);
    }

    Eigen::Matrix<Scalar, N + M, N + M> array;
    put(U, array, 0, 0);
    fill(update.K, Scalar(0));
    put(update.K, array, 0, N);
    put(product(H, U), array, N, 0);
    put(semidefinite_root<M, Scalar>(R), array, N, N);
    triangularize<N + M, N + M, Scalar>(array);
    Eigen::Matrix<Scalar, M, M> root;
    take(array, 0, 0, U);
    take(array, 0, N, update.K);
    take(array, N, N, root);
    update.S = product(root, transposed(root));

    // K = (K S^1/2) S^-1/2 and nis = |S^-1/2 nu|^2 by substitution.
    bool valid = true;
    for (int k = 0; k < M; ++k) {
      valid &= root(k, k) > kLeastPivot * std::sqrt(t(k));
      for (int i = 0; i < k; ++i)
        for (int row = 0; row < N; ++row) update.K(row, k) -= update.K(row, i) * root(i, k);
      for (int row = 0; row < N; ++row) update.K(row, k) /= root(k, k);
    }
    Eigen::Matrix<Scalar, M, 1> whitened = update.nu;
    for (int k = M - 1; k >= 0; --k) {
      for (int i = k + 1; i < M; ++i) whitened(k) -= root(k, i) * whitened(i);
      whitened(k) /= root(k, k);
    }
    update.nis = dot(whitened, whitened);
    return valid & is_finite(U);
  }

 private:
  /// Of P.
  template <int N, typename Scalar>
  static Eigen::Matrix<Scalar, N, 1> diagonal(const Eigen::Matrix<Scalar, N, N>& U) {
    Eigen::Matrix<Scalar, N, 1> variances;
    for (int i = 0; i < N; ++i) {
      variances(i) = U(i, i) * U(i, i);
      for (int j = i + 1; j < N; ++j) variances(i) += U(i, j) * U(i, j);
    }
    return variances;
  }
};

}  // namespace truebearing
