// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/erased_motion.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "truebearing/filter/kalman.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/coordinated_turn.hpp"
#include "truebearing/motion/turning_target.hpp"

namespace truebearing::erased_motion_test {
namespace {

using Turn = CoordinatedTurn<DiscreteWhiteNoise>;
using Straight = ConstantVelocity<1, DiscreteWhiteNoise>;
using Turning = TurningTarget<DiscreteWhiteNoise>;

template <int N>
Eigen::Matrix<double, N, N> some_covariance() {
  Eigen::Matrix<double, N, N> A;
  for (Eigen::Index i = 0; i < A.size(); ++i) A(i) = std::sin(12.9898 * static_cast<double>(i + 1));
  return A * A.transpose() + Eigen::Matrix<double, N, N>::Identity();
}

TEST(ErasedMotion, IsTheModelThatItHolds) {
  const Turn turn{{2.0}, 0.1};
  const auto motion = erased(turn, "nothing");
  const Eigen::Vector4d x(1.0, 2.0, 3.0, 4.0);
  EXPECT_TRUE(motion->is_linear());
  EXPECT_EQ(motion->states(), 4);
  EXPECT_EQ(motion->rest(), "nothing");
  EXPECT_EQ(motion->F(x, 0.5), turn.F(0.5));
  EXPECT_EQ(motion->Q(0.5), turn.Q(0.5));
  EXPECT_EQ(motion->f(x, 0.5), product(turn.F(0.5), x));
}

// A filter under the model and one under the interface do the same, to the bit, whatever the interval before was.
template <typename Form, typename Motion>
void expect_same_prediction(const Motion& model) {
  constexpr int N = Motion::kStates;
  using Filter = KalmanFilter<N, Form>;
  typename Filter::State x;
  for (int i = 0; i < N; ++i) x(i) = 0.1 * (i + 1);
  Filter direct(x, some_covariance<N>()), through(x, some_covariance<N>());
  const std::shared_ptr<const SizedMotion<N>> motion = erased(model);
  Filter remembering = through;
  Transition<N> made;
  for (const double dt_s : {0.7, 0.7, 1.3, 0.7, 0.0, 0.7}) {
    ASSERT_EQ(direct.predict(model, dt_s), StepStatus::ok);
    ASSERT_EQ(through.predict(*motion, dt_s), StepStatus::ok);
    ASSERT_EQ(remembering.predict(*motion, dt_s, made), StepStatus::ok);
    EXPECT_EQ(through.x(), direct.x());
    EXPECT_EQ(through.P(), direct.P());
    EXPECT_EQ(remembering.x(), direct.x());
    EXPECT_EQ(remembering.P(), direct.P());
  }
}

TEST(ErasedMotion, PredictsAsTheModelDoes) {
  expect_same_prediction<Joseph>(Turn{{2.0}, 0.1});
  expect_same_prediction<Joseph>(Turning{{2.0}, 0.01});
  expect_same_prediction<SquareRoot>(Turn{{2.0}, 0.1});
  expect_same_prediction<SquareRoot>(Turning{{2.0}, 0.01});
}

TEST(ErasedMotion, OfNoCovarianceFailsAndLeavesTheEstimate) {
  const auto motion = erased(Turn{{2.0}, 0.1});
  const Eigen::Vector4d x(1.0, 2.0, 3.0, 4.0);
  KalmanFilter<4> filter(x, Eigen::Matrix4d::Identity());
  Transition<4> made;
  for (int twice = 0; twice < 2; ++twice) {
    EXPECT_EQ(filter.predict(*motion, std::nan(""), made), StepStatus::failed);
    EXPECT_EQ(filter.x(), x);
  }
  EXPECT_EQ(filter.predict(*motion, 1.0, made), StepStatus::ok);
}

// A model that knows nothing of more than a second, of which F can be had and Q cannot.
struct ShortMotion : Straight {
  Matrix Q(double dt_s) const {
    if (dt_s > 1.0) throw std::domain_error("too long");
    return Straight::Q(dt_s);
  }
};

TEST(ErasedMotion, BelievesNothingThatWasNotMade) {
  const ShortMotion model{{{2.0}}};
  const std::shared_ptr<const SizedMotion<2>> motion = erased(model);
  const Eigen::Vector2d x(1.0, 2.0);
  const Eigen::Matrix2d P = some_covariance<2>();
  KalmanFilter<2> expected(x, P), filter(x, P);
  ASSERT_EQ(expected.predict(model, 0.5), StepStatus::ok);
  Transition<2> made;
  for (int twice = 0; twice < 2; ++twice) {
    KalmanFilter<2> carried = filter;
    ASSERT_EQ(carried.predict(*motion, 0.5, made), StepStatus::ok);
    EXPECT_EQ(carried.x(), expected.x());
    EXPECT_EQ(carried.P(), expected.P());
    EXPECT_THROW(filter.predict(*motion, 2.0, made), std::domain_error);
    EXPECT_THROW(filter.predict(*motion, 2.0, made), std::domain_error);
    EXPECT_EQ(filter.x(), x);
    EXPECT_EQ(filter.P(), P);
  }
}

}  // namespace
}  // namespace truebearing::erased_motion_test
