// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/geographic_track.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fmt/format.h>
#include <map>
#include <sstream>

#include "tests/support/error_message.hpp"
#include "tests/support/real_data.hpp"
#include "tests/support/temporary_folder.hpp"

namespace truebearing::geographic_track_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::error_message;
using ::testing::HasSubstr;

// On this circle of latitude a degree of latitude is 111.1 km and one of longitude 78.8 km long (WGS-84).
constexpr double kLatitude_deg = 45.0;
constexpr double kStep_deg = 0.001;
constexpr double kStep_m = 111.132;

GeographicTracks read(const std::string& text, const GeographicTrackOptions& options = {}) {
  std::istringstream stream(text);
  return read_geographic_tracks(stream, "track.csv", options);
}

std::string error_of(const std::string& text) {
  return error_message([&] { read(text); });
}

std::string row(double time_s, double steps_north) {
  return fmt::format("{},{},7.5\n", time_s, kLatitude_deg + kStep_deg * (steps_north - 15.0));
}

// Thirty-one rows, one step to the North each second; the rows in `instead` take the place of the sample of that time.
std::string northbound(const std::map<int, std::string>& instead = {}) {
  std::string text = "time_s,latitude_deg,longitude_deg\n";
  for (int k = 0; k <= 30; ++k) text += instead.contains(k) ? instead.at(k) : row(k, k);
  return text;
}

bool is_scored(const Recording& recording, std::size_t k) {
  return recording.truth[0].x[k].allFinite();
}

TEST(GeographicTrack, PositionsAreMetresFromTheMiddleOfTheArea) {
  const GeographicTracks tracks = read(northbound());
  ASSERT_EQ(tracks.recordings.size(), 1u);
  const Recording& recording = tracks.recordings[0];
  EXPECT_THAT(recording.measured, ElementsAre("east_m", "north_m"));
  EXPECT_EQ(recording.truth_space, &plane_space());
  ASSERT_EQ(recording.measurements.size(), 31u);
  EXPECT_NEAR(recording.measurements[15].z.norm(), 0.0, 1e-6);
  EXPECT_NEAR(recording.measurements[30].z(1), 15.0 * kStep_m, 0.1);
  EXPECT_NEAR(recording.measurements[0].z(1), -15.0 * kStep_m, 0.1);
  EXPECT_NEAR(recording.measurements[30].z(0), 0.0, 1e-6);
  EXPECT_EQ(recording.measurements[30].sigma.size(), 0);
  for (std::size_t k = 0; k < 31; ++k) {
    EXPECT_EQ(recording.truth[0].x[k].head<2>(), recording.measurements[k].z);
    EXPECT_NEAR(recording.truth[0].x[k](2), 0.0, 1e-6);
    EXPECT_NEAR(recording.truth[0].x[k](3), kStep_m, 0.01);
  }
}

// The plane that touches the Earth in the middle of the track is above it elsewhere.
TEST(GeographicTrack, AltitudesCountInSpace) {
  std::string text = "time_s,latitude_deg,longitude_deg,altitude_ft\n";
  for (int k = 0; k <= 30; ++k)
    text += fmt::format("{},{},7.5,{}\n", k, kLatitude_deg + kStep_deg * (k - 15.0),
                        k == 4 ? "" : fmt::format("{}", 1000.0 + 10.0 * k));
  const GeographicTracks tracks = read(text, {.in_space = true});
  EXPECT_TRUE(tracks.has_altitude);
  const Recording& recording = tracks.recordings.at(0);
  EXPECT_THAT(recording.measured, ElementsAre("east_m", "north_m", "up_m"));
  EXPECT_EQ(recording.truth_space, &space_space());
  EXPECT_NEAR(recording.measurements[15].z[2], 1150.0 * 0.3048, 1e-6);
  EXPECT_NEAR(recording.measurements[30].z[2], 1300.0 * 0.3048 - std::pow(15.0 * kStep_m, 2.0) / (2.0 * 6.37e6), 0.01);
  EXPECT_NEAR(recording.measurements[30].z[1], 15.0 * kStep_m * (1.0 + 396.0 / 6.37e6), 0.1);
  EXPECT_NEAR(recording.truth[0].x[15][5], 3.048, 1e-3);
  EXPECT_NEAR(recording.truth[0].x[15][4], kStep_m, 0.02);
  EXPECT_TRUE(recording.measurements[4].is_missing()) << "of unknown height";
  EXPECT_EQ(recording.counts.missing, 1);
  const GeographicTracks plane = read(text);
  EXPECT_EQ(plane.recordings.at(0).measurements[4].z.size(), 2);
  EXPECT_EQ(plane.recordings.at(0).counts.missing, 0);
  EXPECT_THAT(error_message([] { read(northbound(), {.in_space = true}); }),
              AllOf(HasSubstr("has no altitude"), HasSubstr("altitude_m")));
}

