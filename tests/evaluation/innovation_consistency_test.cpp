// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/innovation_consistency.hpp"

#include <gtest/gtest.h>

#include "tests/support/line_trackers.hpp"

#include "truebearing/core/constants.hpp"

namespace truebearing::innovation_consistency_test {
namespace {

using testing::position;
using testing::RadarFilter;

// A target that moves as the filter believes, seen by a sensor whose noise is `sigma_factor` times what the filter
// believes, in units `unit` times those it takes.
InnovationConsistency consistency(RadarFilter radar, double sigma_factor, double unit, int steps,
                                  double process_factor = 1.0) {
  radar.variance = {1e6, 4e4};
  RandomStream random({.seed = 6}, StreamId::test);
  Eigen::Vector2d x(1e3 * random.normal(), 200.0 * random.normal());
  const auto tracker = radar.tracker();
  InnovationConsistency result;
  for (int k = 1; k <= steps; ++k) {
    x[0] += x[1];
    x[0] += std::sqrt(process_factor * radar.noise_variance[0]) * random.normal();
    x[1] += std::sqrt(process_factor * radar.noise_variance[1]) * random.normal();
    result.add(tracker->step(position(k, unit * (x[0] + sigma_factor * radar.sigma_m * random.normal())))[0]);
  }
  return result;
}

TEST(InnovationConsistency, ConsistentTrackerIsInsideItsIntervals) {
  const InnovationConsistency c = consistency({}, 1.0, 1.0, 2000);
  EXPECT_EQ(c.steps(), 2000);
  EXPECT_GT(c.nis_ratio(), c.nis_ratio_low());
  EXPECT_LT(c.nis_ratio(), c.nis_ratio_high());
  EXPECT_LT(std::abs(c.correlation()), c.correlation_limit());
  EXPECT_FALSE(c.is_far_too_large_at_start());
}

TEST(InnovationConsistency, TrackerThatBelievesTooLittleNoiseIsCaught) {
  const InnovationConsistency c = consistency({}, 1.3, 1.0, 2000);
  EXPECT_GT(c.nis_ratio(), c.nis_ratio_high());
}

TEST(InnovationConsistency, TrackerThatBelievesTooMuchNoiseIsCaught) {
  const InnovationConsistency c = consistency({}, 0.7, 1.0, 2000);
  EXPECT_LT(c.nis_ratio(), c.nis_ratio_low());
}

TEST(InnovationConsistency, TrackerThatDoesNotFollowIsNotWhite) {
  const InnovationConsistency c = consistency({}, 1.0, 1.0, 2000, 1e4);
  EXPECT_GT(c.correlation(), c.correlation_limit());
}

TEST(InnovationConsistency, WrongUnitIsImplausible) {
  EXPECT_TRUE(consistency({}, 1.0, 1000.0, 20).is_far_too_large_at_start()) << "metres where kilometres were meant";
  EXPECT_TRUE(consistency({}, 1.0, 1e-3, 20).is_far_too_small()) << "kilometres where metres were meant";
  EXPECT_FALSE(consistency({}, 2.0, 1.0, 20).is_far_too_large_at_start()) << "a filter twice too sure is none";
  EXPECT_FALSE(consistency({}, 0.5, 1.0, 20).is_far_too_small());
}

TEST(InnovationConsistency, WrongUnitIsImplausibleAlsoBehindAGate) {
  RadarFilter gated;
  gated.options.gate_nis = 6.6;
  EXPECT_TRUE(consistency(gated, 1.0, 1000.0, 20).is_far_too_large_at_start());
}

TEST(InnovationConsistency, OfNothingIsNaN) {
  const InnovationConsistency c;
  EXPECT_EQ(c.steps(), 0);
  EXPECT_TRUE(std::isnan(c.nis_ratio()));
  EXPECT_TRUE(std::isnan(c.correlation()));
  EXPECT_FALSE(c.is_far_too_large_at_start());
}

StepRecord record_of(int track, double nu) {
  StepRecord record;
  record.track = track;
  record.innovation = Innovation{BoundedVector::Constant(1, 0.0), BoundedVector::Constant(1, nu),
                                 BoundedMatrix::Constant(1, 1, 1.0), nu * nu};
  return record;
}

TEST(InnovationConsistency, WhitenessIsThatOfEachTrack) {
  RandomStream random({.seed = 7}, StreamId::test);
  InnovationConsistency white, not_white;
  double last = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double nu = random.normal();
    white.add(record_of(0, nu));
    white.add(record_of(1, nu));  // as its neighbour, but white in time
    not_white.add(record_of(0, nu + last));
    not_white.add(record_of(1, random.normal()));
    last = nu;
  }
  EXPECT_EQ(white.steps(), 4000);
  EXPECT_LT(std::abs(white.correlation()), std::sqrt(2.0) * white.correlation_limit()) << "of 2000 different ones";
  EXPECT_GT(not_white.correlation(), 5.0 * not_white.correlation_limit()) << "though another comes between";
}

TEST(InnovationConsistency, WrongUnitIsImplausibleInTheFirstStepsOfEachTrack) {
  InnovationConsistency c;
  for (int k = 0; k < 100; ++k) c.add(record_of(0, 1.0));
  EXPECT_FALSE(c.is_far_too_large_at_start());
  for (int k = 0; k < 100; ++k) c.add(record_of(1, 1000.0));
  EXPECT_TRUE(c.is_far_too_large_at_start());
}

TEST(InnovationConsistency, SensorThatStandsStillIsCaughtWhereverItBegins) {
  RandomStream random({.seed = 8}, StreamId::test);
  InnovationConsistency c;
  for (int k = 0; k < 500; ++k) c.add(record_of(0, random.normal()));
  EXPECT_FALSE(c.is_far_too_small());
  for (int k = 0; k < 20; ++k) c.add(record_of(0, 1e-3 * random.normal()));
  EXPECT_TRUE(c.is_far_too_small());
  EXPECT_FALSE(c.is_far_too_large_at_start());
}

TEST(InnovationConsistency, OfInnovationsThatAreAllZeroThereIsNoCorrelation) {
  InnovationConsistency c;
  for (int k = 0; k < 20; ++k) c.add(record_of(0, 0.0));
  EXPECT_TRUE(std::isnan(c.correlation()));
  EXPECT_TRUE(c.is_far_too_small());
}

TEST(InnovationConsistency, CoastedStepsDoNotCount) {
  InnovationConsistency c;
  const auto tracker = RadarFilter{}.tracker();
  c.add(tracker->step(position(1.0, 0.0))[0]);
  c.add(tracker->step(position(2.0, kNaN))[0]);
  EXPECT_EQ(c.steps(), 1);
}

}  // namespace
}  // namespace truebearing::innovation_consistency_test
