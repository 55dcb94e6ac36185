// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/debrief_replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/error_message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/recording/geographic_track.hpp"
#include "truebearing/recording/log_check.hpp"
#include "truebearing/recording/recording_csv.hpp"

namespace truebearing::debrief_replay_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::error_message;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;

constexpr double kKnot_mps = 1852.0 / 3600.0;
// A minute of latitude at 45 degrees North, and one of longitude there, m (WGS-84).
constexpr double kNorth_m = 1852.2, kEast_m = 1314.2;

// NELSON goes a minute of latitude to the North in ten minutes.
const std::string kNelson =
    "951212 050000.000 NELSON @C 45 00 00.00 N 7 30 00.00 E 000.0 6.0 0\n"
    "951212 051000.000 NELSON @C 45 01 00.00 N 7 30 00.00 E 000.0 6.0 0\n";

Recording read(const std::string& text, const RecordingOptions& options = {}) {
  const TemporaryFolder folder;
  return read_recording(folder.write("log.rep", text), options);
}

std::string error_of(const std::string& text, const RecordingOptions& options = {}) {
  return error_message([&] { read(text, options); });
}

TEST(DebriefReplay, BearingsAreSeenFromTheVesselsTrack) {
  const Recording log = read(";; a comment\n\n" + kNelson +
                             ";NARRATIVE: 951212 050100.000 NELSON nothing seen\n"
                             ";SENSOR: 951212 050000 NELSON @A NULL 30.0 NULL BOW contact 1\r\n"
                             "  ;SENSOR: 951212 050500.500 NELSON @A NULL -13.9 NULL \"BOW ARRAY\" contact 1\n"
                             ";SENSOR: 951212 050600 NELSON @A NULL NULL NULL BOW lost\n"
                             ";SENSOR: 951212 051100 NELSON @A NULL 31.0 NULL BOW too late\n");
  EXPECT_THAT(log.measured, ElementsAre("bearing_deg"));
  EXPECT_THAT(log.line, ElementsAre(6u, 7u, 8u, 9u));
  EXPECT_EQ(log.measurements[0].time_s, 818744400.0) << "12 December 1995, 05:00 UTC";
  EXPECT_EQ(log.measurements[1].time_s, 818744700.5);
  EXPECT_NEAR(log.measurements[0].z[0], radians(30.0), 1e-12);
  EXPECT_NEAR(log.measurements[1].z[0], radians(-13.9), 1e-9);
  EXPECT_NEAR(log.measurements[0].sensor->position_m.norm(), 0.0, 1e-6) << "where the frame has its origin";
  EXPECT_NEAR(log.measurements[1].sensor->position_m.y(), kNorth_m * 300.5 / 600.0, 0.1);
  EXPECT_LT((log.measurements[1].sensor->velocity_mps - Eigen::Vector2d(0.0, 6.0 * kKnot_mps)).norm(), 1e-6);
  EXPECT_TRUE(log.measurements[2].is_missing());
  EXPECT_FALSE(log.measurements[3].sensor) << "no position after it";
  EXPECT_EQ(log.counts.missing, 2);
}

TEST(DebriefReplay, LaterKindsTellFrequenciesRangesAndAccuracies) {
  const Recording second = read(kNelson +
                                ";SENSOR2: 951212 050000 NELSON @B NULL 59.3 300.7 49.96 NULL TOWED c\n"
                                ";SENSOR2: 951212 050100 NELSON @B NULL 59.4 NULL 49.97 2000 TOWED c\n");
  EXPECT_THAT(second.measured, ElementsAre("bearing_deg", "frequency_hz", "range_m"));
  EXPECT_EQ(second.measurements[0].z[1], 49.96);
  EXPECT_NEAR(second.measurements[1].z[2], 2000.0 * 0.9144, 1e-9) << "yards";
  EXPECT_EQ(second.measurements[0].sigma.size(), 0);

  const std::string third = ";SENSOR3: 951212 050000 NELSON @B NULL 59.3 0.5 49.96 0.02 NULL TOWED c\n";
  const Recording accurate = read(kNelson + third);
  EXPECT_THAT(accurate.measured, ElementsAre("bearing_deg", "frequency_hz"));
  EXPECT_NEAR(accurate.measurements[0].sigma[0], radians(0.5), 1e-12);
  EXPECT_EQ(accurate.measurements[0].sigma[1], 0.02);
  const Recording doubtful =
      read(kNelson + third + ";SENSOR3: 951212 050100 NELSON @B NULL 59.3 NULL 49.96 0.02 NULL TOWED c\n");
  EXPECT_EQ(doubtful.measurements[0].sigma.size(), 0) << "one line does not tell it";
  EXPECT_EQ(
      read(kNelson + third + ";SENSOR: 951212 050100 NELSON @B NULL 59.3 900 BOW c\n").measurements[0].sigma.size(), 0)
      << "nobody tells how good a range is";
}