// What the target says of its course and speed is of the plane; how fast it climbs is told by its heights.
TEST(GeographicTrack, RecordedVelocityInSpaceIsAlongTheGround) {
  std::string text = "time_s,latitude_deg,longitude_deg,altitude_m,groundspeed_kn,track_deg\n";
  for (int k = 0; k <= 30; ++k)
    text += fmt::format("{},{},7.5,{},100,90\n", k, kLatitude_deg + kStep_deg * (k - 15.0), 5 * k);
  const Recording recording = read(text, {.recorded_velocity = true, .in_space = true}).recordings.at(0);
  const BoundedVector& x = recording.truth[0].x[15];
  EXPECT_NEAR(x[3], 100.0 * 1852.0 / 3600.0, 1e-9);
  EXPECT_NEAR(x[4], 0.0, 1e-9);
  EXPECT_NEAR(x[5], 5.0, 1e-3);
}

TEST(GeographicTrack, TheDateLineIsNoEdge) {
  std::string text = "time_s,latitude_deg,longitude_deg\n";
  for (int k = 0; k <= 30; ++k)
    text += fmt::format("{},45,{}\n", k, k <= 15 ? 179.985 + k * 0.001 : -180.015 + k * 0.001);
  const Recording recording = read(text).recordings.at(0);
  for (std::size_t k = 0; k < 31; ++k) EXPECT_NEAR(recording.truth[0].x[k](2), 78.85, 0.01) << k;
  EXPECT_NEAR(recording.measurements[30].z(0), 15.0 * 78.85, 0.2);
}

TEST(GeographicTrack, OtherColumnsArePassedOver) {
  std::string text = "call_sign,longitude_deg,time_s,track_deg,latitude_deg\n";
  for (int k = 0; k < 20; ++k) text += fmt::format("AB{0},7.5,{0},270,{1}\n", k, kLatitude_deg + k * kStep_deg);
  EXPECT_NEAR(read(text).recordings.at(0).truth[0].x[10](3), kStep_m, 0.01) << "not the track angle of the file";
}

TEST(GeographicTrack, RecordedVelocityIsTheTruthOnRequestWhereTheFileHasIt) {
  std::string text = "time_s,latitude_deg,longitude_deg,groundspeed_kn,track_deg\n";
  for (int k = 0; k <= 30; ++k)
    text += fmt::format("{},{},7.5,{},90\n", k, kLatitude_deg + kStep_deg * k, k == 12 ? "" : "100");
  const Recording recording = read(text, {.recorded_velocity = true}).recordings.at(0);
  EXPECT_NEAR(recording.truth[0].x[10](2), 100.0 * 1852.0 / 3600.0, 1e-9) << "East, in m/s";
  EXPECT_NEAR(recording.truth[0].x[10](3), 0.0, 1e-9);
  EXPECT_FALSE(is_scored(recording, 12));
  EXPECT_NEAR(read(northbound(), {.recorded_velocity = true}).recordings.at(0).truth[0].x[10](3), kStep_m, 0.01)
      << "the slope, where the file has no velocity";
}

TEST(GeographicTrack, PositionThatIsRepeatedUntilAnotherComesIsNoGlitch) {
  std::map<int, std::string> held;
  for (int k = 0; k <= 30; ++k) held[k] = row(k, k - k % 5);  // a new one every 5 s
  EXPECT_EQ(read(northbound(held), {.max_speed_mps = 150.0}).recordings.at(0).counts.glitches, 0);
}

TEST(GeographicTrack, WhatAisSendsForNotAvailableIsMissing) {
  const Recording recording = read(northbound({{5, "5,91,181\n"}})).recordings.at(0);
  EXPECT_EQ(recording.counts.missing, 1);
  EXPECT_TRUE(recording.measurements[5].is_missing());
}

