// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/recorded_scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "tests/support/array_recording.hpp"
#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/recording/recording_csv.hpp"

namespace truebearing::recorded_scenario_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;
using testing::variance_fits;

Recording read(const std::string& text) {
  std::istringstream stream(text);
  return read_recording(stream, "log.csv");
}

const std::string kLog = "time_s,position_m,position_sigma_m,truth_position_m\n0,1,10,0\n1,,10,5\n2,3,20,10\n3,4,20,\n";

TEST(RecordedScenario, MeasuresTheTruthAfreshWithTheLogsSigma) {
  const RecordedScenario scenario(read(kLog));
  EXPECT_EQ(&scenario.truth_space(), &line_space());
  std::vector<double> first, third;
  for (std::uint64_t run = 0; run < 5000; ++run) {
    const Recording recording = scenario.simulate({1, Role::evaluation, run});
    first.push_back(recording.measurements[0].z(0));
    third.push_back(recording.measurements[2].z(0));
  }
  EXPECT_NEAR(testing::moments(first).mean, 0.0, testing::mean_margin(10.0, first.size()));
  EXPECT_NEAR(testing::moments(third).mean, 10.0, testing::mean_margin(20.0, third.size()));
  EXPECT_TRUE(variance_fits(testing::moments(first).variance, 100.0, first.size()));
  EXPECT_TRUE(variance_fits(testing::moments(third).variance, 400.0, third.size()));
}

TEST(RecordedScenario, WhatIsMissingStaysMissing) {
  const Recording recording = RecordedScenario(read(kLog)).simulate({});
  EXPECT_TRUE(recording.measurements[1].is_missing());
  EXPECT_TRUE(recording.measurements[3].is_missing()) << "nothing to measure without a truth";
  EXPECT_EQ(recording.counts.missing, 2);
  EXPECT_EQ(recording.measurements[2].sigma(0), 20.0);
}

TEST(RecordedScenario, SigmaBesideItStandsInForTheLogs) {
  const std::string bare = "time_s,position_m,truth_position_m\n0,1,0\n1,2,5\n";
  EXPECT_THAT(error_message([&] { RecordedScenario(read(bare)); }), HasSubstr("carries no sigma"));
  EXPECT_THAT(error_message([&] { RecordedScenario(read(bare), 0.0); }), HasSubstr("a number > 0"));
  const RecordedScenario scenario(read(bare), 7.0);
  std::vector<double> z;
  for (std::uint64_t run = 0; run < 5000; ++run)
    z.push_back(scenario.simulate({1, Role::evaluation, run}).measurements[0].z(0));
  EXPECT_TRUE(variance_fits(testing::moments(z).variance, 49.0, z.size()));
}

TEST(RecordedScenario, NeedsATruthThatHoldsWhatIsMeasured) {
  EXPECT_THAT(error_message([] { RecordedScenario(read("time_s,position_m\n0,1\n"), 1.0); }), HasSubstr("no truth"));
  EXPECT_THAT(
      error_message([] { RecordedScenario(read("time_s,position_m,truth_east_m,truth_north_m\n0,1,2,3\n"), 1.0); }),
      HasSubstr("position_m"));
}

TEST(RecordedScenario, RangeAndBearingFollowFromATruthInThePlane) {
  const Recording log = read(
      "time_s,range_m,bearing_deg,range_sigma_m,bearing_sigma_deg,sensor_east_m,sensor_north_m,truth_east_m,"
      "truth_north_m\n0,1,2,1e-9,1e-9,1000,0,4000,-4000\n");
  EXPECT_EQ(reason_to_replay(log), "");
  const Recording measured = RecordedScenario(log).simulate({});
  EXPECT_NEAR(measured.measurements[0].z(0), 5000.0, 1e-6);
  EXPECT_NEAR(measured.measurements[0].z(1), std::atan2(3000.0, -4000.0), 1e-6);
}

TEST(RecordedScenario, LogThatDoesNotSayHowGoodItIsIsReplayed) {
  const Recording log = read("time_s,range_m,bearing_deg,truth_east_m,truth_north_m\n0,1,2,3,4\n1,,2,3,4\n");
  EXPECT_THAT(reason_to_replay(log), HasSubstr("no sigma"));
  const RecordedScenario scenario = RecordedScenario::replayed(log);
  const Recording replay = scenario.simulate({1, Role::evaluation, 3});
  EXPECT_EQ(replay.measurements[0].z, log.measurements[0].z);
  EXPECT_EQ(replay.counts.missing, 1);
  EXPECT_THAT(reason_to_replay(read("time_s,bearing_deg,frequency_hz,bearing_sigma_deg,frequency_sigma_hz,truth_east_m,"
                                    "truth_north_m,truth_frequency_hz\n0,1,2,1,1,3,4,5\n")),
              HasSubstr("frequency_hz"))
      << "what is heard is not what the source sends";
}

