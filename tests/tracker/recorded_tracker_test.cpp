// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/recorded_tracker.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/line_trackers.hpp"

#include "truebearing/core/constants.hpp"

namespace truebearing::recorded_tracker_test {
namespace {

using testing::position;
using testing::radar_log;
using testing::RadarFilter;

RecordedTracker replay(const std::string& text) {
  std::istringstream stream(text);
  return RecordedTracker(read_step_log(stream, "steps.csv"));
}

TEST(RecordedTracker, ReplayEqualsTheOriginal) {
  const auto original = RadarFilter{}.tracker();
  const std::vector<Measurement> log = radar_log(13, 60);
  StepLogWriter writer(line_space(), 1);
  for (const Measurement& measurement : log) writer.add("plain", original->step(measurement)[0]);
  original->reset();
  RecordedTracker recorded = replay(writer.str());
  EXPECT_EQ(&recorded.space(), &line_space());
  EXPECT_TRUE(recorded.blocks().innovation);
  EXPECT_FALSE(recorded.blocks().gain);
  for (const Measurement& measurement : log) {
    const StepRecord expected = original->step(measurement)[0];
    const auto records = recorded.step(measurement);
    ASSERT_EQ(records.size(), 1u);
    EXPECT_EQ(records[0].x, expected.x);
    EXPECT_EQ(records[0].P, expected.P);
    EXPECT_EQ(records[0].innovation->nu, expected.innovation->nu);
  }
}

const std::string kForeign =
    "time_s,track,x_position_m,x_velocity_mps,P_1_1,P_1_2,P_2_2\n"
    "1,0,10,2,4,1,9\n"
    "2,0,12,2,4,1,9\n"
    "2,3,-5,0,4,0,9\n"
    "4,0,16,2,4,1,9\n";

TEST(RecordedTracker, WithoutInnovationColumnsItPromisesNone) {
  RecordedTracker recorded = replay(kForeign);
  EXPECT_FALSE(recorded.blocks().innovation);
  EXPECT_FALSE(recorded.step(position(1.0, 0.0))[0].innovation);
}

TEST(RecordedTracker, RecordsAreThoseOfTheMeasurementsTime) {
  RecordedTracker recorded = replay(kForeign);
  EXPECT_TRUE(recorded.step(position(0.5, 0.0)).empty());
  EXPECT_EQ(recorded.step(position(1.0 + 4e-7, 0.0))[0].x[0], 10.0) << "to a microsecond";
  const auto both = recorded.step(position(2.0, 0.0));
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[1].track, 3);
  EXPECT_TRUE(recorded.step(position(3.0, 0.0)).empty());
  EXPECT_TRUE(recorded.step(position(kNaN, 0.0)).empty());
  EXPECT_EQ(recorded.step(position(4.0, kNaN))[0].x[0], 16.0) << "the measurement itself is not looked at";
  EXPECT_TRUE(recorded.step(position(5.0, 0.0)).empty());
}

TEST(RecordedTracker, ResetAndFreshBeginAnew) {
  RecordedTracker recorded = replay(kForeign);
  recorded.step(position(4.0, 0.0));
  const auto copy = recorded.fresh();
  EXPECT_EQ(copy->step(position(1.0, 0.0))[0].x[0], 10.0);
  EXPECT_TRUE(recorded.step(position(1.0, 0.0)).empty());
  recorded.reset();
  EXPECT_EQ(recorded.step(position(1.0, 0.0))[0].x[0], 10.0);
}

TEST(RecordedTracker, WithoutALogItReplaysWhatMeasurementsCarry) {
  RecordedTracker recorded(line_space(), true);
  EXPECT_TRUE(recorded.replays_measurements());
  EXPECT_TRUE(recorded.blocks().innovation);
  EXPECT_EQ(&recorded.space(), &line_space());
  StepRecord record;
  record.space = &line_space();
  record.x = Eigen::Vector2d(3.0, 4.0);
  Measurement measurement = position(1.0, 0.0);
  EXPECT_TRUE(recorded.step(measurement).empty());
  measurement.recorded = &record;
  ASSERT_EQ(recorded.step(measurement).size(), 1u);
  EXPECT_EQ(recorded.fresh()->step(measurement)[0].x[1], 4.0);
  record.space = &plane_space();
  EXPECT_TRUE(recorded.step(measurement).empty()) << "of another space";
}

}  // namespace
}  // namespace truebearing::recorded_tracker_test