TEST(GeographicTrack, VelocityThatNoTargetHasIsNotBelieved) {
  std::string text = "time_s,latitude_deg,longitude_deg,speed_kn,course_deg\n";
  for (int k = 0; k <= 30; ++k)
    text += fmt::format("{},{},7.5,{}\n", k, kLatitude_deg + kStep_deg * k,
                        k == 12   ? "9999,90"
                        : k == 20 ? "102.3,360.0"
                                  : "100,90");
  const Recording recording = read(text, {.max_speed_mps = 400.0, .recorded_velocity = true}).recordings.at(0);
  EXPECT_EQ(recording.counts.wrong_velocities, 1) << "AIS's \"not available\" is missing, not wrong";
  EXPECT_FALSE(is_scored(recording, 12));
  EXPECT_FALSE(is_scored(recording, 20));
  EXPECT_TRUE(is_scored(recording, 15));
}

TEST(GeographicTrack, GlitchIsMissingAndCounted) {
  const std::string text = northbound({{10, row(10, 14)}, {11, row(11, 15)}});
  const Recording recording = read(text, {.max_speed_mps = 150.0}).recordings.at(0);
  EXPECT_EQ(recording.counts.glitches, 2);
  EXPECT_EQ(recording.counts.missing, 2);
  for (const std::size_t k : {10u, 11u}) {
    EXPECT_TRUE(recording.measurements[k].is_missing());
    EXPECT_TRUE(recording.truth[0].x[k].array().isNaN().all());
  }
  for (const std::size_t k : {8u, 9u, 12u, 13u}) EXPECT_NEAR(recording.truth[0].x[k](3), kStep_m, 0.01) << k;
  EXPECT_EQ(read(text).recordings.at(0).counts.glitches, 0) << "everything is believed unless a limit is given";
}

TEST(GeographicTrack, FirstPositionThatIsWrongDoesNotLockOutTheRest) {
  const Recording recording = read(northbound({{0, row(0, -5)}}), {.max_speed_mps = 180.0}).recordings.at(0);
  EXPECT_EQ(recording.counts.glitches, 1) << "it alone, not those that disagree with it";
  EXPECT_TRUE(recording.measurements[0].is_missing());
  EXPECT_FALSE(recording.measurements[1].is_missing());
  EXPECT_FALSE(recording.measurements[30].is_missing());
}

// East of North at 5 s and 200 m/s, as an aircraft does.
std::string aircraft(int wrong, double east_m, double north_m) {
  std::string text = "time_s,latitude_deg,longitude_deg\n";
  for (int k = 0; k < 40; ++k) {
    const double along_m = 1000.0 * k, off = k == wrong ? 1.0 : 0.0;
    text += fmt::format("{},{:.7f},{:.7f}\n", 5 * k, kLatitude_deg + (0.8 * along_m + off * north_m) / 111132.0,
                        7.5 + (0.6 * along_m + off * east_m) / 78847.0);
  }
  return text;
}