// Two tracks that stand still, at (300, 400) and at (0, -1000); the second has no truth at its second step.
std::vector<Recording> positions() {
  std::vector<Recording> tracks;
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(300, 400), Eigen::Vector2d(0, -1000)}) {
    Recording track;
    track.measured = {"east_m", "north_m"};
    track.truth_space = &plane_space();
    track.truth.resize(1);
    for (int k = 0; k < 3; ++k) {
      Measurement measurement;
      measurement.time_s = k;
      measurement.z = place;
      track.measurements.push_back(measurement);
      track.truth[0].x.emplace_back(Eigen::Vector4d(place.x(), place.y(), 0, 0));
    }
    tracks.push_back(track);
  }
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  tracks[1].truth[0].x[1].setConstant(unknown);
  tracks[1].measurements[2].z.setConstant(unknown);
  return tracks;
}

TEST(RecordedScenario, RunsTakeTurnsAtTheTracks) {
  const RecordedScenario scenario(positions(), RecordedSensor{.sigma_m = 10.0});
  EXPECT_EQ(&scenario.truth_space(), &plane_space());
  std::vector<double> east, north;
  for (std::uint64_t run = 0; run < 4000; ++run) {
    const Recording recording = scenario.simulate({1, Role::evaluation, run});
    const Eigen::Vector2d place = run % 2 == 0 ? Eigen::Vector2d(300, 400) : Eigen::Vector2d(0, -1000);
    ASSERT_EQ(recording.truth[0].x[0].head<2>(), place);
    EXPECT_EQ(recording.measurements[0].sigma.size(), 0);
    east.push_back(recording.measurements[0].z(0) - place.x());
    north.push_back(recording.measurements[1].z(1) - place.y());
  }
  EXPECT_TRUE(variance_fits(testing::moments(east).variance, 100.0, east.size()));
  EXPECT_TRUE(variance_fits(testing::moments(north).variance, 100.0, north.size())) << "measured without truth too";
  const Recording second = scenario.simulate({1, Role::evaluation, 1});
  EXPECT_TRUE(second.measurements[2].is_missing());
  EXPECT_EQ(second.counts.missing, 1);
}

TEST(RecordedScenario, RangeAndBearingAreTakenFromTheSite) {
  RecordedSensor sensor{.output = RecordedSensor::Output::range_bearing, .sigma_m = 5.0, .bearing_sigma_rad = 0.1};
  sensor.site_m << 300, 1400;
  sensor.reported = true;
  const RecordedScenario scenario(positions(), sensor);
  std::vector<double> range, bearing;
  for (std::uint64_t run = 0; run < 8000; run += 2) {
    const Recording recording = scenario.simulate({1, Role::evaluation, run});
    EXPECT_THAT(recording.measured, ::testing::ElementsAre("range_m", "bearing_deg"));
    ASSERT_EQ(recording.truth[0].x[0].head<2>(), Eigen::Vector2d(0, -1000)) << "the site is the origin";
    EXPECT_EQ(recording.measurements[0].sigma(1), 0.1);
    EXPECT_LE(std::abs(recording.measurements[0].z(1)), kPi);
    range.push_back(recording.measurements[0].z(0) - 1000.0);
    bearing.push_back(wrap_pi(recording.measurements[0].z(1) - kPi));  // due South
  }
  EXPECT_NEAR(testing::moments(bearing).mean, 0.0, testing::mean_margin(0.1, bearing.size()));
  EXPECT_TRUE(variance_fits(testing::moments(range).variance, 25.0, range.size()));
  EXPECT_TRUE(variance_fits(testing::moments(bearing).variance, 0.01, bearing.size()));
}

TEST(RecordedScenario, SnapshotsAreReplayedWithTheTruthOfAllTargets) {
  const Recording recorded = testing::array_recording();
  const RecordedScenario scenario(recorded);
  EXPECT_EQ(&scenario.truth_space(), &angle_space());
  for (const std::uint64_t run : {0u, 5u}) {
    const Recording recording = scenario.simulate({1, Role::evaluation, run});
    EXPECT_EQ(recording.snapshots, recorded.snapshots);
    EXPECT_EQ(recording.measurements[1].snapshots->values.data(), recorded.measurements[1].snapshots->values.data());
    EXPECT_EQ(recording.truth.size(), 2u);
    EXPECT_EQ(recording.counts.missing, 1);
  }
  Recording without = recorded;
  without.truth_space = nullptr;
  EXPECT_THAT(error_message([&] { RecordedScenario{without}; }), HasSubstr("no truth"));
}

TEST(RecordedScenario, PositionsMustBeThoseOfThePlane) {
  EXPECT_THAT(error_message([] { RecordedScenario({}, RecordedSensor{}); }), HasSubstr("no track"));
  EXPECT_THAT(error_message([] { RecordedScenario({read(kLog)}, RecordedSensor{}); }),
              HasSubstr("east_m, north_m with their truth"));
}

}  // namespace
}  // namespace truebearing::recorded_scenario_test