TEST(DebriefReplay, AnAccuracyOfZeroStatesNone) {
  const Recording log = read(kNelson + ";SENSOR3: 951212 050000 NELSON @A NULL 40 0 NULL NULL NULL BOW c\n");
  EXPECT_EQ(log.measurements[0].sigma.size(), 0);
}

// Of a buoy nobody tells how fast it goes, which takes nothing from its bearings.
TEST(DebriefReplay, BearingsDoWithoutTheVelocityOfTheirPlace) {
  const Recording log = read(kNelson + ";SENSOR: 951212 050000 NELSON @A NULL 30.0 NULL BOW c\n" +
                                 ";SENSOR: 951212 050000 BUOY @A 45 00 00 N 7 30 00 E 40.0 NULL BOW c\n",
                             {.target = "BUOY"});
  ASSERT_EQ(log.measurements.size(), 1u);
  EXPECT_FALSE(log.measurements[0].is_missing());
  EXPECT_NEAR(log.measurements[0].z[0], radians(40.0), 1e-9);
}

// Sixty minutes of longitude to the East the meridian is turned by sin(45 deg) of a degree from the frame's.
TEST(DebriefReplay, DirectionsAreTurnedToTheFrame) {
  const Recording log = read(
      "951212 050000 FAST @C 45 00 00 N 7 30 00 E 090.0 6.0 0\n951212 060000 FAST @C 45 00 00 N 8 30 00 E 000.0 6.0 0\n"
      ";SENSOR: 951212 050000 FAST @A NULL 90.0 NULL BOW c\n;SENSOR: 951212 060000 FAST @A NULL 90.0 NULL BOW c\n");
  const double turned_rad = radians(std::sin(radians(45.0)));
  EXPECT_NEAR(log.measurements[0].z[0], radians(90.0), 1e-9);
  EXPECT_NEAR(log.measurements[1].z[0], radians(90.0) - turned_rad, 1e-5);
  const SensorState& last = *log.measurements[1].sensor;
  EXPECT_NEAR(last.position_m.x(), 60.0 * kEast_m, 60.0);
  EXPECT_NEAR(std::atan2(last.velocity_mps.x(), last.velocity_mps.y()), -turned_rad, 1e-5);
}

TEST(DebriefReplay, ASensorMayTellItsOwnPlace) {
  const std::string own = "45 00 30.00 N 7 29 00.00 E";
  const Recording towed =
      read(kNelson + ";SENSOR: 951212 050000 NELSON @A NULL 30 NULL BOW c\n;SENSOR: 951212 050001 NELSON @A " + own +
           " 30 NULL TOWED c\n");
  EXPECT_NEAR(towed.measurements[1].sensor->position_m.x(), -kEast_m, 1.0);
  EXPECT_NEAR(towed.measurements[1].sensor->position_m.y(), 0.5 * kNorth_m, 1.0);
  EXPECT_NEAR(towed.measurements[1].sensor->velocity_mps.y(), 6.0 * kKnot_mps, 1e-4) << "the vessel's";
  const Recording buoy = read(";SENSOR: 951212 050000 BUOY @A " + own + " 30 NULL B c\n");
  EXPECT_FALSE(buoy.measurements[0].is_missing());
  EXPECT_TRUE(buoy.measurements[0].sensor->velocity_mps.isZero(0.0));
}

TEST(DebriefReplay, OneVesselOfSeveralIsChosen) {
  const std::string two = kNelson +
                          "19951212 050000 \"THE OTHER\" @C 45 00 00 N 7 31 00 E 000.0 6.0 0 label of it\n"
                          ";SENSOR: 951212 050000 NELSON @A NULL 30 NULL BOW c\n"
                          ";SENSOR: 951212 050000 \"THE OTHER\" @A NULL 40 NULL BOW c\n";
  EXPECT_THAT(error_of(two),
              AllOf(HasSubstr("log.rep:5: track"), HasSubstr("THE OTHER"), HasSubstr("--track-id NELSON")));
  const Recording other = read(two, {.target = "THE OTHER"});
  ASSERT_EQ(other.measurements.size(), 1u);
  EXPECT_NEAR(other.measurements[0].z[0], radians(40.0), radians(0.02));
}

