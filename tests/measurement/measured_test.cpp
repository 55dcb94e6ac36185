// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/measured.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace truebearing::measured_test {
namespace {

TEST(Measured, IsKnownByItsComponents) {
  EXPECT_EQ(Measured::of({"position_m"}), Measured::position(1));
  EXPECT_EQ(Measured::of({"east_m", "north_m"}), Measured::position(2));
  EXPECT_EQ(Measured::of({"range_m", "bearing_deg"}), Measured::range_bearing());
  EXPECT_EQ(Measured::of({"bearing_deg", "frequency_hz"}), Measured::bearing_frequency());
  EXPECT_EQ(Measured::of({"snapshots"}), Measured::snapshots());
  EXPECT_EQ(Measured::of({"depth_m"}).kind, "values");
}

TEST(Measured, MismatchIsSaidInWords) {
  EXPECT_EQ(mismatch(Measured::bearing(), Measured::position(1), "the scenario"),
            "measures bearing (bearing_deg), the scenario gives position (position_m)");
  EXPECT_EQ(mismatch(Measured::position(2), Measured::range_bearing(), "the log"),
            "measures position (east_m, north_m), the log gives range_bearing (range_m, bearing_deg)")
      << "of the same length";
  EXPECT_EQ(mismatch(Measured::range_bearing(), Measured::range_bearing(), "the scenario"), std::nullopt);
}

TEST(Measured, BearingIsTakenFromABearingWithItsFrequencyButNotTheOtherWayRound) {
  EXPECT_FALSE(mismatch(Measured::bearing(), Measured::bearing_frequency(), "the scenario"));
  EXPECT_TRUE(mismatch(Measured::bearing_frequency(), Measured::bearing(), "the scenario"));
}

TEST(Measured, StepLogsOfOtherStatesAreRefusedButTheirMeasurementsAreNotKnownBeforehand) {
  const Measured logs = Measured::step_log(plane_space());
  EXPECT_FALSE(mismatch(Measured::position(2), logs, "the scenario"));
  EXPECT_FALSE(mismatch(logs, logs, "the scenario"));
  EXPECT_TRUE(mismatch(Measured::step_log(line_space()), logs, "the scenario"));
  EXPECT_TRUE(mismatch(logs, Measured::position(2), "the scenario"));
}

}  // namespace
}  // namespace truebearing::measured_test
