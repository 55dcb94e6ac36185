// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/support/line_trackers.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/tracker/raw_tracker.hpp"

namespace truebearing::raw_tracker_test {
namespace {

using testing::position;

RawTracker raw() {
  return {state_space_of_components({"position_m"}), BoundedVector::Constant(1, 150.0)};
}

TEST(RawTracker, EstimateIsTheMeasurementWithItsVariance) {
  RawTracker tracker = raw();
  const auto records = tracker.step(position(1.0, 42.0));
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].x[0], 42.0);
  EXPECT_EQ(records[0].P(0, 0), 150.0 * 150.0);
  EXPECT_EQ(records[0].space, &tracker.space());
}

TEST(RawTracker, SigmaOfTheMeasurementGoesFirst) {
  RawTracker tracker = raw();
  Measurement measurement = position(1.0, 42.0);
  measurement.sigma = BoundedVector::Constant(1, 10.0);
  EXPECT_EQ(tracker.step(measurement)[0].P(0, 0), 100.0);
}

TEST(RawTracker, WithoutAUsableMeasurementThereIsNoRecord) {
  RawTracker tracker = raw();
  EXPECT_FALSE(tracker.step(position(1.0, 42.0)).empty());
  EXPECT_TRUE(tracker.step(position(1.0, 42.0)).empty());
  EXPECT_TRUE(tracker.step(position(2.0, kNaN)).empty());
  EXPECT_TRUE(tracker.step(position(1.5, 42.0)).empty());
  Measurement plane = position(3.0, 1.0);
  plane.z = BoundedVector::Constant(2, 1.0);
  EXPECT_TRUE(tracker.step(plane).empty()) << "of another size than the state";
  EXPECT_EQ(tracker.counts().repeated, 1);
  EXPECT_EQ(tracker.counts().missing, 1);
  EXPECT_EQ(tracker.counts().out_of_order, 1);
  tracker.reset();
  EXPECT_EQ(tracker.counts().missing, 0);
  EXPECT_FALSE(tracker.fresh()->step(position(0.0, 1.0)).empty());
}

TEST(RawTracker, PromisesNoBlocks) {
  const RawTracker tracker = raw();
  EXPECT_FALSE(tracker.blocks().innovation);
  EXPECT_FALSE(tracker.blocks().gain);
}

}  // namespace
}  // namespace truebearing::raw_tracker_test
