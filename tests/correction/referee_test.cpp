// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/referee.hpp"

#include <gtest/gtest.h>

#include "truebearing/core/random.hpp"

namespace truebearing::referee_test {
namespace {

struct Errors {
  double position_m = 0.0;
  double velocity_mps = 0.0;
};

// A target on a line, at 10 m/s in the beginning and measured every second to 1 m; what two estimates of it are off by
// decides.
Referee::Weights weights_after(int steps, const Errors& corrected, const Errors& reference,
                               double acceleration_mps2 = 0.0) {
  const RefereeOptions options;
  RandomStream random({.seed = 2}, StreamId::test);
  Referee referee;
  StepRecord base;
  base.x = Eigen::Vector2d::Zero();
  StepRecord reference_record = base;
  reference_record.P = Eigen::Matrix2d::Identity();
  for (int k = 1; k <= steps; ++k) {
    const double position = 10.0 * k + 0.5 * acceleration_mps2 * k * k, velocity = 10.0 + acceleration_mps2 * k;
    base.time_s = reference_record.time_s = k;
    base.innovation = Innovation{BoundedVector::Constant(1, position + random.normal()), BoundedVector::Zero(1),
                                 BoundedMatrix::Constant(1, 1, 2.0), 0.0};
    referee.judge(base, options);
    const Referee::Weights w = referee.weights(options);
    const BoundedVector x_corrected =
        Eigen::Vector2d(position + corrected.position_m, velocity + corrected.velocity_mps);
    reference_record.x = Eigen::Vector2d(position + reference.position_m, velocity + reference.velocity_mps);
    const BoundedVector published =
        reference_record.x +
        BoundedVector(Eigen::Vector2d(w.position, w.velocity)).cwiseProduct(x_corrected - reference_record.x);
    referee.remember(base, x_corrected, reference_record, published);
  }
  return referee.weights(options);
}

double weight_after(int steps, double corrected_error_m, double reference_error_m) {
  return weights_after(steps, {corrected_error_m}, {reference_error_m}).position;
}

TEST(Referee, EqualPredictionsKeepNearlyAllTheWeight) {
  const double weight = weight_after(200, 0.5, 0.5);
  EXPECT_GT(weight, 0.85);
  EXPECT_LT(weight, 1.0);
}

TEST(Referee, BetterPredictionsKeepAllTheWeight) {
  EXPECT_GT(weight_after(200, 0.0, 2.0), 0.999);
}

TEST(Referee, WorsePredictionsLoseTheWeight) {
  EXPECT_LT(weight_after(200, 2.0, 0.0), 1e-6);
  EXPECT_GT(weight_after(3, 0.3, 0.0), 0.5) << "not on the word of three measurements";
}

TEST(Referee, WorsePositionsLoseTheirWeightWhateverTheVelocitiesSay) {
  const Referee::Weights w = weights_after(300, {2.0, 0.0}, {0.0, 2.0});
  EXPECT_LT(w.position, 0.01);
  EXPECT_GT(w.velocity, 0.99);
}

TEST(Referee, WorseVelocitiesLoseTheirWeightWhateverThePositionsSay) {
  const Referee::Weights w = weights_after(300, {0.0, 1.5}, {2.0, 0.0});
  EXPECT_GT(w.position, 0.99);
  EXPECT_LT(w.velocity, 0.01);
}

TEST(Referee, SmallErrorOfVelocityShowsSeveralStepsLater) {
  EXPECT_LT(weights_after(300, {0.0, 0.7}, {0.0, 0.0}).velocity, 0.1);
}

// A velocity that runs ahead of one that changes would foretell the next position better, and is wrong all the same.
TEST(Referee, VelocityIsJudgedAtItsOwnTime) {
  constexpr double kAhead = 2.0;  // half of what a step adds: the mean velocity until the next measurement
  EXPECT_LT(weights_after(300, {0.0, kAhead}, {0.0, 0.0}, 2.0 * kAhead).velocity, 0.01);
  EXPECT_GT(weights_after(300, {0.0, 0.0}, {0.0, kAhead}, 2.0 * kAhead).velocity, 0.99);
}

// The slope of a parabola at its middle point is exact however the times lie.
TEST(Referee, UnevenTimesChangeNothing) {
  const RefereeOptions options;
  Referee referee;
  StepRecord base, reference;
  base.x = Eigen::Vector2d::Zero();
  reference.P = Eigen::Matrix2d::Identity() * 1e-6;
  double t = 0.0;
  for (int k = 1; k <= 200; ++k) {
    t += k % 3 == 0 ? 3.0 : 0.5;
    base.time_s = t;
    base.innovation = Innovation{BoundedVector::Constant(1, 2.0 * t * t), BoundedVector::Zero(1),
                                 BoundedMatrix::Constant(1, 1, 1e-6), 0.0};
    referee.judge(base, options);
    reference.x = Eigen::Vector2d(2.0 * t * t, 4.0 * t);
    referee.remember(base, reference.x + BoundedVector(Eigen::Vector2d(0.0, 0.01)), reference, reference.x);
  }
  EXPECT_LT(referee.weights(options).velocity, 1e-6);
}

TEST(Referee, IsOpenBeforeTheFirstPrediction) {
  EXPECT_EQ(Referee().weights({}).position, 1.0);
  EXPECT_EQ(Referee().weights({}).velocity, 1.0);
}

TEST(Referee, MeasurementsThatWereNotUsedDoNotCount) {
  Referee referee;
  StepRecord base;
  base.x = Eigen::Vector2d::Zero();
  StepRecord reference = base;
  reference.P = Eigen::Matrix2d::Identity();
  base.innovation = Innovation{BoundedVector::Zero(1), BoundedVector::Zero(1), BoundedMatrix::Identity(1, 1), 0.0};
  referee.remember(base, Eigen::Vector2d(1e6, 0.0), reference, reference.x);
  base.time_s = 1.0;
  base.status = StepStatus::coasted;
  referee.judge(base, {});
  EXPECT_EQ(referee.weights({}).position, 1.0);
}

TEST(Referee, NumbersThatOverflowLoseTheWeight) {
  EXPECT_EQ(weight_after(3, 1e300, 0.0), 0.0);
}

}  // namespace
}  // namespace truebearing::referee_test
