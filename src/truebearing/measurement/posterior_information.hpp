// SPDX-License-Identifier: Apache-2.0
// The Fisher information about the state x_k (n) of a target that moves linearly, x' = F x + w, w ~ N(0, Q), carried
// along with it:
//     J' = (F J^-1 F' + Q)^-1 = (I + M Q)^-1 M,  M = F^-T J F^-1
//     J <- J + H' R^-1 H
// which is the recursion of Tichavsky, Muravchik and Nehorai 1998, equation (21), written so that neither J nor Q need
// have an inverse: without a prior J begins at zero, and without process noise it is the information of Cramer and Rao.
// With States Eigen::Dynamic, parameters that measurements turn out to depend on can join the state as they are met.
// Compiled for States 2, 4 and Eigen::Dynamic (posterior_information.cpp).
#pragma once

#include <Eigen/Core>
#include <optional>

#include "truebearing/measurement/fisher_information.hpp"

namespace truebearing {

template <int States>
class PosteriorInformation {
 public:
  using Matrix = Eigen::Matrix<double, States, States>;
  using State = Eigen::Matrix<double, States, 1>;

  PosteriorInformation() requires(States != Eigen::Dynamic) : J_(Matrix::Zero()) {}
  explicit PosteriorInformation(Eigen::Index states) requires(States == Eigen::Dynamic)
      : J_(Matrix::Zero(states, states)) {}

  /// Adds what is believed beforehand: a Gaussian of covariance P, positive definite.
  void add_prior(const Matrix& P);

  /// Adds information about the state that comes from elsewhere.
  void add(const Matrix& J) { J_ += J; }

  /// Adds a last component to the state, of which nothing is known yet.
  void add_parameter() requires(States == Eigen::Dynamic) {
    const Eigen::Index n = J_.rows();
    J_.conservativeResizeLike(Matrix::Zero(n + 1, n + 1));
  }

  void predict(const Matrix& F, const Matrix& Q);

  /// One measurement of the true state x.
  template <MeasurementModel Model>
  void update(const Model& model, const State& x) {
    J_ += fisher_information(model, x, identity().eval());
  }
  /// One of a true state x that depends on the one carried along by Phi (states of the model x n).
  template <MeasurementModel Model>
  void update(const Model& model, const Eigen::Matrix<double, Model::kStates, 1>& x,
              const Eigen::Matrix<double, Model::kStates, States>& Phi) {
    J_ += fisher_information(model, x, Phi);
  }

  const Matrix& J() const { return J_; }

  /// The bound J^-1, or nothing where the measurements do not determine the state: where J, scaled to ones on its
  /// diagonal, is singular but for rounding.
  std::optional<Matrix> covariance() const;

 private:
  auto identity() const { return Matrix::Identity(J_.rows(), J_.rows()); }

  Matrix J_;
};

}  // namespace truebearing
