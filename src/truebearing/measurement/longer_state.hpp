// SPDX-License-Identifier: Apache-2.0
// A measurement model on a state of N components whose first ones are the model's own: accelerations or a turn rate
// behind positions and velocities. h(x) = model.h(head of x), H = [H of the model, 0] (m x N); R and residual are the
// model's.
#pragma once

#include <Eigen/Core>
#include <utility>

#include "truebearing/measurement/measurement_model.hpp"

namespace truebearing {

template <MeasurementModel Model, int N>
requires(N > Model::kStates) struct OnLongerState {
  using Scalar = typename Model::Scalar;
  static constexpr int kStates = N;
  static constexpr int kMeasurements = Model::kMeasurements;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;

  Model model;

  Vector h(const State& x) const { return model.h(x.template head<Model::kStates>()); }

  Jacobian H(const State& x) const {
    Jacobian jacobian = Jacobian::Zero();
    jacobian.template leftCols<Model::kStates>() = model.H(x.template head<Model::kStates>());
    return jacobian;
  }

  /// g(z, x) of a model that gives one (modified_gain.hpp).
  Jacobian modified_gain(const Vector& z, const State& x) const requires
      requires(const Model& m, const Eigen::Matrix<Scalar, Model::kStates, 1>& head) {
    m.modified_gain(z, head);
  }
  {
    Jacobian g = Jacobian::Zero();
    g.template leftCols<Model::kStates>() = model.modified_gain(z, x.template head<Model::kStates>());
    return g;
  }

  Covariance R() const { return model.R(); }
  Vector residual(const Vector& z, const Vector& z_pred) const { return model.residual(z, z_pred); }
};

/// The model on a state of N components: the model itself where that is its own size.
template <int N, MeasurementModel Model>
auto on_state(const Model& model) {
  if constexpr (N == Model::kStates)
    return model;
  else
    return OnLongerState<Model, N>{model};
}

/// The type of on_state<N>(model).
template <typename Model, int N>
using OnState = decltype(on_state<N>(std::declval<const Model&>()));

}  // namespace truebearing
