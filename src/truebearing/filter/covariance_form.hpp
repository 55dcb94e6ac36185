// SPDX-License-Identifier: Apache-2.0
// Forms of the covariance recursion that carry P itself (n x n), as policies of KalmanFilter:
//     predict  P = F P F' + Q
//     update   S = H P H' + R,  K = P H' S^-1,  P = (I - K H) P (I - K H)' + K R K'   (Joseph; Bucy and Joseph 1968)
// Each function returns false where its result must not be used.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "truebearing/filter/factorization.hpp"
#include "truebearing/filter/leading_identity.hpp"
#include "truebearing/filter/product.hpp"
#include "truebearing/filter/small_matrix.hpp"
#include "truebearing/filter/update.hpp"
#include "truebearing/motion/any_motion.hpp"

namespace truebearing {

namespace detail {

/// Predicted relative error above which a result is not to be trusted.
inline constexpr double kTrustedError = 1e-3;

template <int N, typename Scalar>
EIGEN_ALWAYS_INLINE void mirror_lower(Eigen::Matrix<Scalar, N, N>& A) {
  for (int j = 1; j < N; ++j)
    for (int i = 0; i < j; ++i) A(i, j) = A(j, i);
}

/// What Joseph and Conventional share: all but how P is updated.
struct CovarianceForm {
  /// P0 as the form carries it; NaN where it is not a covariance, so that every later step says `failed`.
  template <int N, typename Scalar>
  EIGEN_ALWAYS_INLINE static Eigen::Matrix<Scalar, N, N> from_covariance(Eigen::Matrix<Scalar, N, N> P) {
    mirror_lower<N, Scalar>(P);
    if (!is_positive_semidefinite<N, Scalar>(P)) fill(P, std::numeric_limits<Scalar>::quiet_NaN());
    return P;
  }

  template <int N, typename Scalar>
  static const Eigen::Matrix<Scalar, N, N>& to_covariance(const Eigen::Matrix<Scalar, N, N>& P) {
    return P;
  }

  template <int N, typename Scalar>
  EIGEN_ALWAYS_INLINE static bool predict(const Eigen::Matrix<Scalar, N, N>& F, const Eigen::Matrix<Scalar, N, N>& Q,
                                          Eigen::Matrix<Scalar, N, N>& P) {
    const Eigen::Matrix<Scalar, N, N> FP = product(F, P);
    copy(Q, P);
    add_product_transposed<1, Part::lower>(FP, F, P);
    mirror_lower<N, Scalar>(P);
    return is_positive_semidefinite<N, Scalar>(P);
  }

  /// predict() across a motion whose type is not known here. x becomes f(x); `failed` leaves both as they were.
  template <int N>
  static StepStatus across(const SizedMotion<N>& motion, double dt_s, Eigen::Matrix<double, N, 1>& x,
                           Eigen::Matrix<double, N, N>& P, Transition<N>& made) {
    return motion.carry(dt_s, x, P, made);
  }

  /// S, K and NIS; PHt = P H' (n x m). False where R is not positive semi-definite, or where S has lost its digits:
  /// S_ii is summed from terms of the size t_i = sum_j H_ij^2 P_jj + R_ii, so rounding leaves its pivots (the
  /// innovation variances given the components before them) wrong by about t_i eps/2, and S^-1 by eps/2 t_i / pivot,
  /// relatively.
  /// H: a matrix (m x n) or a LeadingIdentity.
  template <int N, int M, typename Scalar, typename Observation>
  EIGEN_ALWAYS_INLINE static bool gain(const Eigen::Matrix<Scalar, N, N>& P, const Observation& H,
                                       const Eigen::Matrix<Scalar, M, M>& R, Eigen::Matrix<Scalar, N, M>& PHt,
                                       Update<N, M, Scalar>& update) {
    constexpr Scalar kLeastPivot = std::numeric_limits<Scalar>::epsilon() / Scalar(2 * kTrustedError);
    PHt = observed(P, H);
    copy(R, update.S);
    add_observed(H, PHt, update.S);
    mirror_lower<M, Scalar>(update.S);
    Eigen::Matrix<Scalar, M, 1> least;
    for (int i = 0; i < M; ++i) {
      const Scalar t = size_of_terms(H, P, R(i, i), i);
      least(i) = kLeastPivot * t + std::numeric_limits<Scalar>::min();
    }
    const Ldlt<M, Scalar> factors(update.S, least);
    if constexpr (M == 1)  // written out: as a loop, PHt would go through memory
      detail::each<N, N>([&](int i) __attribute__((always_inline)) { update.K(i) = factors.inverse_D(0) * PHt(i); });
    else
      factors.solve_rows(PHt, update.K);
    update.nis = dot(update.nu, factors.solve(update.nu));
    return factors.valid & is_positive_semidefinite<M, Scalar>(R);
  }
};

}  // namespace detail

/// The default: positive semi-definite and symmetric whatever K is, and insensitive to first order to errors in K.
struct Joseph : detail::CovarianceForm {
  template <int N, int M, typename Scalar, typename Observation>
  EIGEN_ALWAYS_INLINE static bool update(Eigen::Matrix<Scalar, N, N>& P, const Observation& H,
                                         const Eigen::Matrix<Scalar, M, M>& R, Update<N, M, Scalar>& update) {
    Eigen::Matrix<Scalar, N, M> PHt;
    const bool valid = gain<N, M, Scalar>(P, H, R, PHt, update);
    // The product taken one factor at a time, A = (I - K H) P, then A - (A H' - K R) K': the same errors as with I - K
    // H formed, for fewer multiplications.
    add_product<-1>(update.K, transposed(PHt), P);
    PHt = detail::observed(P, H);
    add_product<-1>(update.K, R, PHt);
    add_product<-1, Part::lower>(PHt, transposed(update.K), P);
    if constexpr (N == 2) P(0, 0) = by_itself(P(0, 0));  // the next step waits for P
    detail::mirror_lower<N, Scalar>(P);
    return valid & is_positive_semidefinite<N, Scalar>(P);
  }
};

/// P - K S K', symmetrised. For comparison only: where a measurement is much better than the prediction, it subtracts
/// nearly equal matrices, and says so only once P is no longer positive semi-definite.
struct Conventional : detail::CovarianceForm {
  template <int N, int M, typename Scalar, typename Observation>
  EIGEN_ALWAYS_INLINE static bool update(Eigen::Matrix<Scalar, N, N>& P, const Observation& H,
                                         const Eigen::Matrix<Scalar, M, M>& R, Update<N, M, Scalar>& update) {
    Eigen::Matrix<Scalar, N, M> PHt;
    const bool valid = gain<N, M, Scalar>(P, H, R, PHt, update);
    add_product<-1>(update.K, transposed(PHt), P);
    for (int j = 0; j < N; ++j)
      for (int i = 0; i <= j; ++i) P(i, j) = P(j, i) = Scalar(0.5) * (P(i, j) + P(j, i));
    return valid & is_positive_semidefinite<N, Scalar>(P);
  }
};

}  // namespace truebearing
