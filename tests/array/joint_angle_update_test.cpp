// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "tests/array/joint_angle_prior.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::joint_angle_update_test {
namespace {

using testing::ArrayScene;
using testing::joint_angle_prior;
using testing::kTargets;
using testing::scene_of;

RealInterval interval(const ArrayScene& scene, std::uint64_t run = 0, int blocks = 1) {
  RandomStream random({12, Role::evaluation, run}, StreamId::test);
  RealInterval taken;
  taken.take(scene.draw_interval(random), blocks);
  return taken;
}

JointAngleUpdate::Options converged() {
  JointAngleUpdate::Options options;
  options.iterations = 100;
  return options;
}

// In information form, which the update avoids: with J at the mode, P+ = (P^-1 + J)^-1 over all states, rates included,
// and x+ the prior moved along its own correlations to the mode.
TEST(JointAngleUpdate, PosteriorIsPriorAndFisherInformationTogether) {
  const ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  const int n = 2 * kTargets;
  JointAngleUpdate update;
  for (std::uint64_t run = 0; run < 5; ++run) {
    const JointAngleState before = joint_angle_prior(scene, run);
    const RealInterval heard = interval(scene, run);
    JointAngleState after;
    ASSERT_TRUE(update.run(before, heard, 0.0, before.x.head(n), converged(), after));
    const SignalVector mode = after.x.head(n);
    AngleLikelihood likelihood;
    ASSERT_TRUE(likelihood.evaluate(heard, mode, nullptr, 0.0, 1.0));
    const Eigen::MatrixXd P = before.P, P_mm = P.topLeftCorner(n, n), J = likelihood.information();
    Eigen::MatrixXd information = P.inverse();
    information.topLeftCorner(n, n) += J;
    const Eigen::MatrixXd expected = information.inverse();
    for (int i = 0; i < 3 * kTargets; ++i)
      for (int j = 0; j < 3 * kTargets; ++j)
        EXPECT_NEAR(after.P(i, j), expected(i, j), 1e-8 * std::sqrt(expected(i, i) * expected(j, j))) << i << " " << j;
    const Eigen::VectorXd moved = P.leftCols(n) * P_mm.inverse() * (mode - before.x.head(n));
    for (int i = 0; i < 3 * kTargets; ++i)
      EXPECT_NEAR(after.x[i], before.x[i] + moved[i], 1e-8 * std::sqrt(P(i, i))) << i;
    // It is the mode: a hundredth of the posterior's deviation from where prior and likelihood balance, as promised.
    const Eigen::VectorXd balance = likelihood.gradient() - P_mm.inverse() * Eigen::VectorXd(mode - before.x.head(n));
    const Eigen::VectorXd to_go = (J + P_mm.inverse()).inverse() * balance;
    for (int i = 0; i < n; ++i) EXPECT_LT(std::abs(to_go[i]), 0.011 * std::sqrt(P(i, i))) << i;
    EXPECT_TRUE(is_covariance(after.P));
    EXPECT_EQ(after.q, before.q);
  }
}

// One scoring step of a small prior, within which the likelihood is a parabola: the Kalman update with a measurement of
// the maximum, of covariance J^-1.
TEST(JointAngleUpdate, OfASmallPriorIsTheKalmanUpdate) {
  const ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  const int n = 2 * kTargets;
  JointAngleState before = joint_angle_prior(scene, 0, 1e-5);
  for (int i = kTargets; i < 2 * kTargets; ++i) {
    before.P.row(i) *= 1e-3;
    before.P.col(i) *= 1e-3;
  }
  const RealInterval heard = interval(scene);
  AngleLikelihood likelihood;
  ASSERT_TRUE(likelihood.evaluate(heard, before.x.head(n), nullptr, 0.0, 1.0));
  const Eigen::MatrixXd J = likelihood.information(), R = J.inverse(), P = before.P;
  const Eigen::VectorXd nu = R * likelihood.gradient();
  const Eigen::MatrixXd K = P.leftCols(n) * (P.topLeftCorner(n, n) + R).inverse();
  const Eigen::VectorXd x = before.x + K * nu;
  const Eigen::MatrixXd P_after = P - K * P.topRows(n);
  JointAngleUpdate update;
  JointAngleState after;
  ASSERT_TRUE(update.run(before, heard, 0.0, before.x.head(n), converged(), after));
  for (int i = 0; i < 3 * kTargets; ++i) {
    EXPECT_NEAR(after.x[i], x[i], 0.01 * std::sqrt(P(i, i))) << i;
    EXPECT_NEAR(after.P(i, i), P_after(i, i), 1e-3 * P(i, i)) << i;
  }
  EXPECT_GT((after.x - before.x).norm(), 0.0);
}

TEST(JointAngleUpdate, WithNothingToHearKeepsThePrior) {
  ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  const JointAngleState before = joint_angle_prior(scene);
  scene.snapshots = 0;
  RealInterval nothing;
  nothing.take(scene.interval({}), 1);
  JointAngleUpdate update;
  JointAngleState after;
  if (!update.run(before, nothing, 0.0, before.x.head(6), converged(), after)) return;  // it may refuse
  EXPECT_LT((after.x - before.x).norm(), 1e-12);
  EXPECT_LT((after.P - before.P).norm(), 1e-12 * before.P.norm());
}

TEST(JointAngleUpdate, OrderOfTargetsChangesNothing) {
  const ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  JointAngleState before = joint_angle_prior(scene);
  sort_targets(before);
  const std::vector<int> order{2, 0, 1, 5, 3, 4, 8, 6, 7};
  JointAngleState turned = before;
  turned.x = SignalVector(before.x(order));
  turned.P = SignalMatrix(before.P(order, order));
  JointAngleUpdate update;
  JointAngleState after, after_turned;
  const RealInterval heard = interval(scene);
  ASSERT_TRUE(update.run(before, heard, 0.0, before.x.head(6), {}, after));
  const double evidence = update.log_evidence();
  ASSERT_TRUE(update.run(turned, heard, 0.0, turned.x.head(6), {}, after_turned));
  EXPECT_NEAR(update.log_evidence(), evidence, 1e-9 * std::abs(evidence));
  sort_targets(after_turned);
  EXPECT_LT((after_turned.x - after.x).norm(), 1e-9);
  EXPECT_LT((after_turned.P - after.P).norm(), 1e-9 * after.P.norm());
}

// Laplace's evidence of a prior that knows everything is the likelihood itself.
TEST(JointAngleUpdate, EvidenceOfACertainPriorIsTheLikelihood) {
  const ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  JointAngleState before = joint_angle_prior(scene);
  before.P *= 1e-12;
  const RealInterval heard = interval(scene);
  AngleLikelihood likelihood;
  ASSERT_TRUE(likelihood.evaluate(heard, before.x.head(6), nullptr, 0.0, 1.0));
  JointAngleUpdate update;
  JointAngleState after;
  ASSERT_TRUE(update.run(before, heard, 0.0, before.x.head(6), {}, after));
  EXPECT_NEAR(update.log_evidence(), likelihood.log_likelihood(), 1e-6 * std::abs(likelihood.log_likelihood()));
}

TEST(JointAngleUpdate, RefusesWhatIsNoCovariance) {
  const ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  JointAngleState before = joint_angle_prior(scene), after;
  before.P(0, 0) = -1.0;
  JointAngleUpdate update;
  EXPECT_FALSE(update.run(before, interval(scene), 0.0, before.x.head(6), {}, after));
  before.P(0, 0) = std::nan("");
  EXPECT_FALSE(update.run(before, interval(scene), 0.0, before.x.head(6), {}, after));
}

TEST(JointAngleUpdate, CovarianceStaysOneOverManyIntervals) {
  const ArrayScene scene = scene_of({3.0, 4.0, 25.0});  // two that no beam resolves
  JointAngleState state = joint_angle_prior(scene);
  JointAngleUpdate update;
  for (std::uint64_t k = 0; k < 100; ++k) {
    JointAngleState after;
    predict(state, {}, 1.0);
    ASSERT_TRUE(is_covariance(state.P)) << k;
    if (!update.run(state, interval(scene, k), 0.0, state.x.head(6), {}, after)) continue;
    state = after;
    ASSERT_TRUE(is_covariance(state.P)) << k;
    EXPECT_EQ(state.P, state.P.transpose());
  }
  EXPECT_LT(std::sqrt(state.P(2, 2)), radians(0.2));
}

// A mode from one start and then from another is what the second comes to by itself, to the bit, also where one between
// them comes to nothing.
TEST(JointAngleUpdate, ASecondStartTakesNothingFromTheFirst) {
  const ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  const int n = 2 * kTargets;
  const JointAngleState before = joint_angle_prior(scene);
  const RealInterval heard = interval(scene);
  const SignalVector first = before.x.head(n);
  SignalVector second = first, nowhere = first;
  second.head(kTargets).array() += 0.01;
  nowhere[kTargets] = 40.0;
  JointAngleUpdate alone, update;
  JointAngleState expected, after;
  ASSERT_TRUE(alone.run(before, heard, 0.0, second, {}, expected));
  ASSERT_TRUE(update.take_prior(before));
  ASSERT_TRUE(update.find_mode(before, heard, 0.0, first, {}));
  const SignalVector of_first = update.mode();
  const double evidence_of_first = update.log_evidence();
  EXPECT_NE(of_first, alone.mode());
  EXPECT_FALSE(update.find_mode(before, heard, 0.0, nowhere, {}));
  ASSERT_TRUE(update.find_mode(before, heard, 0.0, second, {}));
  EXPECT_EQ(update.mode(), alone.mode());
  EXPECT_EQ(update.log_evidence(), alone.log_evidence());
  ASSERT_TRUE(update.give_posterior(before, after));
  EXPECT_EQ(after.x, expected.x);
  EXPECT_EQ(after.P, expected.P);
  ASSERT_TRUE(update.find_mode(before, heard, 0.0, first, {}));
  EXPECT_EQ(update.mode(), of_first);
  EXPECT_EQ(update.log_evidence(), evidence_of_first);
}

// The rates, which the likelihood does not look at while blocks do not move, show in the posterior alone.
TEST(JointAngleUpdate, RefusesAPosteriorThatIsNotFinite) {
  const ArrayScene scene = scene_of({-35.0, 4.0, 25.0});
  const int n = 2 * kTargets;
  const RealInterval heard = interval(scene);
  const JointAngleState before = joint_angle_prior(scene);
  JointAngleUpdate update;
  JointAngleState after;
  const auto is_given = [&](const JointAngleState& prior) {
    return update.take_prior(prior) && update.find_mode(prior, heard, 0.0, before.x.head(n), {}) &&
           update.give_posterior(prior, after);
  };
  for (const double value : {kInfinity, -kInfinity, kNaN})
    for (int i = 0; i < kTargets; ++i) {
      JointAngleState bad = before;
      bad.x[n + i] = value;
      EXPECT_FALSE(is_given(bad)) << "x " << i << " " << value;
      for (int j = 0; j < kTargets; ++j) {
        bad = before;
        bad.P(n + i, n + j) = value;
        EXPECT_FALSE(is_given(bad)) << "P " << i << " " << j << " " << value;
      }
    }
  JointAngleState large = before;  // numbers whose sum is none
  large.P.bottomRightCorner(kTargets, kTargets).setConstant(1e308);
  EXPECT_TRUE(is_given(large));
  EXPECT_TRUE(is_given(before));
}

}  // namespace
}  // namespace truebearing::joint_angle_update_test
