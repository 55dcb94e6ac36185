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
    return U.lazyProduct(U.transpose());
  }

  template <int N, typename Scalar>
  static bool predict(const Eigen::Matrix<Scalar, N, N>& F, const Eigen::Matrix<Scalar, N, N>& Q,
                      Eigen::Matrix<Scalar, N, N>& U) {
    Eigen::Matrix<Scalar, N, 2 * N> array;
    array.template leftCols<N>() = semidefinite_root<N, Scalar>(Q);
    array.template rightCols<N>().noalias() = F * U;
    triangularize<N, 2 * N, Scalar>(array);
    U = array.template rightCols<N>();
    return is_finite<N, Scalar>(U);
  }

  /// predict() across a motion whose type is not known here. x becomes f(x); `failed` leaves both as they were.
  template <int N>
  static StepStatus across(const SizedMotion<N>& motion, double dt_s, Eigen::Matrix<double, N, 1>& x,
                           Eigen::Matrix<double, N, N>& U) {
    Eigen::Matrix<double, N, N> new_U = U;
    const bool valid = predict<N, double>(motion.F(x, dt_s), motion.Q(dt_s), new_U);
    return commit<double, N>(valid, motion.f(x, dt_s), new_U, x, U);
  }

  /// False where R is not positive semi-definite, or where S^1/2 has lost its digits: its row i is rotated from terms
  /// of the size t_i^1/2, t_i = sum_j H_ij^2 P_jj + R_ii, so rounding leaves a pivot wrong by up to eps/2 t_i^1/2 /
  /// pivot, relatively.
  template <int N, int M, typename Scalar>
  static bool update(Eigen::Matrix<Scalar, N, N>& U, const Eigen::Matrix<Scalar, M, N>& H,
                     const Eigen::Matrix<Scalar, M, M>& R, Update<N, M, Scalar>& update) {
    // A relative error of up to 1/128, in the worst case; what is seen is a tenth of it.
    constexpr Scalar kLeastPivot = 64 * std::numeric_limits<Scalar>::epsilon();
    const Eigen::Matrix<Scalar, M, 1> t = H.cwiseAbs2() * U.rowwise().squaredNorm() + R.diagonal();

    Eigen::Matrix<Scalar, N + M, N + M> array;
    array.template topLeftCorner<N, N>() = U;
    array.template topRightCorner<N, M>().setZero();
    array.template bottomLeftCorner<M, N>().noalias() = H * U;
    array.template bottomRightCorner<M, M>() = semidefinite_root<M, Scalar>(R);
    triangularize<N + M, N + M, Scalar>(array);
    U = array.template topLeftCorner<N, N>();
    const Eigen::Matrix<Scalar, M, M> root = array.template bottomRightCorner<M, M>();
    update.S.noalias() = root * root.transpose();

    // K = (K S^1/2) S^-1/2 and nis = |S^-1/2 nu|^2 by substitution.
    bool valid = true;
    update.K = array.template topRightCorner<N, M>();
    for (int k = 0; k < M; ++k) {
      valid &= root(k, k) > kLeastPivot * std::sqrt(t(k));
      for (int i = 0; i < k; ++i) update.K.col(k) -= update.K.col(i) * root(i, k);
      update.K.col(k) /= root(k, k);
    }
    Eigen::Matrix<Scalar, M, 1> whitened = update.nu;
    for (int k = M - 1; k >= 0; --k) {
      for (int i = k + 1; i < M; ++i) whitened(k) -= root(k, i) * whitened(i);
      whitened(k) /= root(k, k);
    }
    update.nis = whitened.squaredNorm();
    return valid & is_finite<N, Scalar>(U);
  }

 private:
  template <int N, typename Scalar>
  static bool is_finite(const Eigen::Matrix<Scalar, N, N>& U) {
    return (U * Scalar(0)).sum() == 0;
  }
};

}  // namespace truebearing
