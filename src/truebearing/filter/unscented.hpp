// SPDX-License-Identifier: Apache-2.0
// The unscented Kalman filter: state x (n), covariance P (n x n), the same interface as KalmanFilter, no Jacobians.
// Mean and covariance of f and h are those over 2 n + 1 points x, x +- c L_i, where P = L L' and c^2 = n + kappa:
//     predict  x = sum w f,  P = sum w (f - x)(f - x)' + Q
//     update   S = sum w d d' + R,  K = (sum w (X - x) d') S^-1,  d = residual of h from its mean
// Julier and Uhlmann 2004, with alpha = 1 and beta = 0. kappa = 3 - n matches the fourth moment of a normal x; from n =
// 4 on it is 0, so that no weight is negative and every sum of squares is a covariance.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "truebearing/core/status.hpp"
#include "truebearing/filter/covariance_form.hpp"
#include "truebearing/filter/factorization.hpp"
#include "truebearing/filter/product.hpp"
#include "truebearing/filter/small_matrix.hpp"
#include "truebearing/filter/update.hpp"
#include "truebearing/measurement/measurement_model.hpp"
#include "truebearing/motion/any_motion.hpp"
#include "truebearing/motion/motion_model.hpp"

namespace truebearing {

/// A small value: no heap, no virtual call.
template <int N, typename ScalarType = double>
class UnscentedKalmanFilter {
 public:
  using Scalar = ScalarType;
  static constexpr int kStates = N;
  using State = Eigen::Matrix<Scalar, N, 1>;
  using Covariance = Eigen::Matrix<Scalar, N, N>;

  /// P0 may be singular: L comes from semidefinite_root(), which lifts a vanishing pivot to the rounding error of its
  /// variance and lets a variance of zero spread no points; nothing is added to P itself. Where P0 is not positive
  /// semi-definite P() is NaN and every step says `failed`.
  UnscentedKalmanFilter(const State& x0, const Covariance& P0)
      : x_(x0), P_(detail::CovarianceForm::from_covariance<N, Scalar>(P0)) {}

  /// Crosses dt_s seconds. `failed` leaves x and P as they were: a result that is not finite, a P that is not positive
  /// semi-definite. Of a linear motion the points have the mean and covariance that F gives, so F is used.
  template <LinearMotionModel Motion>
  EIGEN_ALWAYS_INLINE StepStatus predict(const Motion& motion, Scalar dt_s) {
    static_assert(Motion::kStates == N && std::is_same_v<typename Motion::Scalar, Scalar>);
    const Covariance F = motion.F(dt_s);
    Covariance P = P_;
    const bool valid = detail::CovarianceForm::predict<N, Scalar>(F, motion.Q(dt_s), P);
    return commit(valid, product(F, x_), P, x_, P_);
  }

  /// The same across a nonlinear motion, through the points.
  template <NonlinearMotionModel Motion>
  StepStatus predict(const Motion& motion, Scalar dt_s) {
    static_assert(Motion::kStates == N && std::is_same_v<typename Motion::Scalar, Scalar>);
    const PointStates X = points(semidefinite_root<N, Scalar>(P_));
    const State centre = motion.f(x_, dt_s);
    Points<N> d;  // from the centre
    for (int i = 0; i < kPoints; ++i)
      put(minus(State(motion.f(X[static_cast<std::size_t>(i)], dt_s)), centre), d, 0, i);
    const State mean = mean_of<N>(d);
    Covariance P = motion.Q(dt_s);
    if constexpr (kCentreWeight > 0) add_square<N>(kCentreWeight, mean, P);
    for (int i = 0; i < kPoints; ++i) add_square<N>(kWeight, minus(column(d, i), mean), P);
    detail::mirror_lower<N, Scalar>(P);
    return commit(is_positive_semidefinite<N, Scalar>(P), plus(centre, mean), P, x_, P_);
  }

  /// The same across a motion whose type is not known here.
  StepStatus predict(const SizedMotion<N>& motion, double dt_s) requires std::is_same_v<Scalar, double> {
    Transition<N> made;
    return predict(motion, dt_s, made);
  }
  /// made: by this motion, or nothing yet; becomes that of dt_s.
  StepStatus predict(const SizedMotion<N>& motion, double dt_s,
                     Transition<N>& made) requires std::is_same_v<Scalar, double> {
    if (!motion.is_linear()) return predict<SizedMotion<N>>(motion, dt_s);
    return motion.carry(dt_s, x_, P_, made);
  }

