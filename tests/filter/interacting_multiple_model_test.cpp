// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/interacting_multiple_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/motion/constant_acceleration.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing::interacting_multiple_model_test {
namespace {

constexpr double kExact = 1e-12;

using Cv = ConstantVelocity<1, DiscreteWhiteNoise>;
using Ca = ConstantAcceleration<1, ContinuousWhiteJerk>;

const Eigen::Vector2d kX0(10.0, 3.0);
const Eigen::Matrix2d kP0 = (Eigen::Matrix2d() << 100.0, 10.0, 10.0, 25.0).finished();
const Position<1> kSensor{Eigen::Matrix<double, 1, 1>(5.0)};

using Vector1 = Eigen::Matrix<double, 1, 1>;

// Two constant-velocity modes that begin with (x0, kP0).
std::unique_ptr<InteractingMultipleModel> two_modes(double quiet, double lively, const Eigen::Vector2d& x0 = kX0) {
  InteractingMultipleModel::Modes modes;
  modes.push_back(state_of<KalmanFilter<2>>(Cv{{quiet}}));
  modes.push_back(state_of<KalmanFilter<2>>(Cv{{lively}}));
  auto imm = std::make_unique<InteractingMultipleModel>(std::move(modes), star_chain(2, 0.1, 0.2, 1.0, 1.0));
  imm->begin(x0.data(), kP0.data());
  return imm;
}

// One at constant velocity, one with an acceleration besides, that begin with (x0, P0).
std::unique_ptr<InteractingMultipleModel> unequal_modes(double sigma_a, double q, const MarkovChain& chain,
                                                        const Eigen::Vector3d& x0, const Eigen::Matrix3d& P0) {
  InteractingMultipleModel::Modes modes;
  modes.push_back(state_of<KalmanFilter<2>>(Cv{{sigma_a}}));
  modes.push_back(state_of<KalmanFilter<3>>(Ca{{q}}));
  auto imm = std::make_unique<InteractingMultipleModel>(std::move(modes), chain);
  imm->begin(x0.data(), P0.data());
  return imm;
}

Vector1 measured(RandomStream& random, double position) {
  return Vector1(position + 5.0 * random.normal());
}

StepStatus take(TrackedState& state, const Vector1& z, StateUpdate& update) {
  return state.update(ErasedMeasurement<Position<1>>(kSensor, z, true), update);
}
StepStatus take(TrackedState& state, const Vector1& z) {
  StateUpdate update;
  return take(state, z, update);
}

TEST(MarkovChain, RowsSumToOneAtAnyStepAndStayingIsASojourn) {
  const MarkovChain chain = star_chain(6, 0.037, 0.084, 0.7, 1.0);
  for (const double dt_s : {0.0, 0.3, 1.0, 2.0, 50.0}) {
    const BoundedMatrix Pi = chain.over(dt_s);
    for (Eigen::Index i = 0; i < 6; ++i) {
      EXPECT_NEAR(Pi.row(i).sum(), 1.0, kExact);
      EXPECT_GE(Pi.row(i).minCoeff(), 0.0);
      EXPECT_NEAR(Pi(i, i), std::pow(chain.transition(i, i), dt_s), kExact);
    }
  }
  EXPECT_EQ(chain.over(1.0), chain.transition);
  EXPECT_NEAR(chain.transition(0, 3), 0.037 / 5.0, kExact);
  EXPECT_NEAR(chain.transition(3, 0), 0.084 * 0.7, kExact);
  EXPECT_NEAR(chain.transition(3, 1), 0.084 * 0.3 / 4.0, kExact);
}

TEST(InteractingMultipleModel, ModesOfOneModelAreTheKalmanFilter) {
  const auto imm = two_modes(2.0, 2.0);
  KalmanFilter<2> kalman(kX0, kP0);
  RandomStream random({.seed = 3}, StreamId::test);
  for (int k = 1; k <= 50; ++k) {
    const double dt_s = random.uniform(0.2, 3.0);
    ASSERT_EQ(imm->predict(dt_s), StepStatus::ok);
    kalman.predict(Cv{{2.0}}, dt_s);
    const auto z = measured(random, 3.0 * k);
    StateUpdate of_imm;
    ASSERT_EQ(take(*imm, z, of_imm), StepStatus::ok);
    const auto of_kalman = kalman.update(kSensor, z);
    EXPECT_LT((imm->x() - kalman.x()).norm(), 1e-9 * kalman.x().norm());
    EXPECT_LT((imm->P() - kalman.P()).norm(), 1e-9 * kalman.P().norm());
    EXPECT_LT((of_imm.K - of_kalman.K).norm(), 1e-9);
    EXPECT_NEAR(of_imm.nis, of_kalman.nis, 1e-9 * (1.0 + of_kalman.nis));
    EXPECT_NEAR((*imm->mode_probabilities()).sum(), 1.0, kExact);
  }
}

// The recursion as the book writes it, by hand for two modes.
TEST(InteractingMultipleModel, IsTheRecursionOfTheBook) {
  const auto imm = two_modes(0.5, 20.0);
  const Cv motions[2] = {{{0.5}}, {{20.0}}};
  Eigen::Vector2d x[2] = {kX0, kX0};
  Eigen::Matrix2d P[2] = {kP0, kP0};
  Eigen::Vector2d mu(0.5, 0.5);
  const Eigen::Matrix2d Pi = star_chain(2, 0.1, 0.2, 1.0, 1.0).transition;
  RandomStream random({.seed = 4}, StreamId::test);
  for (int k = 1; k <= 40; ++k) {
    imm->predict(1.0);
    const auto z = measured(random, k < 20 ? 3.0 * k : 60.0 + 40.0 * (k - 20));
    take(*imm, z);

    const Eigen::Vector2d c = Pi.transpose() * mu;
    Eigen::Vector2d x0[2], likelihood;
    Eigen::Matrix2d P0[2];
    for (int j = 0; j < 2; ++j) {
      x0[j].setZero();
      P0[j].setZero();
      for (int i = 0; i < 2; ++i) x0[j] += Pi(i, j) * mu[i] / c[j] * x[i];
      for (int i = 0; i < 2; ++i)
        P0[j] += Pi(i, j) * mu[i] / c[j] * (P[i] + (x[i] - x0[j]) * (x[i] - x0[j]).transpose());
    }
    for (int j = 0; j < 2; ++j) {
      const Eigen::Matrix2d F = motions[j].F(1.0);
      const Eigen::Vector2d x_pred = F * x0[j];
      const Eigen::Matrix2d P_pred = F * P0[j] * F.transpose() + motions[j].Q(1.0);
      const double S = P_pred(0, 0) + 25.0, nu = z[0] - x_pred[0];
      const Eigen::Vector2d K = P_pred.col(0) / S;
      x[j] = x_pred + K * nu;
      P[j] = P_pred - K * S * K.transpose();
      likelihood[j] = std::exp(-0.5 * nu * nu / S) / std::sqrt(S);
    }
    mu = c.cwiseProduct(likelihood) / c.dot(likelihood);
    const Eigen::Vector2d mean = mu[0] * x[0] + mu[1] * x[1];
    Eigen::Matrix2d total = Eigen::Matrix2d::Zero();
    for (int j = 0; j < 2; ++j) total += mu[j] * (P[j] + (x[j] - mean) * (x[j] - mean).transpose());
    EXPECT_LT(((*imm->mode_probabilities()) - mu).norm(), 1e-9) << k;
    EXPECT_LT((imm->x() - mean).norm(), 1e-9 * mean.norm());
    EXPECT_LT((imm->P() - total).norm(), 1e-9 * total.norm());
  }
}

TEST(InteractingMultipleModel, FollowsTheModeThatTheTargetIsIn) {
  const auto imm = two_modes(0.1, 30.0, Eigen::Vector2d::Zero());
  RandomStream random({.seed = 5}, StreamId::test);
  double position = 0.0, velocity = 5.0;
  for (int k = 1; k <= 60; ++k) {
    if (k > 30 && k <= 40) velocity += 40.0;
    position += velocity;
    imm->predict(1.0);
    take(*imm, measured(random, position));
    if (k == 30) {
      EXPECT_GT((*imm->mode_probabilities())[0], 0.8);
    }
    if (k == 38) {
      EXPECT_GT((*imm->mode_probabilities())[1], 0.7);
    }
  }
}

// What a mode lacks is not mixed into the one that has it: an acceleration is neither pulled to zero nor made certain.
TEST(InteractingMultipleModel, MixingLeavesAloneWhatOtherModesLack) {
  const Eigen::Vector3d x0(0.0, 10.0, 2.0);
  const Eigen::Matrix3d P0 = Eigen::Vector3d(4.0, 1.0, 0.25).asDiagonal();
  MarkovChain chain = star_chain(2, 0.5, 0.5, 1.0, 1.0);
  const auto imm = unequal_modes(0.0, 0.0, chain, x0, P0);
  EXPECT_NEAR(imm->x()[2], 1.0, kExact);  // half the modes have no acceleration
  ASSERT_EQ(imm->predict(0.0), StepStatus::ok);
  chain.initial << 0.0, 1.0;
  chain.transition << 1.0, 0.0, 0.0, 1.0;
  const auto accelerating = unequal_modes(0.0, 0.0, chain, x0, P0);
  ASSERT_EQ(accelerating->predict(1.0), StepStatus::ok);
  EXPECT_NEAR(accelerating->x()[2], 2.0, kExact);
  EXPECT_NEAR(accelerating->P()(2, 2), 0.25, kExact);
  // Mixed half and half, the accelerating mode still has its own acceleration and variance.
  const auto mixed = unequal_modes(0.0, 0.0, star_chain(2, 0.5, 0.5, 1.0, 1.0), x0, P0);
  for (int k = 0; k < 5; ++k) ASSERT_EQ(mixed->predict(1.0), StepStatus::ok);
  EXPECT_NEAR(mixed->x()[2], 0.5 * 2.0, 1e-9);
  EXPECT_NEAR(mixed->P()(2, 2), 0.5 * 0.25 + 0.5 * 1.0 + 0.5 * 1.0, 1e-9);
}

TEST(InteractingMultipleModel, UnequalStatesTrackAnAcceleration) {
  const auto imm = unequal_modes(0.1, 0.1, star_chain(2, 0.05, 0.05, 1.0, 1.0), Eigen::Vector3d(0.0, 5.0, 0.0),
                                 Eigen::Vector3d(25.0, 25.0, 4.0).asDiagonal());
  RandomStream random({.seed = 6}, StreamId::test);
  double position = 0.0, velocity = 5.0;
  for (int k = 1; k <= 60; ++k) {
    const double a = k > 30 ? 3.0 : 0.0;
    position += velocity + 0.5 * a;
    velocity += a;
    ASSERT_EQ(imm->predict(1.0), StepStatus::ok);
    ASSERT_EQ(take(*imm, measured(random, position)), StepStatus::ok);
    EXPECT_TRUE(is_covariance(imm->P()));
  }
  EXPECT_NEAR(imm->x()[2], 3.0, 1.0);
  EXPECT_GT((*imm->mode_probabilities())[1], 0.7);
}

TEST(InteractingMultipleModel, FailureLeavesAllAsItWas) {
  const auto imm = two_modes(0.5, 20.0);
  imm->predict(1.0);
  const Eigen::Vector2d x = imm->x();
  const Eigen::Matrix2d P = imm->P();
  const BoundedVector mu = (*imm->mode_probabilities());
  for (const double z : {std::nan(""), 1e200}) EXPECT_EQ(take(*imm, Vector1(z)), StepStatus::failed) << z;
  EXPECT_EQ(imm->predict(std::nan("")), StepStatus::failed);
  EXPECT_EQ(imm->x(), x);
  EXPECT_EQ(imm->P(), P);
  EXPECT_EQ((*imm->mode_probabilities()), mu);
}

}  // namespace
}  // namespace truebearing::interacting_multiple_model_test
