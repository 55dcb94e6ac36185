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
  StepStatus predict(const Motion& motion, Scalar dt_s) {
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
    const Points<N> offsets = offsets_of_points();
    const State centre = motion.f(x_, dt_s);
    Points<N> d;  // from the centre first, then from the mean
    fill(d, Scalar(0));
    const PointStates X = points(offsets);
    for (int i = 1; i < kPoints; ++i)
      put(minus(State(motion.f(X[static_cast<std::size_t>(i)], dt_s)), centre), d, 0, i);
    const State shift = take_mean<N>(d);
    Covariance P = motion.Q(dt_s);
    add_squares<N>(d, P);
    detail::mirror_lower<N, Scalar>(P);
    return commit(is_positive_semidefinite<N, Scalar>(P), plus(centre, shift), P, x_, P_);
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
    const Points<N> offsets = offsets_of_points();
    const PointStates X = points(offsets);
    Covariance cross = Covariance::Zero();
    for (std::size_t i = 1; i <= N; ++i) {
      const State across = motion.f(X[i], dt_s) - motion.f(X[N + i], dt_s);
      cross += kWeight * offsets.col(static_cast<Eigen::Index>(i)) * across.transpose();
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

    const Points<N> offsets = offsets_of_points();
    const Vector z_0 = model.h(x_);
    Points<M> d;
    fill(d, Scalar(0));
    const PointStates X = points(offsets);
    if constexpr (requires { model.residuals_of(X[1].data(), N, kPoints - 1, z_0, d.data()); })
      model.residuals_of(X[1].data(), N, kPoints - 1, z_0, d.data() + M);
    else
      for (int i = 1; i < kPoints; ++i)
        put(Vector(model.residual(Vector(model.h(X[static_cast<std::size_t>(i)])), z_0)), d, 0, i);
    const Vector shift = take_mean<M>(d);
    update.nu = model.residual(z, plus(z_0, shift));
    take_update<M>(offsets, d, model.R(), update);
    return update;
  }

  const State& x() const { return x_; }
  const Covariance& P() const { return P_; }

 private:
  static constexpr int kPoints = 2 * N + 1;
  static constexpr Scalar kSpread = N > 3 ? N : 3;  // n + kappa
  static constexpr Scalar kCentreWeight = 1 - N / kSpread;
  static constexpr Scalar kWeight = 1 / (2 * kSpread);

  /// One column a point: the centre, then those on the one side, then those on the other.
  template <int Rows>
  using Points = Eigen::Matrix<Scalar, Rows, kPoints>;
  using PointStates = std::array<State, static_cast<std::size_t>(kPoints)>;

  /// X - x: of the points around the estimate.
  Points<N> offsets_of_points() const {
    const Covariance L = semidefinite_root<N, Scalar>(P_);
    const Scalar c = std::sqrt(kSpread);
    Points<N> offsets;
    for (int row = 0; row < N; ++row) {
      offsets(row, 0) = 0;
      for (int i = 0; i < N; ++i) {
        offsets(row, 1 + i) = c * L(row, i);
        offsets(row, 1 + N + i) = -offsets(row, 1 + i);
      }
    }
    return offsets;
  }

  /// X: written at once, long before the first is read.
  PointStates points(const Points<N>& offsets) const {
    PointStates X;
    for (int i = 0; i < kPoints; ++i)
      for (int row = 0; row < N; ++row) X[static_cast<std::size_t>(i)](row) = x_(row) + offsets(row, i);
    return X;
  }

  /// Of d, which are taken from the centre, the mean; they become those from the mean. Summed in pairs from both sides,
  /// which nearly cancel.
  template <int Rows>
  static Eigen::Matrix<Scalar, Rows, 1> take_mean(Points<Rows>& d) {
    Eigen::Matrix<Scalar, Rows, 1> mean;
    for (int row = 0; row < Rows; ++row) {
      Scalar sum = 0;
      for (int i = 1; i <= N; ++i) sum += d(row, i) + d(row, N + i);
      mean(row) = kWeight * sum;
    }
    for (int i = 0; i < kPoints; ++i)
      for (int row = 0; row < Rows; ++row) d(row, i) -= mean(row);
    return mean;
  }

  /// A + sum w d d' into A, in its lower triangle.
  template <int Rows>
  static void add_squares(const Points<Rows>& d, Eigen::Matrix<Scalar, Rows, Rows>& A) {
    for (int i = 0; i < kPoints; ++i) {
      const Scalar weight = i == 0 ? kCentreWeight : kWeight;
      for (int col = 0; col < Rows; ++col)
        for (int row = col; row < Rows; ++row) A(row, col) += weight * d(row, i) * d(col, i);
    }
  }

  /// The update, once the points have gone through h: `update` has nu, and gets the rest.
  template <int M>
  EIGEN_ALWAYS_INLINE void take_update(const Points<N>& offsets, const Points<M>& d,
                                       const Eigen::Matrix<Scalar, M, M>& R, Update<N, M, Scalar>& update) {
    copy(R, update.S);
    add_squares<M>(d, update.S);
    detail::mirror_lower<M, Scalar>(update.S);
    Eigen::Matrix<Scalar, N, M> cross;
    fill(cross, Scalar(0));
    for (int i = 1; i <= N; ++i)
      for (int col = 0; col < M; ++col)
        for (int row = 0; row < N; ++row) cross(row, col) += (kWeight * offsets(row, i)) * (d(col, i) - d(col, N + i));

    constexpr Scalar kLeastPivot = std::numeric_limits<Scalar>::epsilon() / Scalar(2 * detail::kTrustedError);
    Eigen::Matrix<Scalar, M, 1> least;
    for (int i = 0; i < M; ++i) least(i) = kLeastPivot * update.S(i, i) + std::numeric_limits<Scalar>::min();
    const Ldlt<M, Scalar> factors(update.S, least);
    factors.solve_rows(cross, update.K);
    update.nis = dot(update.nu, factors.solve(update.nu));

    // P - K S K' as the sum of squares that it is, over the points' errors after the update, as Joseph's form does:
    // sum w (X - x - K d)(X - x - K d)' + K R K'.
    Covariance P = product(product(update.K, R), transposed(update.K));
    Points<N> left;
    for (int i = 0; i < kPoints; ++i) put(minus(column(offsets, i), product(update.K, column(d, i))), left, 0, i);
    add_squares<N>(left, P);
    detail::mirror_lower<N, Scalar>(P);

    const bool valid = factors.valid & is_positive_semidefinite<M, Scalar>(R) & is_positive_semidefinite<N, Scalar>(P);
    update.status = commit(valid, plus(x_, product(update.K, update.nu)), P, x_, P_);
  }

  State x_;
  Covariance P_;
};

}  // namespace truebearing