  /// Cov(x, f(x)) across a nonlinear motion (n x n), through the points: what a smoother looks back by.
  template <NonlinearMotionModel Motion>
  Covariance cross_covariance(const Motion& motion, Scalar dt_s) const {
    const Covariance L = semidefinite_root<N, Scalar>(P_);
    const PointStates X = points(L);
    Covariance cross = Covariance::Zero();
    for (std::size_t i = 0; i < N; ++i) {
      const State across = motion.f(X[i], dt_s) - motion.f(X[N + i], dt_s);
      cross += kWeight * (std::sqrt(kSpread) * L.col(static_cast<Eigen::Index>(i))) * across.transpose();
    }
    return cross;
  }

  /// Takes one measurement z (m), over points drawn anew from P. `failed` leaves x and P as they were: z, R or the
  /// result not finite, R, S or P not positive (semi-)definite, or S so ill-conditioned that the result would not be
  /// worth having. Residuals of the points are taken from h(x) and averaged there, so that an angle may wrap among
  /// them.
  template <MeasurementModel Model>
  Update<N, Model::kMeasurements, Scalar> update(const Model& model,
                                                 const Eigen::Matrix<Scalar, Model::kMeasurements, 1>& z) {
    static_assert(Model::kStates == N && std::is_same_v<typename Model::Scalar, Scalar>);
    constexpr int M = Model::kMeasurements;
    using Vector = Eigen::Matrix<Scalar, M, 1>;
    Update<N, M, Scalar> update;

    const Covariance L = semidefinite_root<N, Scalar>(P_);
    const Vector z_0 = model.h(x_);
    Points<M> d;  // from the centre
    const PointStates X = points(L);
    if constexpr (requires { model.residuals_of(X[0].data(), N, kPoints, z_0, d.data()); })
      model.residuals_of(X[0].data(), N, kPoints, z_0, d.data());
    else
      detail::each<kPoints, kPoints * M>([&](int i) __attribute__((always_inline)) {
        const Vector residual = model.residual(Vector(model.h(X[static_cast<std::size_t>(i)])), z_0);
        detail::each<M, kPoints * M>([&](int row) __attribute__((always_inline)) { d(row, i) = residual(row); });
      });
    update.nu = model.residual(z, plus(z_0, mean_of<M>(d)));
    take_update<M>(L, d, model.R(), update);
    return update;
  }

  const State& x() const { return x_; }
  const Covariance& P() const { return P_; }

 private:
  static constexpr int kPoints = 2 * N;             // besides the centre
  static constexpr Scalar kSpread = N > 3 ? N : 3;  // n + kappa
  static constexpr Scalar kCentreWeight = 1 - N / kSpread;
  static constexpr Scalar kWeight = 1 / (2 * kSpread);

  /// One column a point: those on the one side, then those on the other.
  template <int Rows>
  using Points = Eigen::Matrix<Scalar, Rows, kPoints>;
  using PointStates = std::array<State, static_cast<std::size_t>(kPoints)>;

  /// X: written at once, long before the first is read.
  EIGEN_ALWAYS_INLINE PointStates points(const Covariance& L) const {
    const Scalar c = std::sqrt(kSpread);
    PointStates X;
    for (int i = 0; i < N; ++i)
      for (int row = 0; row < N; ++row) {
        X[static_cast<std::size_t>(i)](row) = x_(row) + c * L(row, i);
        X[static_cast<std::size_t>(N + i)](row) = x_(row) - c * L(row, i);
      }
    return X;
  }

  /// Of d, which are taken from the centre. Summed in pairs from both sides, which nearly cancel.
  template <int Rows>
  EIGEN_ALWAYS_INLINE static Eigen::Matrix<Scalar, Rows, 1> mean_of(const Points<Rows>& d) {
    Eigen::Matrix<Scalar, Rows, 1> mean;
    detail::each<Rows, kPoints * Rows>([&](int row) __attribute__((always_inline)) {
      Scalar sum = d(row, 0) + d(row, N);
      detail::each<N, kPoints * Rows>([&](int i) __attribute__((always_inline)) {
        if (i > 0) sum += d(row, i) + d(row, N + i);
      });
      mean(row) = kWeight * sum;
    });
    return mean;
  }

