// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/bearings_of_track.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/support/error_message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing::bearings_of_track_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;

BearingsOnlyParameters parameters() {
  BearingsOnlyParameters made;
  made.duration_s = 300.0;
  made.own_ship.speed_mps = 5.0;
  made.range_m = 4000.0;
  made.bearing_deg = 90.0;
  made.sensor.sigma_rad = radians(1.0);
  return made;
}

// A target that sails North at 3 m/s, seen at irregular times that begin at 1000 s; its first state is unknown.
Recording track() {
  Recording made = empty_bearings({});
  double time_s = 1000.0;
  for (int k = 0; k < 60; ++k, time_s += 5.0 + k % 3) {
    made.measurements.emplace_back().time_s = time_s;
    Eigen::Vector4d x(-700.0, 3.0 * time_s, 0.0, 3.0);
    if (k == 0 || k == 20) x[0] = std::nan("");
    made.truth[0].x.emplace_back(x);
  }
  return made;
}

TEST(BearingsOfTrack, TargetSailsTheTrackFromTheScenariosPlace) {
  const Recording from = track();
  const Recording recording = BearingsOfTrack(from, 0.0, parameters()).simulate({});
  ASSERT_EQ(recording.measurements.front().time_s, 0.0);
  EXPECT_TRUE(recording.truth[0].x[0].isApprox(Eigen::Vector4d(4000.0, 0.0, 0.0, 3.0), 1e-9));
  double squares = 0.0;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const Measurement& measurement = recording.measurements[k];
    EXPECT_NEAR(measurement.time_s, from.measurements[k + 1].time_s - from.measurements[1].time_s, 1e-9);
    EXPECT_LE(measurement.time_s, 300.0);
    EXPECT_NEAR(measurement.sensor->position_m.y(), 5.0 * measurement.time_s, 1e-9) << "own ship is the scenario's";
    if (k == 19) {
      EXPECT_TRUE(measurement.is_missing()) << "nobody knows where the target was";
      continue;
    }
    const Eigen::Vector4d x = recording.truth[0].x[k];
    EXPECT_NEAR(x[1], 3.0 * measurement.time_s, 1e-6);
    const Eigen::Vector2d offset = x.head<2>() - measurement.sensor->position_m;
    const double error = measurement.z[0] - std::atan2(offset.x(), offset.y());
    squares += error * error / (radians(1.0) * radians(1.0));
  }
  const double n = static_cast<double>(recording.measurements.size()) - 1.0;
  EXPECT_NEAR(squares / n, 1.0, 4.0 * std::sqrt(2.0 / n)) << "four standard errors";
  EXPECT_EQ(recording.counts.missing, 1);
}

TEST(BearingsOfTrack, ASourceIsHeardToo) {
  BearingsOnlyParameters with_source = parameters();
  with_source.sensor.frequency_sigma_hz = 1e-9;
  with_source.source = SourceParameters{.frequency_hz = 100.0, .changes = {}};
  with_source.source->changes.push_back({.time_s = 150.0, .hz = 0.5});
  const BearingsOfTrack scenario(track(), 0.0, with_source);
  EXPECT_EQ(scenario.truth_space(), plane_frequency_space());
  const Recording recording = scenario.simulate({});
  EXPECT_EQ(recording.measured.back(), "frequency_hz");
  EXPECT_EQ(recording.counts.missing, 1);
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const Measurement& measurement = recording.measurements[k];
    const BoundedVector& x = recording.truth[0].x[k];
    ASSERT_EQ(x.size(), 5);
    EXPECT_EQ(x[4], measurement.time_s < 150.0 ? 100.0 : 100.5);
    EXPECT_EQ(std::isnan(measurement.z[1]), k == 19);
    if (k == 19) continue;
    const Eigen::Vector2d u = (x.head<2>() - measurement.sensor->position_m).normalized();
    const double v_r = u.dot(x.segment<2>(2) - measurement.sensor->velocity_mps);
    EXPECT_NEAR(measurement.z[1], x[4] * (1.0 - v_r / 1500.0), 1e-7);
  }
}

TEST(BearingsOfTrack, BeginsWhereItIsToldTo) {
  const Recording recording = BearingsOfTrack(track(), 1100.0, parameters()).simulate({});
  EXPECT_EQ(recording.measurements.front().time_s, 0.0);
  EXPECT_TRUE(recording.truth[0].x[0].isApprox(Eigen::Vector4d(4000.0, 0.0, 0.0, 3.0), 1e-9));
  EXPECT_THAT(error_message([] { BearingsOfTrack(track(), 1e6, parameters()); }), HasSubstr("no known position"));
}

TEST(BearingsOfTrack, RunsDifferInTheirNoise) {
  const BearingsOfTrack scenario(track(), 0.0, parameters());
  EXPECT_EQ(scenario.simulate({}).measurements[3].z, scenario.simulate({}).measurements[3].z);
  EXPECT_NE(scenario.simulate({.run = 1}).measurements[3].z, scenario.simulate({}).measurements[3].z);
}

TEST(BearingsOfTrack, NeedsATruthInThePlane) {
  Recording line = track();
  line.truth_space = &line_space();
  EXPECT_THAT(error_message([&] { BearingsOfTrack(line, 0.0, parameters()); }), HasSubstr("in the plane"));
}

TEST(ReadTargetTrack, ChoosesAmongVesselsByTheirNumber) {
  const testing::TemporaryFolder folder;
  std::ofstream file(folder.path() / "ais.csv");
  file.precision(12);
  file << "time_s,vessel,latitude_deg,longitude_deg\n";
  for (int k = 0; k < 30; ++k)
    for (const int vessel : {7, 12}) file << 10 * k << ',' << vessel << ',' << 50.0 + 1e-3 * k / vessel << ",-1.0\n";
  file.close();
  const auto path = folder.path() / "ais.csv";
  const double step_m = 111230.0 * 1e-3 / 12.0;
  const Recording chosen = read_target_track(path, {.target = "12"});
  EXPECT_NEAR(chosen.truth[0].x[1][1] - chosen.truth[0].x[0][1], step_m, 0.01 * step_m);
  EXPECT_THAT(error_message([&] { read_target_track(path); }), AllOf(HasSubstr("2 tracks"), HasSubstr("7, 12")));
  EXPECT_THAT(error_message([&] { read_target_track(path, {.target = "8"}); }),
              AllOf(HasSubstr("no track \"8\""), HasSubstr("7, 12")));
}

TEST(ReadTargetTrack, TakesALogWithItsTruth) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder.path() / "log.csv")
      << "time_s,bearing_deg,truth_east_m,truth_north_m\n0,1,10,20\n1,2,12,21\n2,3,14,22\n";
  const Recording read = read_target_track(folder.path() / "log.csv");
  EXPECT_NEAR(read.truth[0].x[1][2], 2.0, 1e-9);
  EXPECT_THAT(error_message([&] { read_target_track(folder.path() / "log.csv", {.target = "3"}); }),
              HasSubstr("one track"));
}

}  // namespace
}  // namespace truebearing::bearings_of_track_test
