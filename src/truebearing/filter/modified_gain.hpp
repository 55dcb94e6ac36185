// SPDX-License-Identifier: Apache-2.0
// The modified-gain extended Kalman filter (Song and Speyer 1985) for measurements that are linear once the measured
// value is known: h(x) - h(x_pred) = g(z, x_pred) (x - x_pred) exactly where z = h(x). State x (n), covariance P (n x
// n), g (m x n).
//     gain    K = P H' S^-1,  S = H P H' + R,  H at the prediction, as in the extended filter
//     update  x = x + K nu,  P = (I - K g) P (I - K g)' + K R K'
// The gain must not look at z, or it would be correlated with the noise that it weighs; P may.
#pragma once

#include <Eigen/Core>
#include <concepts>

#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/product.hpp"
#include "truebearing/filter/small_matrix.hpp"

namespace truebearing {

/// A measurement model that gives g(z, x) (m x n).
template <typename Model>
concept ModifiedGainModel = MeasurementModel<Model> &&
    requires(const Model& model, const Eigen::Matrix<typename Model::Scalar, Model::kStates, 1>& x,
             const Eigen::Matrix<typename Model::Scalar, Model::kMeasurements, 1>& z) {
  {
    model.modified_gain(z, x)
    } -> std::convertible_to<Eigen::Matrix<typename Model::Scalar, Model::kMeasurements, Model::kStates>>;
};

/// A small value: no heap, no virtual call. The interface of KalmanFilter.
template <int N, typename ScalarType = double>
class ModifiedGainFilter {
 public:
  using Scalar = ScalarType;
  static constexpr int kStates = N;
  using State = Eigen::Matrix<Scalar, N, 1>;
  using Covariance = Eigen::Matrix<Scalar, N, N>;

  /// As KalmanFilter's: where P0 is not positive semi-definite P() is NaN and every step says `failed`.
  ModifiedGainFilter(const State& x0, const Covariance& P0) : filter_(x0, P0) {}

  template <MotionModel Motion, typename... Made>
  StepStatus predict(const Motion& motion, Scalar dt_s, Made&... made) {
    return filter_.predict(motion, dt_s, made...);
  }

  /// Takes one measurement z (m). `failed`, which leaves x and P as they were, as in KalmanFilter.
  template <ModifiedGainModel Model>
  Update<N, Model::kMeasurements, Scalar> update(const Model& model,
                                                 const Eigen::Matrix<Scalar, Model::kMeasurements, 1>& z) {
    static_assert(Model::kStates == N && std::is_same_v<typename Model::Scalar, Scalar>);
    constexpr int M = Model::kMeasurements;
    const State x_pred = filter_.x();
    Covariance P = filter_.P();
    const Eigen::Matrix<Scalar, M, M> R = model.R();
    Update<N, M, Scalar> update;
    update.nu = model.residual(z, model.h(x_pred));
    Eigen::Matrix<Scalar, N, M> Pgt;
    const bool valid =
        detail::CovarianceForm::gain<N, M, Scalar>(P, detail::jacobian_of(model, x_pred), R, Pgt, update);

    // One factor at a time: A = (I - K g) P, then A - (A g' - K R) K'.
    const Eigen::Matrix<Scalar, M, N> g = model.modified_gain(z, x_pred);
    Pgt = product(P, transposed(g));
    add_product<-1>(update.K, transposed(Pgt), P);
    Pgt = product(P, transposed(g));
    add_product<-1>(update.K, R, Pgt);
    add_product<-1, Part::lower>(Pgt, transposed(update.K), P);

    const State x = plus(x_pred, product(update.K, update.nu));
    const KalmanFilter<N, Joseph, Scalar> updated(x, P);
    const bool finite = is_finite(x) && is_finite(updated.P());
    update.status = valid && finite ? StepStatus::ok : StepStatus::failed;
    if (update.status == StepStatus::ok) filter_ = updated;
    return update;
  }

  const State& x() const { return filter_.x(); }
  const Covariance& P() const { return filter_.P(); }

 private:
  KalmanFilter<N, Joseph, Scalar> filter_;
};

}  // namespace truebearing
