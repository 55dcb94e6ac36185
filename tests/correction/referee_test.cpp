#include "truebearing/correction/referee.hpp"

#include <gtest/gtest.h>

#include "truebearing/core/random.hpp"

namespace truebearing::referee_test {
namespace {

// A target on a line at 10 m/s, measured every second; what two estimates of it are off by decides.
double weight_after(int steps, double corrected_error_m, double reference_error_m, const RefereeOptions& options = {}) {
  RandomStream random({.seed = 2}, StreamId::test);
  Referee referee;
  StepRecord base;
  base.x = Eigen::Vector2d::Zero();
  for (int k = 1; k <= steps; ++k) {
    const double position = 10.0 * k;
    base.time_s = k;
    base.innovation = Innovation{BoundedVector::Constant(1, position + random.normal()), BoundedVector::Zero(1),
                                 BoundedMatrix::Constant(1, 1, 2.0), 0.0};
    referee.judge(base, options);
    referee.predict(k, Eigen::Vector2d(position + corrected_error_m, 10.0),
                    Eigen::Vector2d(position + reference_error_m, 10.0));
  }
  return referee.weight(options);
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

TEST(Referee, IsOpenBeforeTheFirstPrediction) {
  EXPECT_EQ(Referee().weight({}), 1.0);
}

TEST(Referee, MeasurementsThatWereNotUsedDoNotCount) {
  Referee referee;
  StepRecord base;
  base.x = Eigen::Vector2d::Zero();
  base.time_s = 1.0;
  referee.predict(0.0, Eigen::Vector2d(1e6, 0.0), Eigen::Vector2d::Zero());
  base.status = StepStatus::coasted;
  referee.judge(base, {});
  EXPECT_EQ(referee.weight({}), 1.0);
}

TEST(Referee, NumbersThatOverflowLoseTheWeight) {
  EXPECT_EQ(weight_after(3, 1e300, 0.0), 0.0);
}

}  // namespace
}  // namespace truebearing::referee_test
