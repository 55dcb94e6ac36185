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
#include <limits>

#include "truebearing/core/constants.hpp"
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
    return upper_semidefinite_root<N, Scalar>(P);
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
  EIGEN_ALWAYS_INLINE static bool predict(const Eigen::Matrix<Scalar, N, N>& F, const Eigen::Matrix<Scalar, N, N>& Q,
                                          Eigen::Matrix<Scalar, N, N>& U) {
    return carry<N, Scalar>(F, upper_semidefinite_root<N, Scalar>(Q), U);  // upper, as F U mostly is: less to rotate
  }

  /// predict() across a motion whose type is not known here. x becomes f(x); `failed` leaves both as they were. Where Q
  /// would stand `made` keeps its root.
  template <int N>
  static StepStatus across(const SizedMotion<N>& motion, double dt_s, Eigen::Matrix<double, N, 1>& x,
                           Eigen::Matrix<double, N, N>& U, Transition<N>& made) {
    if (made.dt_s != dt_s) make<N>(motion, dt_s, made);
    const Eigen::Matrix<double, N, N> F = motion.is_linear() ? made.F : motion.F(x, dt_s);
    Eigen::Matrix<double, N, N> new_U = U;
    const bool valid = carry<N, double>(F, made.Q, new_U);
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
    constexpr int kTerms = N * N * M;
    Eigen::Matrix<Scalar, N, N> upper = upper_of<N, Scalar>(U);
    const Eigen::Matrix<Scalar, N, 1> variance = diagonal<N, Scalar>(upper);
    Eigen::Matrix<Scalar, M, 1> t;
    detail::each<M, N * M>([&](int i) __attribute__((always_inline)) {
      t(i) = R(i, i);
      detail::each<N, N * M>([&](int j) __attribute__((always_inline)) {
        if (!detail::is_known_zero(H(i, j))) t(i) += H(i, j) * H(i, j) * variance(j);
      });
    });

    // Of the array only the lower rows have to become zero. Column by column from the first, U stays triangular.
    Eigen::Matrix<Scalar, M, N> HU = product(H, upper);
    Eigen::Matrix<Scalar, M, M> root = upper_semidefinite_root<M, Scalar>(R);
    detail::each<N * M, N * M>([&](int i) __attribute__((always_inline)) { update.K.data()[i] = 0; });
    detail::each<M, kTerms>([&](int step) __attribute__((always_inline)) {
      const int row = M - 1 - step;
      Rotations<Scalar> rotations(root(row, row));
      detail::each<N, kTerms>([&](int j) __attribute__((always_inline)) {
        if (!rotations.take(HU(row, j))) return;
        detail::each<M, kTerms>([&](int i) __attribute__((always_inline)) {
          if (i < row) rotations.turn(root(i, row), HU(i, j));
        });
        detail::each<N, kTerms>([&](int i) __attribute__((always_inline)) {
          if (i <= j) rotations.turn(update.K(i, row), upper(i, j));
        });
      });
      root(row, row) = rotations.radius();
    });
    copy(upper, U);
    update.S = product(root, transposed(root));

    // K = (K S^1/2) S^-1/2 and nis = |S^-1/2 nu|^2 by substitution.
    bool valid = true;
    for (int k = 0; k < M; ++k) {
      valid &= root(k, k) * root(k, k) > kLeastPivot * kLeastPivot * t(k);
      for (int i = 0; i < k; ++i)
        for (int row = 0; row < N; ++row) update.K(row, k) -= update.K(row, i) * root(i, k);
      const Scalar inverse = 1 / root(k, k);
      for (int row = 0; row < N; ++row) update.K(row, k) *= inverse;
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
  template <int N>
  [[gnu::noinline]] static void make(const SizedMotion<N>& motion, double dt_s, Transition<N>& made) {
    made.dt_s = kNaN;
    if (motion.is_linear()) made.F = motion.F(Eigen::Matrix<double, N, 1>::Zero(), dt_s);
    made.Q = upper_semidefinite_root<N, double>(motion.Q(dt_s));
    made.dt_s = dt_s;
  }

  /// U across F and Q, given the root of Q.
  template <int N, typename Scalar>
  EIGEN_ALWAYS_INLINE static bool carry(const Eigen::Matrix<Scalar, N, N>& F, Eigen::Matrix<Scalar, N, N> root_Q,
                                        Eigen::Matrix<Scalar, N, N>& U) {
    Eigen::Matrix<Scalar, N, N> FU = product(F, upper_of<N, Scalar>(U));
    triangularize<N, N, Scalar>(root_Q, FU);
    copy(FU, U);
    return is_finite(U);
  }

  /// U, which is zero below its diagonal: the compiler cannot know unless it is written here.
  template <int N, typename Scalar>
  EIGEN_ALWAYS_INLINE static Eigen::Matrix<Scalar, N, N> upper_of(const Eigen::Matrix<Scalar, N, N>& U) {
    Eigen::Matrix<Scalar, N, N> upper;
    detail::each<N, N * N>([&](int j) __attribute__((always_inline)) {
      detail::each<N, N * N>([&](int i) __attribute__((always_inline)) { upper(i, j) = i <= j ? U(i, j) : Scalar(0); });
    });
    return upper;
  }

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