TEST(DebriefReplay, PositionsAloneAreTracks) {
  std::string text;
  for (int k = 0; k < 25; ++k)
    text += "680101 1200" + std::string(k < 10 ? "0" : "") + std::to_string(k) + " RED @C 45 00 " + std::to_string(k) +
            " S 7 30 00 E 180.0 60.0 0\n";
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.write("track.REP", text);
  EXPECT_TRUE(is_geographic_track(path));
  const GeographicTracks tracks = read_geographic_tracks(path, {.recorded_velocity = true});
  ASSERT_EQ(tracks.recordings.size(), 1u);
  EXPECT_EQ(tracks.names[0], "RED");
  EXPECT_EQ(tracks.recordings[0].measurements[0].time_s, 3092644800.0) << "2068";
  EXPECT_NEAR(tracks.recordings[0].truth[0].x[3][3], -60.0 * kKnot_mps, 1e-9);
  EXPECT_TRUE(check_log(path, {}).is_usable());
}

TEST(DebriefReplay, MistakesAreNamedWithTheirLines) {
  const auto of_line = [](const std::string& line) { return error_of(kNelson + line + "\n"); };
  EXPECT_THAT(of_line("time_s,bearing_deg"), AllOf(HasSubstr("log.rep:3"), HasSubstr("YYMMDD HHMMSS.SSS")));
  EXPECT_THAT(of_line("951312 050000 NELSON @C 45 0 0 N 7 0 0 E 0 0 0"), HasSubstr("951312 050000"));
  EXPECT_THAT(of_line("951212 050000 NELSON @C 45 0 0 X 7 0 0 E 0 0 0"),
              AllOf(HasSubstr("X"), HasSubstr("latitude"), HasSubstr("N or S")));
  EXPECT_THAT(of_line("951212 050000 NELSON @C 91 0 0 N 7 0 0 E 0 0 0"), HasSubstr("[0, 90]"));
  EXPECT_THAT(of_line("951212 050000 NELSON @C 90 0 1 N 7 0 0 E 0 0 0"), HasSubstr("at most 90 degrees"));
  EXPECT_THAT(of_line("951212 050000 NELSON @C 45 61 0 N 7 0 0 E 0 0 0"), HasSubstr("[0, 60]"));
  EXPECT_THAT(of_line("951212 050000 NELSON @C 45 0 0 N 7 0 0 E north 0 0"),
              AllOf(HasSubstr("north"), HasSubstr("course")));
  EXPECT_THAT(of_line("951212 050000 NELSON @C 45 0 0 N 7 0 0 E 0"), HasSubstr("ends before its speed"));
  EXPECT_THAT(of_line(";SENSOR: 951212 050000 NELSON @A NULL 400 NULL BOW c"), HasSubstr("[-360, 360]"));
  EXPECT_THAT(of_line(";SENSOR2: 951212 050000 NELSON @A NULL 40 NULL"), HasSubstr("ends before its frequency"));
  EXPECT_THAT(of_line(";SENSOR: 951212 050000 RODNEY @A NULL 40 NULL BOW c"),
              AllOf(HasSubstr("log.rep:3"), HasSubstr("RODNEY"), HasSubstr("no positions")));
  EXPECT_THAT(error_of(""), HasSubstr("globe"));
  EXPECT_THAT(error_message([] { read_recording("no such.rep"); }), HasSubstr("cannot be opened"));
}

TEST(DebriefReplay, CheckSaysWhatItHolds) {
  const LogReport report = check_log(TRUEBEARING_SOURCE_DIR "/tests/recording/logs/passive.rep", {});
  EXPECT_TRUE(report.is_usable());
  EXPECT_EQ(report.rows, 80u);
  EXPECT_EQ(report.targets, 1u);
  EXPECT_EQ(report.median_period_s, 30.0);
  EXPECT_THAT(report.oddities, IsEmpty());
}

}  // namespace
}  // namespace truebearing::debrief_replay_test