  /// A + weight a a' into A, in its lower triangle.
  template <int Rows>
  EIGEN_ALWAYS_INLINE static void add_square(Scalar weight, const Eigen::Matrix<Scalar, Rows, 1>& a,
                                             Eigen::Matrix<Scalar, Rows, Rows>& A) {
    detail::each<Rows * Rows, Rows * Rows>([&](int index) __attribute__((always_inline)) {
      const int row = index % Rows, col = index / Rows;
      if (row >= col) A(row, col) += weight * a(row) * a(col);
    });
  }

  /// The update, once the points have gone through h: `update` has nu, and gets the rest. Of each pair of points h is an
  /// odd and an even part: half the difference of the two d, over c, is a column of what is H L where h is linear; half
  /// their sum, from the mean, adds to R as a noise would. So S = H L (H L)' + noise, and as much for K and P.
  template <int M>
  EIGEN_ALWAYS_INLINE void take_update(const Covariance& L, const Points<M>& d, const Eigen::Matrix<Scalar, M, M>& R,
                                       Update<N, M, Scalar>& update) {
    const Eigen::Matrix<Scalar, M, 1> mean = mean_of<M>(d);
    Eigen::Matrix<Scalar, M, N> HL;
    Eigen::Matrix<Scalar, M, M> noise;
    copy(R, noise);
    if constexpr (kCentreWeight > 0) add_square<M>(kCentreWeight, mean, noise);
    detail::each<N, kPoints * M>([&](int i) __attribute__((always_inline)) {
      Eigen::Matrix<Scalar, M, 1> even;
      detail::each<M, kPoints * M>([&](int row) __attribute__((always_inline)) {
        HL(row, i) = (d(row, i) - d(row, N + i)) * (1 / (2 * std::sqrt(kSpread)));
        even(row) = Scalar(0.5) * (d(row, i) + d(row, N + i)) - mean(row);
      });
      add_square<M>(2 * kWeight, even, noise);
    });
    detail::mirror_lower<M, Scalar>(noise);
    copy(noise, update.S);
    add_product_transposed<1, Part::lower>(HL, HL, update.S);
    detail::mirror_lower<M, Scalar>(update.S);

    constexpr Scalar kLeastPivot = std::numeric_limits<Scalar>::epsilon() / Scalar(2 * detail::kTrustedError);
    Eigen::Matrix<Scalar, M, 1> least;
    for (int i = 0; i < M; ++i) least(i) = kLeastPivot * update.S(i, i) + std::numeric_limits<Scalar>::min();
    const Ldlt<M, Scalar> factors(update.S, least);
    const Eigen::Matrix<Scalar, N, M> PHt = product(L, transposed(HL));
    Eigen::Matrix<Scalar, N, M> K;  // in registers, which update.K is not
    detail::each<N, N * M>([&](int row) __attribute__((always_inline)) {
      Eigen::Matrix<Scalar, M, 1> k;
      detail::each<M, N * M>([&](int i) __attribute__((always_inline)) { k(i) = PHt(row, i); });
      k = factors.solve(k);
      detail::each<M, N * M>([&](int i) __attribute__((always_inline)) { update.K(row, i) = K(row, i) = k(i); });
    });
    update.nis = dot(update.nu, factors.solve(update.nu));

    // P - K S K' as the sum of squares that it is, as Joseph's form: (I - K H) L times its transpose, + K noise K'.
    Covariance P = product(product(K, noise), transposed(K)), left = L;
    add_product<-1>(K, HL, left);
    add_product_transposed<1, Part::lower>(left, left, P);
    detail::mirror_lower<N, Scalar>(P);

    const bool valid = factors.valid & is_positive_semidefinite<M, Scalar>(R) & is_positive_semidefinite<N, Scalar>(P);
    update.status = commit(valid, plus(x_, product(K, update.nu)), P, x_, P_);
  }

  State x_;
  Covariance P_;
};

}  // namespace truebearing
