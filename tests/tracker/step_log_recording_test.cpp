// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/step_log_recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "tests/support/error_message.hpp"

namespace truebearing::step_log_recording_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::error_message;
using ::testing::HasSubstr;

std::vector<RecordedTrack> read(const std::string& text) {
  std::istringstream stream(text);
  return recordings_of(read_step_log(stream, "steps.csv"), "steps.csv");
}

const std::string kTwoTracks =
    "time_s,track,x_position_m,x_velocity_mps,P_1_1,P_1_2,P_2_2,z_1,nu_1,S_1_1,truth_position_m\n"
    "1,4,10,2,4,1,9,11,1,5,9\n"
    "1,7,-5,0,4,0,9,-6,-1,5,-4\n"
    "2,4,12,2,4,1,9,,,,12\n"
    "3,4,14,2,4,1,9,13,-1,5,15\n"
    "3,7,-5,0,4,0,9,-6,-1,5,-4\n";

TEST(StepLogRecording, EveryTrackIsARecordingOfItsOwn) {
  const std::vector<RecordedTrack> tracks = read(kTwoTracks);
  ASSERT_EQ(tracks.size(), 2u);
  EXPECT_EQ(tracks[0].track, 4);
  EXPECT_EQ(tracks[1].track, 7);
  EXPECT_EQ(tracks[0].recording.measurements.size(), 3u);
  EXPECT_EQ(tracks[1].recording.measurements.size(), 2u);
  EXPECT_THAT(tracks[0].recording.measured, ElementsAre("position_m"));
  EXPECT_EQ(tracks[1].recording.measurements[1].z[0], -6.0);
}

TEST(StepLogRecording, MeasurementsCarryTheirRecords) {
  const Recording recording = read(kTwoTracks)[1].recording;  // a copy owns them as well
  const StepRecord& record = *recording.measurements[1].recorded;
  EXPECT_EQ(record.time_s, 3.0);
  EXPECT_EQ(record.x[0], -5.0);
  EXPECT_EQ(record.track, 0) << "as trackers of one target number it";
  EXPECT_EQ(record.innovation->nu[0], -1.0);
}

TEST(StepLogRecording, StepWithoutMeasurementIsMissing) {
  const Recording recording = read(kTwoTracks)[0].recording;
  EXPECT_TRUE(recording.measurements[1].is_missing());
  EXPECT_FALSE(recording.measurements[1].recorded->innovation);
  EXPECT_EQ(recording.counts.missing, 1);
}

TEST(StepLogRecording, TruthIsCompletedByVelocities) {
  const Recording recording = read(kTwoTracks)[0].recording;
  EXPECT_EQ(recording.truth_space, &line_space());
  EXPECT_EQ(recording.truth[0].x[2](0), 15.0);
  EXPECT_NEAR(recording.truth[0].x[1](1), 3.0, 1e-12);
  const std::string given =
      "time_s,track,x_position_m,x_velocity_mps,P_1_1,P_1_2,P_2_2,truth_velocity_mps,truth_position_m\n"
      "1,0,10,2,4,1,9,7,9\n2,0,10,2,4,1,9,,10\n";
  const Recording kept = read(given)[0].recording;
  EXPECT_EQ(kept.truth[0].x[0](1), 7.0);
  EXPECT_TRUE(std::isnan(kept.truth[0].x[1](1)));
  EXPECT_EQ(kept.truth[0].x[1](0), 10.0);
  EXPECT_TRUE(kept.measured.empty());
  EXPECT_TRUE(kept.measurements[0].is_missing());
}

TEST(StepLogRecording, LogWithoutTruthSaysSo) {
  const Recording recording = read("time_s,track,x_position_m,P_1_1\n1,0,5,2\n")[0].recording;
  EXPECT_EQ(recording.truth_space, nullptr);
  EXPECT_TRUE(recording.truth.empty());
}

TEST(StepLogRecording, MeasurementsThatAreNoPositionsHaveNoNames) {
  const std::string text = "time_s,track,x_position_m,x_velocity_mps,P_1_1,P_1_2,P_2_2,z_1,z_2\n1,0,10,2,4,1,9,7,9\n";
  EXPECT_THAT(read(text)[0].recording.measured, ElementsAre("z_1", "z_2"));
}

TEST(StepLogRecording, TruthMustBeOfTheState) {
  EXPECT_THAT(error_message([] { read("time_s,track,x_position_m,P_1_1,truth_positon_m\n1,0,5,2,1\n"); }),
              AllOf(HasSubstr("steps.csv: truth_positon_m"), HasSubstr("position_m")));
}

}  // namespace
}  // namespace truebearing::step_log_recording_test
