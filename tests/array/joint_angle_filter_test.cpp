// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/joint_angle_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/array/joint_angle_prior.hpp"
#include "tests/support/array_scene.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::joint_angle_filter_test {
namespace {

using testing::ArrayScene;
using testing::joint_angle_prior;
using testing::kTargets;
using testing::scene_of;

TEST(JointAnglePrediction, OfTwoTimesIsOneAfterTheOther) {
  const ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  const JointAngleMotion motion{.log_power_variance_per_s = 0.01};
  JointAngleState once = joint_angle_prior(scene), twice = once;
  const SignalVector x = once.x;
  once.q << 1e-4, 2e-4, 3e-4;
  twice.q = once.q;
  predict(once, motion, 2.5);
  predict(twice, motion, 0.7);
  predict(twice, motion, 1.8);
  EXPECT_LT((once.x - twice.x).norm(), 1e-12 * once.x.norm());
  EXPECT_LT((once.P - twice.P).norm(), 1e-12 * once.P.norm());
  for (int n = 0; n < kTargets; ++n) {
    EXPECT_NEAR(once.angle(n), x[n] + 2.5 * x[6 + n], 1e-12);
    EXPECT_EQ(once.log_power(n), x[3 + n]);
    EXPECT_EQ(once.rate(n), x[6 + n]);
  }
  EXPECT_TRUE(is_covariance(once.P));
}

TEST(JointAnglePrediction, IsThatOfConstantRates) {
  const ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  const JointAngleMotion motion{.log_power_variance_per_s = 0.01};
  JointAngleState state = joint_angle_prior(scene);
  state.q << 1e-4, 2e-4, 3e-4;
  Eigen::MatrixXd F = Eigen::MatrixXd::Identity(9, 9), Q = Eigen::MatrixXd::Zero(9, 9);
  constexpr double T = 1.5;
  for (int n = 0; n < kTargets; ++n) {
    F(n, 6 + n) = T;
    Q(n, n) = state.q[n] * T * T * T / 3.0;
    Q(n, 6 + n) = Q(6 + n, n) = state.q[n] * T * T / 2.0;
    Q(6 + n, 6 + n) = state.q[n] * T;
    Q(3 + n, 3 + n) = 0.01 * T;
  }
  const Eigen::MatrixXd expected = F * state.P * F.transpose() + Q;
  predict(state, motion, T);
  EXPECT_LT((state.P - expected).norm(), 1e-12 * expected.norm());
}

// A posterior of one target whose angle moved by `e` normalised innovations, half of its variance gone.
JointAngleState moved_by(double e, const JointAngleState& prior) {
  JointAngleState posterior = prior;
  posterior.P(0, 0) *= 0.5;
  posterior.x[0] += e * std::sqrt(prior.P(0, 0) - posterior.P(0, 0));
  return posterior;
}

TEST(JointAngleMotion, ProcessNoiseFollowsAMeanOfInnovationsBetweenItsLimits) {
  const JointAngleMotion motion{.q0 = 0.003, .q_low = 0.001, .q_high = 1.0, .alpha = 0.5};
  JointAngleState prior;
  prior.x.setZero(3);
  prior.P.setIdentity(3, 3);
  prior.q.setZero(1);
  prior.innovations.setZero(1);
  JointAngleState posterior = moved_by(2.0, prior);
  adapt(motion, prior, posterior);
  EXPECT_NEAR(posterior.innovations[0], 1.0, 1e-12);
  EXPECT_NEAR(posterior.q[0], 0.003 * 9.0, 1e-12);  // s = 1^2 (2 - .5) / .5

  // The other way next time, and the mean is what it was: no manoeuvre.
  prior.innovations = posterior.innovations;
  posterior = moved_by(-1.0, prior);
  adapt(motion, prior, posterior);
  EXPECT_NEAR(posterior.innovations[0], 0.0, 1e-12);
  EXPECT_NEAR(posterior.q[0], 0.001, 1e-12);

  prior.innovations.setConstant(1, 5.0);
  posterior = moved_by(100.0, prior);
  adapt(motion, prior, posterior);
  EXPECT_NEAR(posterior.innovations[0], 5.0, 1e-12);  // of 5 at most
  EXPECT_EQ(posterior.q[0], 1.0);
}

TEST(JointAngleMotion, ProcessNoiseHasOtherLimitsWhileTargetsAreClose) {
  const JointAngleMotion motion{
      .q0 = 0.003, .q_low = 0.001, .q_high = 1.0, .close_rad = 0.05, .close_q_low = 0.01, .close_q_high = 0.02};
  JointAngleState prior;
  prior.x.setZero(9);
  prior.x.head<3>() << 0.0, 0.04, 0.2;
  prior.P.setIdentity(9, 9);
  prior.q.setZero(3);
  prior.innovations.setConstant(3, 5.0);
  JointAngleState posterior = prior;
  posterior.P *= 0.5;
  adapt(motion, prior, posterior);
  EXPECT_EQ(posterior.q[0], 0.02);
  EXPECT_EQ(posterior.q[1], 0.02);
  EXPECT_GT(posterior.q[2], 0.02);
}

TEST(JointAngleState, AddedTargetLeavesTheOthersAlone) {
  const ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  const JointAngleState before = joint_angle_prior(scene);
  JointAngleState state = before;
  add_target(state, {.angle_rad = 0.7,
                     .angle_sigma_rad = 0.01,
                     .log_power = 2.0,
                     .log_power_sigma = 0.5,
                     .rate_sigma_radps = 0.03,
                     .q = 7e-5});
  ASSERT_EQ(state.targets(), 4);
  EXPECT_EQ(state.angle(3), 0.7);
  EXPECT_EQ(state.log_power(3), 2.0);
  EXPECT_EQ(state.rate(3), 0.0);
  EXPECT_EQ(state.q[3], 7e-5);
  EXPECT_DOUBLE_EQ(state.P(3, 3), 1e-4);
  EXPECT_DOUBLE_EQ(state.P(7, 7), 0.25);
  EXPECT_DOUBLE_EQ(state.P(11, 11), 9e-4);
  for (const int i : {3, 7, 11})
    for (int j = 0; j < 12; ++j)
      if (j != i) {
        EXPECT_EQ(state.P(i, j), 0.0);
      }
  EXPECT_TRUE(is_covariance(state.P));
  remove_target(state, 3);
  EXPECT_EQ(state.x, before.x);
  EXPECT_EQ(state.P, before.P);
  EXPECT_EQ(state.q, before.q);
}

TEST(JointAngleState, RemovedTargetLeavesTheMarginalOfTheOthers) {
  const ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  JointAngleState before = joint_angle_prior(scene);
  before.q << 1.0, 2.0, 3.0;
  JointAngleState state = before;
  remove_target(state, 1);
  const std::vector<int> kept{0, 2, 3, 5, 6, 8};
  EXPECT_EQ(state.x, SignalVector(before.x(kept)));
  EXPECT_EQ(state.P, SignalMatrix(before.P(kept, kept)));
  EXPECT_EQ(state.q, Eigen::Vector2d(1.0, 3.0));
  remove_target(state, 0);
  remove_target(state, 0);
  EXPECT_EQ(state.targets(), 0);
}

TEST(JointAngleState, SortedTargetsTakeTheirCorrelationsWithThem) {
  const ArrayScene scene = scene_of({25.0, -35.0, 4.0});
  JointAngleState before = joint_angle_prior(scene);
  before.q << 1.0, 2.0, 3.0;
  JointAngleState state = before;
  sort_targets(state);
  const std::vector<int> order{1, 2, 0, 4, 5, 3, 7, 8, 6};
  EXPECT_EQ(state.x, SignalVector(before.x(order)));
  EXPECT_EQ(state.P, SignalMatrix(before.P(order, order)));
  EXPECT_EQ(state.q, Eigen::Vector3d(2.0, 3.0, 1.0));
  std::array<int, kMaxSignals> places{};
  order_of_angles(before, places);
  EXPECT_EQ(std::vector<int>(places.begin(), places.begin() + 3), (std::vector<int>{1, 2, 0}));
}

// A Kalman update of one angle by itself is given back.
TEST(EquivalentInnovation, IsTheMeasurementThatWouldHaveDoneIt) {
  const ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  const JointAngleState before = joint_angle_prior(scene);
  constexpr double kNu = 0.013, kR = 3e-4;
  const double S = before.P(1, 1) + kR;
  JointAngleState after = before;
  const SignalVector K = before.P.col(1) / S;
  after.x += K * kNu;
  after.P -= K * S * K.transpose();
  const EquivalentInnovation innovation = equivalent_innovation(before, after, 1);
  EXPECT_NEAR(innovation.nu_rad, kNu, 1e-12);
  EXPECT_NEAR(innovation.S_rad2, S, 1e-12 * S);
  EXPECT_NEAR(innovation.gain, before.P(1, 1) / S, 1e-12);
  EXPECT_NEAR(innovation.nis(), kNu * kNu / S, 1e-12);
  // P+ = P - gain P of any update.
  EXPECT_NEAR(after.P(1, 1), (1.0 - innovation.gain) * before.P(1, 1), 1e-15);
}

TEST(EquivalentInnovation, OfNoUpdateIsFinite) {
  const ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  const JointAngleState state = joint_angle_prior(scene);
  const EquivalentInnovation innovation = equivalent_innovation(state, state, 0);
  EXPECT_EQ(innovation.gain, kLeastGain);
  EXPECT_EQ(innovation.nu_rad, 0.0);
  EXPECT_GT(innovation.S_rad2, 0.0);
  EXPECT_EQ(innovation.nis(), 0.0);
}

}  // namespace
}  // namespace truebearing::joint_angle_filter_test
