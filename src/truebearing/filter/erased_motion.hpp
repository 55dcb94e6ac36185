// SPDX-License-Identifier: Apache-2.0
// A motion model of a known type behind the run-time interface. Its structure stays known to the compiler here: the
// zeros of its F and Q cost nothing (product.hpp), whatever filter uses it.
#pragma once

#include <memory>
#include <string_view>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/filter/covariance_form.hpp"
#include "truebearing/filter/product.hpp"
#include "truebearing/motion/any_motion.hpp"
#include "truebearing/motion/motion_model.hpp"

namespace truebearing {

template <MotionModel Model>
class ErasedMotion final : public SizedMotion<Model::kStates> {
  static constexpr int N = Model::kStates;

 public:
  using typename SizedMotion<N>::State;
  using typename SizedMotion<N>::Matrix;

  explicit ErasedMotion(Model model, std::string_view rest = {})
      : SizedMotion<N>(LinearMotionModel<Model>, rest), model_(std::move(model)) {}

  State f(const State& x, double dt_s) const override {
    if constexpr (LinearMotionModel<Model>)
      return product(Matrix(model_.F(dt_s)), x);
    else
      return model_.f(x, dt_s);
  }
  Matrix F(const State& x, double dt_s) const override { return jacobian(x, dt_s); }
  Matrix Q(double dt_s) const override { return model_.Q(dt_s); }

  StepStatus carry(double dt_s, State& x, Matrix& P, Transition<N>& made) const override {
    if (made.dt_s != dt_s) make(dt_s, made);
    const Matrix structure = jacobian(x, dt_s);  // of a linear model for its zeros alone
    Matrix F;
    detail::each<N * N, N * N>([&](int i) __attribute__((always_inline)) {
      if constexpr (LinearMotionModel<Model>)
        F.data()[i] = detail::is_known_zero(structure.data()[i]) ? 0.0 : made.F.data()[i];
      else
        F.data()[i] = structure.data()[i];
    });
    State new_x;
    if constexpr (LinearMotionModel<Model>)
      new_x = product(F, x);
    else
      new_x = model_.f(x, dt_s);
    Matrix new_P = P;
    const bool valid = detail::CovarianceForm::predict<N, double>(F, made.Q, new_P);
    return commit(valid, new_x, new_P, x, P);
  }

 private:
  // Of no dt until it has both: a model that throws leaves nothing that would be taken for made.
  [[gnu::noinline]] void make(double dt_s, Transition<N>& made) const {
    made.dt_s = kNaN;
    if constexpr (LinearMotionModel<Model>) made.F = model_.F(dt_s);
    made.Q = model_.Q(dt_s);
    made.dt_s = dt_s;
  }

  EIGEN_ALWAYS_INLINE Matrix jacobian(const State& x, double dt_s) const {
    if constexpr (LinearMotionModel<Model>)
      return model_.F(dt_s);
    else
      return model_.F(x, dt_s);
  }

  Model model_;
};

/// `model` behind the run-time interface; rest: AnyMotion::rest().
template <MotionModel Model>
std::shared_ptr<const SizedMotion<Model::kStates>> erased(Model model, std::string_view rest = {}) {
  return std::make_shared<const ErasedMotion<Model>>(std::move(model), rest);
}

}  // namespace truebearing
