// The unscented Kalman filter: state x (n), covariance P (n x n), the same interface as KalmanFilter, no Jacobians.
// Mean and covariance of f and h are those over 2 n + 1 points x, x +- c L_i, where P = L L' and c^2 = n + kappa:
//     predict  x = sum w f,  P = sum w (f - x)(f - x)' + Q
//     update   S = sum w d d' + R,  K = (sum w (X - x) d') S^-1,  d = residual of h from its mean
// Julier and Uhlmann 2004, with alpha = 1 and beta = 0. kappa = 3 - n matches the fourth moment of a normal x; from n =
// 4 on it is 0, so that no weight is negative and every sum of squares is a covariance.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <type_traits>

#include "truebearing/core/status.hpp"
#include "truebearing/filter/covariance_form.hpp"
#include "truebearing/filter/factorization.hpp"
#include "truebearing/filter/product.hpp"
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
    const Covariance spread = deviations();
    const State centre = motion.f(x_, dt_s);
    Points<N> d;  // from the centre first, then from the mean
    d.col(0).setZero();
    for (int i = 0; i < N; ++i) {
      d.col(1 + i) = motion.f(State(x_ + spread.col(i)), dt_s) - centre;
      d.col(1 + N + i) = motion.f(State(x_ - spread.col(i)), dt_s) - centre;
    }
    const State shift = kWeight * d.rowwise().sum();
    d.colwise() -= shift;
    Covariance P = motion.Q(dt_s);
    add_squares<N>(d, P);
    detail::mirror_lower<N, Scalar>(P);
    return commit(is_positive_semidefinite<N, Scalar>(P), State(centre + shift), P, x_, P_);
  }

  /// The same across a motion whose type is not known here.
  StepStatus predict(const SizedMotion<N>& motion, double dt_s) requires std::is_same_v<Scalar, double> {
    if (!motion.is_linear()) return predict<SizedMotion<N>>(motion, dt_s);
    return motion.carry(dt_s, x_, P_);
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
    using Noise = Eigen::Matrix<Scalar, M, M>;
    Update<N, M, Scalar> update;

    const Covariance spread = deviations();
    const Vector z_0 = model.h(x_);
    Points<M> d;
    d.col(0).setZero();
    for (int i = 0; i < N; ++i) {
      d.col(1 + i) = model.residual(model.h(State(x_ + spread.col(i))), z_0);
      d.col(1 + N + i) = model.residual(model.h(State(x_ - spread.col(i))), z_0);
    }
    const Vector shift = kWeight * d.rowwise().sum();
    d.colwise() -= shift;
    update.nu = model.residual(z, Vector(z_0 + shift));

    const Noise R = model.R();
    update.S = R;
    add_squares<M>(d, update.S);
    detail::mirror_lower<M, Scalar>(update.S);
    Eigen::Matrix<Scalar, N, M> cross = Eigen::Matrix<Scalar, N, M>::Zero();
    for (int i = 0; i < N; ++i)
      cross.noalias() += (kWeight * spread.col(i)) * (d.col(1 + i) - d.col(1 + N + i)).transpose();

    constexpr Scalar kLeastPivot = std::numeric_limits<Scalar>::epsilon() / Scalar(2 * detail::kTrustedError);
    const Vector least = (kLeastPivot * update.S.diagonal()).array() + std::numeric_limits<Scalar>::min();
    const Ldlt<M, Scalar> factors(update.S, least);
    for (int i = 0; i < N; ++i) update.K.row(i) = factors.solve(cross.row(i).transpose()).transpose();
    update.nis = update.nu.dot(factors.solve(update.nu));

    // P - K S K' as the sum of squares that it is, over the points' errors after the update, as Joseph's form does:
    // sum w (X - x - K d)(X - x - K d)' + K R K'.
    Points<N> left;
    left.col(0).setZero();
    left.template middleCols<N>(1) = spread;
    left.template rightCols<N>() = -spread;
    for (int i = 0; i < kPoints; ++i) left.col(i).noalias() -= update.K * d.col(i);
    const Eigen::Matrix<Scalar, N, M> KR = product(update.K, R);
    Covariance P = product(KR, transposed(update.K));
    add_squares<N>(left, P);
    detail::mirror_lower<N, Scalar>(P);

    const bool valid = factors.valid & is_positive_semidefinite<M, Scalar>(R) & is_positive_semidefinite<N, Scalar>(P);
    update.status = commit(valid, State(x_ + update.K * update.nu), P, x_, P_);
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

  Covariance deviations() const { return std::sqrt(kSpread) * semidefinite_root<N, Scalar>(P_); }

  /// A + sum w d d' into A.
  template <int Rows>
  static void add_squares(const Points<Rows>& d, Eigen::Matrix<Scalar, Rows, Rows>& A) {
    for (int i = 0; i < kPoints; ++i) {
      const Scalar weight = i == 0 ? kCentreWeight : kWeight;
      for (int col = 0; col < Rows; ++col)
        for (int row = 0; row < Rows; ++row) A(row, col) += weight * d(row, i) * d(col, i);
    }
  }

  State x_;
  Covariance P_;
};

}  // namespace truebearing