TEST(GeographicTrack, WrongPositionIsTheOneThatGoesWhereverItLies) {
  constexpr double kReach_m = 340.0 * 5.0, kStride_m = 1000.0;
  int told = 0;
  for (const int wrong : {0, 1, 20, 38, 39})
    for (double distance_m = 1000.0; distance_m <= 10'000.0; distance_m += 500.0)
      for (double direction_deg = 0.0; direction_deg < 360.0; direction_deg += 30.0) {
        const double east_m = distance_m * std::sin(direction_deg * 0.017453292519943295);
        const double north_m = distance_m * std::cos(direction_deg * 0.017453292519943295);
        // A first one from which the next can be reached is no glitch to a limit of speed; a later one that can be reached
        // from the fix before may stand in place of the next.
        const bool from_before = std::hypot(0.6 * kStride_m + east_m, 0.8 * kStride_m + north_m) < kReach_m + 50.0;
        const bool to_after = std::hypot(0.6 * kStride_m - east_m, 0.8 * kStride_m - north_m) < kReach_m + 50.0;
        if (wrong == 0 ? to_after : from_before) continue;
        const Recording recording = read(aircraft(wrong, east_m, north_m), {.max_speed_mps = 340.0}).recordings.at(0);
        EXPECT_EQ(recording.counts.glitches, 1) << wrong << ": " << distance_m << " m, " << direction_deg << " deg";
        EXPECT_TRUE(recording.measurements[static_cast<std::size_t>(wrong)].is_missing())
            << wrong << ": " << distance_m << " m, " << direction_deg << " deg";
        ++told;
      }
  EXPECT_GT(told, 900);
}

TEST(GeographicTrack, StepAfterAGapIsNotScoredAndVelocityDoesNotReachAcross) {
  std::string text = "time_s,latitude_deg,longitude_deg\n";
  for (int k = 0; k <= 30; ++k) text += row(k <= 14 ? k : k + 9, k);  // ten seconds for the step from 14 to 15
  const Recording recording = read(text, {.max_gap_periods = 3.0}).recordings.at(0);
  EXPECT_TRUE(is_scored(recording, 14));
  EXPECT_FALSE(is_scored(recording, 15));
  EXPECT_FALSE(recording.measurements[15].is_missing()) << "measured all the same";
  for (const std::size_t k : {13u, 14u, 16u, 17u}) EXPECT_NEAR(recording.truth[0].x[k](3), kStep_m, 0.01) << k;
  const Recording all = read(text).recordings.at(0);
  EXPECT_TRUE(is_scored(all, 15));
  EXPECT_LT(all.truth[0].x[15](3), 0.5 * kStep_m);
}

TEST(GeographicTrack, GapOfMissingRowsIsAGapToo) {
  std::map<int, std::string> instead;
  for (int k = 10; k < 14; ++k) instead[k] = fmt::format("{},,\n", k);
  const Recording recording = read(northbound(instead), {.max_gap_periods = 3.0}).recordings.at(0);
  EXPECT_FALSE(is_scored(recording, 14));
  EXPECT_TRUE(is_scored(recording, 15));
}

TEST(GeographicTrack, SlowStepsAreNotScored) {
  std::map<int, std::string> instead;
  for (int k = 20; k <= 30; ++k) instead[k] = row(k, 19);
  const Recording recording = read(northbound(instead), {.min_speed_mps = 20.0}).recordings.at(0);
  EXPECT_TRUE(is_scored(recording, 18));
  EXPECT_FALSE(is_scored(recording, 25));
  EXPECT_FALSE(recording.measurements[25].is_missing());
  EXPECT_EQ(recording.counts.missing, 0);
}

TEST(GeographicTrack, EmptyCellsAreMissingAndCounted) {
  const Recording recording =
      read(northbound({{3, "3,,7.5\n"}, {4, "4,45,nan\n"}, {5, "5,inf,7.5\n"}})).recordings.at(0);
  EXPECT_EQ(recording.counts.missing, 3);
  EXPECT_EQ(recording.counts.glitches, 0);
  EXPECT_TRUE(recording.measurements[4].z.array().isNaN().all());
  EXPECT_FALSE(is_scored(recording, 4));
}

TEST(GeographicTrack, RepeatedRowsAreDroppedAndCounted) {
  const Recording recording = read(northbound({{3, row(3, 3) + row(3, 3)}, {4, "4,,\n4,,\n"}})).recordings.at(0);
  EXPECT_EQ(recording.measurements.size(), 31u);
  EXPECT_EQ(recording.counts.repeated, 2);
}

std::string two_vessels(const char* column) {
  std::string text = fmt::format("time_s,{},latitude_deg,longitude_deg\n", column);
  for (int k = 0; k < 25; ++k) {
    text += fmt::format("{},21,{},7.5\n", k + 0.5, kLatitude_deg + k * kStep_deg);
    if (k < 22) text += fmt::format("{},5,{},8.5\n", k + 0.25 * (k % 3), kLatitude_deg - k * kStep_deg);
  }
  return text + "100,7,45,7.5\n";
}

TEST(GeographicTrack, InterleavedTargetsAreTrackedApart) {
  for (const char* column : {"vessel", "flight", "track", "mmsi", "icao24", "callsign"}) {
    const GeographicTracks tracks = read(two_vessels(column));
    ASSERT_EQ(tracks.recordings.size(), 2u) << column;
    EXPECT_EQ(tracks.recordings[0].measurements.size(), 25u);
    EXPECT_EQ(tracks.recordings[1].measurements.size(), 22u);
    EXPECT_NEAR(tracks.recordings[0].truth[0].x[10](3), kStep_m, 0.01);
    EXPECT_LT(tracks.recordings[1].truth[0].x[10](3), -0.9 * kStep_m);
    EXPECT_LT(tracks.recordings[1].measurements[0].z.norm(), 2000.0) << "a middle of its own";
    EXPECT_EQ(tracks.left_out, 1) << "one row is no track";
  }
}

TEST(GeographicTrack, TargetsAreTextsInOneColumn) {
  EXPECT_THAT(error_of("time_s,latitude_deg,longitude_deg,vessel,track\n"), HasSubstr("vessel and track"));
  for (const char* cell : {"", "1.5", "NA"})
    EXPECT_THAT(error_of(fmt::format("time_s,latitude_deg,longitude_deg,vessel\n0,45,7,{}\n", cell)),
                AllOf(HasSubstr("track.csv:2: vessel"), HasSubstr("integer")));
}

TEST(GeographicTrack, NamesOfTargetsAreNotNumbers) {
  std::string text = "time_s,icao24,latitude_deg,longitude_deg\n";
  for (int k = 0; k < 25; ++k)
    for (const char* name : {"3e5", "300000", "4b1a2c", "40001e", "1e300", "4294967297"})
      text += fmt::format("{},{},{},7.5\n", k, name, kLatitude_deg + k * kStep_deg);
  EXPECT_THAT(read(text).names, ElementsAre("3e5", "300000", "4b1a2c", "40001e", "1e300", "4294967297"));
  std::istringstream stream(text);
  const GeographicTracks one = read_geographic_tracks(stream, "track.csv", {}, {.target = "300000"});
  EXPECT_THAT(one.names, ElementsAre("300000"));
  std::istringstream again(text);
  EXPECT_THAT(error_message([&] { read_geographic_tracks(again, "track.csv", {}, {.target = "300001"}); }),
              AllOf(HasSubstr("no track \"300001\""), HasSubstr("4b1a2c")));
}

TEST(GeographicTrack, ManyTargetsAreReadInLinearTime) {
  std::string text = "time_s,vessel,latitude_deg,longitude_deg\n";
  for (int k = 0; k < 200'000; ++k) text += fmt::format("0,{},45,7.5\n", k);
  for (int k = 0; k < 20; ++k) text += fmt::format("{},a,{},7.5\n", k, kLatitude_deg + k * kStep_deg);
  EXPECT_EQ(read(text).left_out, 200'000);
}

TEST(GeographicTrack, PositionsAtZeroZeroAreNoFix) {
  const GeographicTracks tracks = read(northbound({{0, "0,0,0\n"}, {7, "7,0.0,-0.0\n"}}));
  EXPECT_EQ(tracks.null_island, 2u);
  EXPECT_TRUE(tracks.recordings.at(0).measurements[0].is_missing());
  std::string near = "time_s,latitude_deg,longitude_deg\n";
  for (int k = -10; k <= 10; ++k) near += fmt::format("{},{},0\n", k, k * kStep_deg);
  EXPECT_EQ(read(near).null_island, 0u) << "it passed there";
}

TEST(GeographicTrack, LateRowsAreSortedWithinTheWindow) {
  const std::string text = northbound({{5, row(6, 6)}, {6, row(5, 5)}});
  EXPECT_THAT(error_of(text), AllOf(HasSubstr("track.csv:8: time_s"), HasSubstr("--sort-window 1")));
  std::istringstream stream(text);
  const GeographicTracks tracks = read_geographic_tracks(stream, "track.csv", {}, {.sort_window_s = 2.0});
  EXPECT_EQ(tracks.late, 1u);
  EXPECT_EQ(tracks.recordings.at(0).measurements[5].time_s, 5.0);
}

TEST(GeographicTrack, WindowThatIsNamedIsWhatTheWholeFileNeeds) {
  const testing::TemporaryFolder folder;
  std::string text = "time_s,latitude_deg,longitude_deg\n";
  for (int k = 30; k >= 0; --k) text += row(k, k);
  const auto path = folder.write("reversed.csv", text);
  EXPECT_THAT(error_message([&] { read_geographic_tracks(path, {}); }), HasSubstr("--sort-window 30 "));
  EXPECT_EQ(read_geographic_tracks(path, {}, {.sort_window_s = 30.0}).late, 30u);
}

TEST(GeographicTrack, AnglesMayBeRadians) {
  std::string text = "time_ms,latitude_rad,longitude_rad\n";
  for (int k = 0; k <= 30; ++k)
    text += fmt::format("{},{},0.13\n", 1000 * k, (kLatitude_deg + kStep_deg * k) * 0.017453292519943295);
  EXPECT_NEAR(read(text).recordings.at(0).truth[0].x[10](3), kStep_m, 0.01);
}

TEST(GeographicTrack, TooFewRowsAreNoTrack) {
  std::string text = "time_s,latitude_deg,longitude_deg\n";
  for (int k = 0; k < 19; ++k) text += row(k, k);
  EXPECT_THAT(error_of(text), AllOf(HasSubstr("track.csv"), HasSubstr("20 usable rows")));
  EXPECT_EQ(error_of(text + row(19, 19)), "no error");
  EXPECT_THAT(error_of("time_s,latitude_deg,longitude_deg\n"), HasSubstr("20 usable rows"));
}

TEST(GeographicTrack, RowsThatCannotBeAreErrors) {
  EXPECT_THAT(error_of(northbound({{5, row(3.5, 5)}})),
              AllOf(HasSubstr("track.csv:7: time_s"), HasSubstr("3.5"), HasSubstr("4")));
  EXPECT_THAT(error_of(northbound({{5, ",45,7.5\n"}})), HasSubstr("track.csv:7: time_s"));
  for (const char* latitude : {"90.1", "-91"})
    EXPECT_THAT(error_of(northbound({{5, fmt::format("5,{},7.5\n", latitude)}})),
                AllOf(HasSubstr("track.csv:7: latitude_deg"), HasSubstr(latitude), HasSubstr("[-90, 90]")));
  for (const char* longitude : {"360.5", "-181"})
    EXPECT_THAT(error_of(northbound({{5, fmt::format("5,45,{}\n", longitude)}})),
                AllOf(HasSubstr("track.csv:7: longitude_deg"), HasSubstr(longitude)));
  EXPECT_THAT(error_of(northbound({{5, "5,north,7.5\n"}})), AllOf(HasSubstr("track.csv:7"), HasSubstr("north")));
  EXPECT_THAT(error_of("time_s,latitude_deg\n0,45\n"), HasSubstr("longitude_deg"));
}

TEST(GeographicTrack, RecordedFlightIsCleanedOfItsGlitches) {
  const std::filesystem::path path = testing::real_data("flight_belevingsvlucht.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  EXPECT_TRUE(is_geographic_track(path));
  const Recording flight =
      read_geographic_tracks(path, {.max_speed_mps = 400.0, .min_speed_mps = 20.0, .max_gap_periods = 3.0})
          .recordings.at(0);
  EXPECT_GT(flight.counts.glitches, 0);
  EXPECT_LT(flight.counts.glitches, 320) << "two per cent of the rows";
  const Measurement* last = nullptr;
  double since_s = 0.0;  // the last position is repeated
  for (std::size_t k = 0; k < flight.measurements.size(); ++k) {
    const Measurement& measurement = flight.measurements[k];
    const BoundedVector& x = flight.truth[0].x[k];
    EXPECT_TRUE(!x.allFinite() || x.tail<2>().norm() >= 20.0);
    if (measurement.is_missing()) continue;
    if (last) {
      EXPECT_LE((measurement.z - last->z).norm(), 400.0 * (measurement.time_s - since_s));
    }
    if (!last || measurement.z != last->z) since_s = measurement.time_s;
    last = &measurement;
  }
}

// It climbs to 10 700 feet above the ellipsoid, which curves away under the plane.
TEST(GeographicTrack, RecordedFlightHasItsHeights) {
  const std::filesystem::path path = testing::real_data("flight_ajaccio.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  const Recording flight = read_geographic_tracks(path, {.max_speed_mps = 400.0, .in_space = true}).recordings.at(0);
  double highest_m = 0.0, fastest_mps = 0.0;
  for (const BoundedVector& x : flight.truth[0].x) {
    highest_m = std::fmax(highest_m, x[2] + x.head<2>().squaredNorm() / (2.0 * 6.37e6));
    fastest_mps = std::fmax(fastest_mps, std::abs(x[5]));
  }
  EXPECT_NEAR(highest_m, 10700.0 * 0.3048, 10.0);
  EXPECT_LT(fastest_mps, 25.0);
  EXPECT_EQ(flight.counts.missing, 0);
}

TEST(GeographicTrack, RecordedVesselsAreToldApart) {
  const std::filesystem::path path = testing::real_data("ais_solent.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  const GeographicTracks tracks = read_geographic_tracks(path, {.max_speed_mps = 30.0});
  EXPECT_GT(tracks.recordings.size(), 10u);
  for (const Recording& vessel : tracks.recordings)
    for (const Measurement& measurement : vessel.measurements)
      EXPECT_TRUE(measurement.is_missing() || measurement.z.norm() < 100e3);
}

}  // namespace
}  // namespace truebearing::geographic_track_test
