// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/recording_csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <sstream>
#include <streambuf>
#include <utility>
#include <vector>

#include "tests/support/error_message.hpp"
#include "tests/support/real_data.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing::recording_csv_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::error_message;
using ::testing::HasSubstr;

Recording read(const std::string& text) {
  std::istringstream stream(text);
  return read_recording(stream, "log.csv");
}

std::string error_of(const std::string& text) {
  return error_message([&] { read(text); });
}

TEST(RecordingCsv, ReadsTimesAndMeasurements) {
  const Recording log = read("position_m,time_s\n10,1\n11.5,2.5\n");
  EXPECT_THAT(log.measured, ElementsAre("position_m"));
  ASSERT_EQ(log.measurements.size(), 2u);
  EXPECT_EQ(log.measurements[1].time_s, 2.5);
  EXPECT_EQ(log.measurements[1].z(0), 11.5);
  EXPECT_EQ(log.measurements[1].sigma.size(), 0);
  EXPECT_FALSE(log.measurements[1].sensor);
  EXPECT_EQ(log.truth_space, nullptr);
  EXPECT_TRUE(log.truth.empty());
}

TEST(RecordingCsv, AnglesAreRadiansInside) {
  const Recording log = read("time_s,bearing_deg,bearing_sigma_deg,frequency_hz,frequency_sigma_hz\n0,90,2,300,0.5\n");
  EXPECT_THAT(log.measured, ElementsAre("bearing_deg", "frequency_hz"));
  EXPECT_DOUBLE_EQ(log.measurements[0].z(0), kPi / 2.0);
  EXPECT_DOUBLE_EQ(log.measurements[0].sigma(0), radians(2.0));
  EXPECT_EQ(log.measurements[0].z(1), 300.0);
  EXPECT_EQ(log.measurements[0].sigma(1), 0.5);
}

TEST(RecordingCsv, ReadsWhatIsMeasuredInSpace) {
  const Recording radar = read(
      "time_s,range_km,bearing_deg,elevation_deg,range_rate_kn,truth_east_m,truth_north_m,truth_altitude_m\n"
      "0,5,90,30,36,4000,0,2500\n");
  EXPECT_THAT(radar.measured, ElementsAre("range_m", "bearing_deg", "elevation_deg", "range_rate_mps"));
  EXPECT_NEAR(radar.measurements[0].z[2], radians(30.0), 1e-12);
  EXPECT_NEAR(radar.measurements[0].z[3], 36.0 * 1852.0 / 3600.0, 1e-9);
  EXPECT_EQ(radar.truth_space, &space_space());
  EXPECT_EQ(radar.truth[0].x[0][2], 2500.0);

  RecordingOptions options;
  options.measured = {"east_m", "north_m", "up_m"};
  std::istringstream stream(
      "time_s,east_m,north_m,altitude_m,altitude_sigma_m,east_sigma_m,north_sigma_m\n0,1,2,3,6,4,5\n");
  const Recording wanted = read_recording(stream, "log.csv", options);
  EXPECT_EQ(wanted.measurements[0].z, BoundedVector(Eigen::Vector3d(1, 2, 3)));
  EXPECT_EQ(wanted.measurements[0].sigma, BoundedVector(Eigen::Vector3d(4, 5, 6)));
  EXPECT_THAT(read("time_s,east_m,north_m,altitude_m\n0,1,2,3\n").measured, ElementsAre("east_m", "north_m"));
}

TEST(RecordingCsv, OwnShipMayBePositionOrPositionAndVelocity) {
  const std::string header = "time_s,bearing_deg,sensor_east_m,sensor_north_m";
  const Recording position = read(header + "\n0,90,5,6\n");
  EXPECT_EQ(position.measurements[0].sensor->position_m, Eigen::Vector2d(5, 6));
  EXPECT_EQ(position.measurements[0].sensor->velocity_mps, Eigen::Vector2d::Zero());
  const Recording both = read(header + ",sensor_east_mps,sensor_north_mps\n0,90,5,6,-1,2\n");
  EXPECT_EQ(both.measurements[0].sensor->velocity_mps, Eigen::Vector2d(-1, 2));
  EXPECT_THAT(error_of("time_s,bearing_deg,sensor_east_m\n0,90,5\n"), HasSubstr("own-ship"));
  EXPECT_THAT(error_of("time_s,bearing_deg,sensor_east_mps,sensor_north_mps\n0,90,5,6\n"), HasSubstr("own-ship"));
  EXPECT_THAT(error_of(header + ",sensor_north_mps\n0,90,5,6,1\n"), HasSubstr("own-ship"));
}

TEST(RecordingCsv, OwnShipHasAHeightWhereTheLogTellsIt) {
  const std::string header = "time_s,bearing_deg,elevation_deg,sensor_east_m,sensor_north_m";
  EXPECT_TRUE(std::isnan(read(header + "\n0,90,10,5,6\n").measurements[0].sensor->up_m)) << "that of the site, then";
  const Recording high = read(header + ",sensor_up_km\n0,90,10,5,6,2\n1,90,10,5,6,\n");
  EXPECT_EQ(high.measurements[0].sensor->up_m, 2000.0);
  EXPECT_EQ(high.measurements[0].sensor->climb_mps, 0.0);
  EXPECT_FALSE(high.measurements[1].sensor) << "from an unknown height";
  EXPECT_TRUE(high.measurements[1].is_missing());
  EXPECT_EQ(high.counts.missing, 1);
  const std::string flat = "time_s,bearing_deg,sensor_east_m,sensor_north_m,sensor_up_m";
  EXPECT_FALSE(read(flat + "\n0,90,5,6,\n").measurements[0].is_missing()) << "a bearing does not look up";

  const std::string text = header +
                           ",sensor_east_mps,sensor_north_mps,sensor_up_m,sensor_up_mps\n0,90,10,5,6,1,2,0,-3\n"
                           "1,,,5,6,1,2,100,-3\n";
  const Recording climbing = read(text);
  EXPECT_EQ(climbing.measurements[0].sensor->climb_mps, -3.0);
  EXPECT_EQ(write_recording(climbing), text);

  EXPECT_THAT(error_of("time_s,bearing_deg,sensor_up_m\n0,90,5\n"),
              AllOf(HasSubstr("sensor_up_m: stands alone"), HasSubstr("sensor_east_m, sensor_north_m with it")));
  EXPECT_THAT(error_of(flat + ",sensor_up_fps\n0,90,5,6,7,8\n"),
              AllOf(HasSubstr("sensor_up_fps: stands alone"), HasSubstr("sensor_east_mps, sensor_north_mps with it")));
}

TEST(RecordingCsv, AGuessStandsInTheRowsThatHaveOne) {
  const std::string text =
      "time_s,bearing_deg,guess_range_m,guess_range_sigma_m,guess_speed_mps,guess_speed_sigma_mps\n"
      "0,90,5000,2000,2,1\n1,91,,,,\n";
  const Recording recording = read(text);
  ASSERT_TRUE(recording.measurements[0].guess);
  EXPECT_EQ(recording.measurements[0].guess->range_m, 5000.0);
  EXPECT_EQ(recording.measurements[0].guess->speed_sigma_mps, 1.0);
  EXPECT_FALSE(recording.measurements[1].guess);
  EXPECT_EQ(recording.measured.size(), 1u);
  const Recording again = read(write_recording(recording));
  EXPECT_EQ(again.measurements[0].guess->speed_mps, 2.0);
  EXPECT_FALSE(again.measurements[1].guess);
  EXPECT_THAT(error_of("time_s,bearing_deg,guess_range_m\n0,90,5000\n"), HasSubstr("guess"));
  EXPECT_THAT(error_of("time_s,bearing_deg,guess_range_m,guess_range_sigma_m\n0,90,5000,-1\n"),
              HasSubstr("guess_range_sigma_m"));
}

TEST(RecordingCsv, UnusableCellMakesTheMeasurementMissing) {
  for (const char* cell : {"", "nan", "inf", "-inf"}) {
    const Recording z = read("time_s,position_m\n0,1\n1," + std::string(cell) + "\n2,3\n");
    EXPECT_TRUE(z.measurements[1].is_missing()) << cell;
    EXPECT_EQ(z.counts.missing, 1) << cell;
    const Recording sigma = read("time_s,position_m,position_sigma_m\n0,1," + std::string(cell) + "\n");
    EXPECT_TRUE(sigma.measurements[0].is_missing()) << cell;
    EXPECT_EQ(sigma.counts.missing, 1) << cell;
    const Recording sensor = read("time_s,range_m,sensor_east_m,sensor_north_m\n0,1,2," + std::string(cell) + "\n");
    EXPECT_TRUE(sensor.measurements[0].is_missing()) << cell;
    EXPECT_FALSE(sensor.measurements[0].sensor) << cell;
  }
}

TEST(RecordingCsv, TextWhereANumberBelongsIsAnError) {
  EXPECT_THAT(error_of("time_s,position_m\n0,1\n1,abc\n"), AllOf(HasSubstr("log.csv:3: position_m"), HasSubstr("abc")));
}

TEST(RecordingCsv, RepeatedTimeWithOtherValuesIsKept) {
  const Recording log = read("time_s,position_m\n0,1\n0,2\n");
  EXPECT_EQ(log.measurements.size(), 2u);
  EXPECT_EQ(log.counts.repeated, 0);
}

TEST(RecordingCsv, IdenticalRowsCountOnce) {
  const Recording log =
      read("time_s,position_m,truth_position_m\n0,1,5\n0,1.0,5\n0,1,5\n1,,6\n1,,6\n2,1,5\n0.2e1,1,5\n");
  EXPECT_EQ(log.measurements.size(), 3u);
  EXPECT_EQ(log.truth[0].x.size(), 3u);
  EXPECT_EQ(log.counts.repeated, 4);
  EXPECT_EQ(log.counts.missing, 1);
}

TEST(RecordingCsv, DecreasingTimeIsAnErrorThatNamesTheRow) {
  EXPECT_THAT(error_of("time_s,position_m\n0,1\n5,2\n4.5,3\n"),
              AllOf(HasSubstr("log.csv:4: time_s"), HasSubstr("4.5"), HasSubstr("5")));
}

TEST(RecordingCsv, TimeMustBeThereAndFinite) {
  EXPECT_THAT(error_of("tim_s,position_m\n0,1\n"), AllOf(HasSubstr("time_s"), HasSubstr("tim_s")));
  for (const char* cell : {"", "nan", "inf"})
    EXPECT_THAT(error_of("time_s,position_m\n" + std::string(cell) + ",1\n"), HasSubstr("log.csv:2: time_s")) << cell;
}

TEST(RecordingCsv, ColumnWithoutAKnownUnitIsAnError) {
  EXPECT_THAT(error_of("time_s,position\n0,1\n"),
              AllOf(HasSubstr("position"), HasSubstr("--columns position=position_m")));
  EXPECT_THAT(error_of("time_s,speed_furlongs\n0,1\n"), AllOf(HasSubstr("0 measured"), HasSubstr("_deg")));
  EXPECT_THAT(error_of("time_s,_m\n0,1\n"), HasSubstr("0 measured columns"));
  EXPECT_THAT(error_of("time_s,position_m,truth_depth_cm\n0,1,1\n"),
              AllOf(HasSubstr("truth_depth_cm"), HasSubstr("names no known unit")));
}

TEST(RecordingCsv, SigmaMustBePositiveAndBelongToAColumn) {
  for (const char* sigma : {"0", "-1"})
    EXPECT_THAT(error_of("time_s,position_m,position_sigma_m\n0,1," + std::string(sigma) + "\n"),
                AllOf(HasSubstr("log.csv:2: position_sigma_m"), HasSubstr("> 0")));
  EXPECT_THAT(error_of("time_s,position_m,range_sigma_m\n0,1,1\n"),
              AllOf(HasSubstr("range_sigma_m"), HasSubstr("valid: position_sigma_m")));
  EXPECT_EQ(read("time_s,bearing_deg,bearing_sigma_rad\n0,1,1\n").measurements[0].sigma(0), 1.0) << "units are told";
  EXPECT_THAT(error_of("time_s,east_m,north_m,east_sigma_m\n0,1,1,1\n"), HasSubstr("no column \"north_sigma_m\""));
}

TEST(RecordingCsv, LogMustMeasureSomething) {
  EXPECT_THAT(error_of("time_s,truth_position_m\n0,1\n"), HasSubstr("0 measured columns"));
  EXPECT_THAT(error_of("time_s,position_m\n"), HasSubstr("has no rows"));
  EXPECT_THAT(error_of(""), HasSubstr("is empty"));
  std::string too_many = "time_s";
  for (int i = 0; i <= kMaxDimension; ++i) too_many += ",c" + std::to_string(i) + "_m";
  EXPECT_THAT(error_of(too_many + "\n"), HasSubstr(std::to_string(kMaxDimension + 1) + " measured columns"));
}

TEST(RecordingCsv, TruthOfPositionsIsCompletedByVelocities) {
  const Recording line = read("time_s,position_m,truth_position_m\n0,1,0\n2,1,6\n3,1,9\n");
  EXPECT_EQ(line.truth_space, &line_space());
  EXPECT_NEAR(line.truth[0].x[1](1), 3.0, 1e-12);
  const Recording plane = read("time_s,range_m,truth_north_m,truth_east_m\n0,1,0,5\n1,1,-2,6\n");
  EXPECT_EQ(plane.truth_space, &plane_space());
  EXPECT_TRUE(plane.truth[0].x[1].isApprox(Eigen::Vector4d(6, -2, 1, -2), 1e-12));
}

TEST(RecordingCsv, TruthThatGivesVelocitiesKeepsThem) {
  const Recording log = read("time_s,position_m,truth_position_m,truth_velocity_mps\n0,1,0,7\n1,1,3,\n");
  EXPECT_EQ(log.truth[0].x[0](1), 7.0);
  EXPECT_TRUE(std::isnan(log.truth[0].x[1](1)));
}

TEST(RecordingCsv, OtherTruthHasASpaceOfItsOwn) {
  const Recording log = read("time_s,bearing_deg,truth_bearing_deg,truth_range_m\n0,1,180,500\n");
  EXPECT_THAT(log.truth_space->components, ElementsAre("bearing_deg", "range_m"));
  EXPECT_DOUBLE_EQ(log.truth[0].x[0](0), kPi);
  EXPECT_EQ(log.truth[0].x[0](1), 500.0);
}

TEST(RecordingCsv, WrittenLogReadsBack) {
  const std::string text =
      "time_s,east_m,north_m,east_sigma_m,north_sigma_m,sensor_east_m,sensor_north_m,sensor_east_mps,sensor_north_mps,"
      "truth_east_m,truth_north_m,truth_east_mps,truth_north_mps\n"
      "0,0.1,2,3,4,5,6,7,8,9,10,11,12\n"
      "1.5,,2,3,4,5,6,7,8,9,10,,12\n"
      "1.5,1,2,3,4,5,6,7,8,9,10,11,12\n";
  EXPECT_EQ(write_recording(read(text)), text);
  const std::string bare = "time_s,position_m\n0,1\n1,\n2,3\n";
  EXPECT_EQ(write_recording(read(bare)), bare);
}

TEST(RecordingCsv, WrittenAnglesAreDegreesAgain) {
  const Recording log = read("time_s,bearing_deg,bearing_sigma_deg\n0,33.3,0.7\n");
  const Recording again = read(write_recording(log));
  EXPECT_DOUBLE_EQ(again.measurements[0].z(0), radians(33.3));
  EXPECT_DOUBLE_EQ(again.measurements[0].sigma(0), radians(0.7));
}

TEST(RecordingCsv, BearingsWithFrequenciesReadBack) {
  const std::string text =
      "time_s,bearing_deg,frequency_hz,bearing_sigma_deg,frequency_sigma_hz,sensor_east_m,sensor_north_m,"
      "sensor_east_mps,sensor_north_mps,truth_east_m,truth_north_m,truth_east_mps,truth_north_mps,truth_frequency_hz\n"
      "0,90,99.75,1,0.02,1,2,3,4,3000,7000,-3,0,100\n"
      "7,90,,1,0.02,1,2,3,4,2979,7000,-3,0,100\n"
      "14,,100.25,1,0.02,1,2,3,4,2958,7000,-3,0,130\n"
      "21,,,1,0.02,1,2,3,4,2937,7000,-3,0,130\n";
  const Recording log = read(text);
  EXPECT_EQ(log.truth_space, &plane_frequency_space());
  EXPECT_EQ(log.truth[0].x[2], (Eigen::Matrix<double, 5, 1>{2958.0, 7000.0, -3.0, 0.0, 130.0}));
  EXPECT_EQ(log.measurements[0].z(1), 99.75);
  EXPECT_EQ(log.measurements[0].sigma(1), 0.02);
  EXPECT_TRUE(std::isnan(log.measurements[1].z(1)));
  EXPECT_EQ(log.counts.missing, 1) << "either a bearing or a frequency is of use";
  EXPECT_EQ(write_recording(log), text);
}

TEST(RecordingCsv, OtherMeasurementsAreOfUseAsAWholeOnly) {
  EXPECT_EQ(read("time_s,east_m,north_m\n0,1,2\n1,1,\n").counts.missing, 1);
  EXPECT_EQ(read("time_s,bearing_deg\n0,1\n1,\n").counts.missing, 1);
}

TEST(RecordingCsv, TruthHasAFrequencyWhereTheLogGivesOne) {
  const std::string rows = "\n0,90,0,0,100\n10,90,30,40,100\n20,90,60,80,100\n";
  const Recording log = read("time_s,bearing_deg,truth_east_m,truth_north_m,truth_frequency_hz" + rows);
  EXPECT_EQ(log.truth_space, &plane_frequency_space());
  EXPECT_NEAR(log.truth[0].x[1][2], 3.0, 1e-9) << "velocities are completed as without it";
  EXPECT_NEAR(log.truth[0].x[1][3], 4.0, 1e-9);
  EXPECT_EQ(log.truth[0].x[1][4], 100.0);
  EXPECT_EQ(read("time_s,bearing_deg,truth_east_m,truth_north_m\n0,90,0,0\n").truth_space, &plane_space());
  EXPECT_EQ(read("time_s,bearing_deg,truth_frequency_hz\n0,90,100\n").truth_space->size(), 1) << "no plane in that";
}

TEST(RecordingCsv, SeveralTrueTracksDoNotFitALog) {
  Recording log = read("time_s,position_m,truth_position_m\n0,1,0\n");
  log.truth.push_back(log.truth[0]);
  EXPECT_THAT(error_message([&] { write_recording(log); }), HasSubstr("2 true tracks"));
}

// Gives a line at a time, as a pipe does whose writer is slower than the reader.
class LineByLine : public std::streambuf {
 public:
  explicit LineByLine(std::vector<std::string> lines) : lines_(std::move(lines)) {}
  std::size_t given() const { return next_; }

 protected:
  int_type underflow() override {
    if (next_ == lines_.size()) return traits_type::eof();
    std::string& line = lines_[next_++];
    setg(line.data(), line.data(), line.data() + line.size());
    return traits_type::to_int_type(line[0]);
  }

 private:
  std::vector<std::string> lines_;
  std::size_t next_ = 0;
};

TEST(MeasurementLog, GivesEachRowAsSoonAsItHasCome) {
  LineByLine lines({"time_s,position_m,truth_position_m\n", "1,10,9\n", "1,10,9\n", "2,,8\n", "3,30,7\n", "2,30,7\n"});
  std::istream stream(&lines);
  MeasurementLog reader(CsvReader(stream, "log.csv"));
  EXPECT_EQ(lines.given(), 1u) << "the header";
  EXPECT_EQ(reader.truth_space(), &line_space());
  ASSERT_TRUE(reader.next());
  EXPECT_EQ(lines.given(), 2u) << "and no row further";
  EXPECT_TRUE(reader.may_wait());
  EXPECT_EQ(reader.measurement().z(0), 10.0);
  EXPECT_EQ(reader.truth()(0), 9.0);
  EXPECT_TRUE(std::isnan(reader.truth()(1)));
  ASSERT_TRUE(reader.next());
  EXPECT_EQ(reader.measurement().time_s, 2.0) << "the row twice is one";
  EXPECT_TRUE(reader.measurement().is_missing());
  EXPECT_EQ(reader.counts().repeated, 1);
  EXPECT_EQ(reader.counts().missing, 1);
  ASSERT_TRUE(reader.next());
  EXPECT_THAT(error_message([&] { reader.next(); }), HasSubstr("log.csv:6: time_s: is 2, earlier than 3"));
}

TEST(MeasurementLog, KnowsWhatHasCome) {
  std::istringstream stream("time_s,position_m\n1,10\n2,20\n");
  MeasurementLog reader(CsvReader(stream, "log.csv"));
  EXPECT_FALSE(reader.may_wait());
  ASSERT_TRUE(reader.next());
  EXPECT_FALSE(reader.may_wait());
  ASSERT_TRUE(reader.next());
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.next());
}

TEST(RecordingCsv, UnitsAreTheNames) {
  const Recording log = read(
      "time_ms,range_km,bearing_rad,range_sigma_ft,bearing_sigma_mrad,sensor_east_nmi,sensor_north_km,"
      "sensor_east_kn,sensor_north_kmh,truth_east_km,truth_north_m\n1500,2,0.5,10,20,1,2,10,36,3,4\n2500,2,0.5,10,20,1,2,"
      "10,36,3,4\n");
  EXPECT_THAT(log.measured, ElementsAre("range_m", "bearing_deg"));
  const Measurement& measurement = log.measurements[0];
  EXPECT_EQ(measurement.time_s, 1.5);
  EXPECT_DOUBLE_EQ(measurement.z(0), 2000.0);
  EXPECT_DOUBLE_EQ(measurement.z(1), 0.5);
  EXPECT_DOUBLE_EQ(measurement.sigma(0), 3.048);
  EXPECT_DOUBLE_EQ(measurement.sigma(1), 0.02);
  EXPECT_DOUBLE_EQ(measurement.sensor->position_m.x(), 1852.0);
  EXPECT_DOUBLE_EQ(measurement.sensor->velocity_mps.x(), 10.0 * 1852.0 / 3600.0);
  EXPECT_DOUBLE_EQ(measurement.sensor->velocity_mps.y(), 10.0);
  EXPECT_DOUBLE_EQ(log.truth[0].x[0](0), 3000.0);
  EXPECT_THAT(error_of("time_s,range_m,range_km\n0,1,2\n"), HasSubstr("says the same"));
}

TEST(RecordingCsv, TimesAreNumbersWithAUnitOrIsoText) {
  const Recording iso = read("time,position_m\n2023-11-14T22:13:20Z,1\n2023-11-14T23:13:20.5+01:00,2\n");
  EXPECT_EQ(iso.measurements[0].time_s, 1.7e9);
  EXPECT_EQ(iso.measurements[1].time_s, 1.7e9 + 0.5);
  EXPECT_THAT(error_of("time,position_m\n12.5,1\n"), AllOf(HasSubstr("without a unit"), HasSubstr("time=time_s")));
  EXPECT_THAT(error_of("time_s,position_m\n0,1\n2023-11-14T22:13:20Z,2\n"), HasSubstr("log.csv:3: time_s"));
  EXPECT_THAT(error_of("time_s,position_m\nyesterday,1\n"), AllOf(HasSubstr("yesterday"), HasSubstr("ISO 8601")));
}

std::vector<std::string> left_out(const std::string& text, const RecordingOptions& options = {}) {
  std::istringstream stream(text);
  LogFindings findings;
  read_recording(stream, "log.csv", options, &findings);
  return findings.left_out;
}

TEST(RecordingCsv, OtherColumnsAreLeftOutAndNamed) {
  EXPECT_THAT(left_out("time_s,position_m,snr_db,remark,altitude_ft\n0,1,12,fine,300\n"),
              ElementsAre("snr_db", "remark", "altitude_ft"));
  EXPECT_THAT(left_out("time_s,depth_m,bearing_deg,depth_sigma_m\n0,1,12,3\n"),
              ElementsAre("depth_m", "depth_sigma_m"));
  EXPECT_THAT(left_out("time_s,range_m,bearing_deg,east_m\n0,1,12,3\n", {.measured = {"bearing_deg", "range_m"}}),
              ElementsAre("east_m"));
}

TEST(RecordingCsv, WantedColumnsComeInTheirOrder) {
  std::istringstream stream("time_s,bearing_deg,range_m\n0,90,5\n");
  const Recording log = read_recording(stream, "log.csv", {.measured = {"range_m", "bearing_deg"}});
  EXPECT_THAT(log.measured, ElementsAre("range_m", "bearing_deg"));
  EXPECT_EQ(log.measurements[0].z(0), 5.0);
}

TEST(RecordingCsv, WhatIsMeantKeepsTheUnitOfTheFile) {
  EXPECT_THAT(error_of("time_s,rng_km,bearing_deg\n0,5,90\n"), HasSubstr("rng_km=range_km"));
  EXPECT_THAT(error_of("time_s,range_km,brg_rad\n0,5,1\n"), HasSubstr("brg_rad=bearing_rad"));
}

TEST(RecordingCsv, MisspeltColumnIsNotLostSilently) {
  for (const auto& [misspelt, meant] :
       std::vector<std::pair<std::string, std::string>>{{"bearing_dg", "bearing_deg"},
                                                        {"Bearing_deg", "bearing_deg"},
                                                        {"baering_deg", "bearing_deg"},
                                                        {"frequncy_hz", "frequency_hz"},
                                                        {"freq_hz", "frequency_hz"},
                                                        {"range", "range_m"},
                                                        {"sensor_eest_m", "sensor_east_m"},
                                                        {"position_sigam_m", "position_sigma_m"}})
    EXPECT_THAT(error_of("time_s,position_m," + misspelt + "\n0,1,2\n"),
                AllOf(HasSubstr(misspelt), HasSubstr("did you mean \"" + meant + "\"")));
}

TEST(RecordingCsv, MisspeltTruthIsNoComponentOfItsOwn) {
  const std::string measured = "time_s,east_m,north_m,";
  for (const auto& [misspelt, meant] :
       std::vector<std::pair<std::string, std::string>>{{"truth_eas_m", "truth_east_m"},
                                                        {"truth_est_km", "truth_east_m"},
                                                        {"truth_nort_m", "truth_north_m"},
                                                        {"truth_velocty_mps", "truth_velocity_mps"},
                                                        {"truth_frequncy_hz", "truth_frequency_hz"}})
    EXPECT_THAT(error_of(measured + misspelt + "\n0,1,2,3\n"),
                AllOf(HasSubstr(misspelt + ": is no known column"), HasSubstr("did you mean \"" + meant + "\"")));
  EXPECT_THAT(error_of(measured + "truth_north\n0,1,2,3\n"),
              AllOf(HasSubstr("truth_north: names no known unit"), HasSubstr("truth_north=truth_north_m")));
  // Names that are near to nothing, to what is there already, or to what has another unit, are one's own.
  for (const char* own : {"truth_depth_m", "truth_east_m,truth_last_m", "truth_east_mps2"}) {
    const std::string columns = own;
    const std::string cells = columns.find(',') == std::string::npos ? "3" : "3,4";
    EXPECT_EQ(error_of(measured + columns + "\n0,1,2," + cells + "\n"), "no error") << own;
  }
}

TEST(RecordingCsv, ColumnsMayBeGivenOtherNames) {
  std::istringstream stream("t,rng,baering_deg\n0,2,7\n1,3,8\n");
  const RecordingOptions options{.columns = {{"t", "time_s"}, {"rng", "range_km"}, {"baering_deg", ""}}};
  const Recording log = read_recording(stream, "log.csv", options);
  EXPECT_THAT(log.measured, ElementsAre("range_m"));
  EXPECT_EQ(log.measurements[1].z(0), 3000.0);
  std::istringstream again("t,rng\n0,2\n");
  EXPECT_THAT(error_message([&] {
                read_recording(again, "log.csv", {.columns = {{"rgn", "range_m"}}});
              }),
              AllOf(HasSubstr("no column \"rgn\""), HasSubstr("did you mean \"rng\"")));
}

TEST(RecordingCsv, OneTargetOfSeveral) {
  const std::string text = "time_s,mmsi,range_m\n0,3e5,1\n0,300000,2\n1,3e5,3\n1,300000,4\n";
  EXPECT_THAT(error_of(text), AllOf(HasSubstr("log.csv:3: mmsi"), HasSubstr("--track-id 3e5")));
  std::istringstream stream(text);
  const Recording log = read_recording(stream, "log.csv", {.target = "300000"});
  ASSERT_EQ(log.measurements.size(), 2u);
  EXPECT_EQ(log.measurements[1].z(0), 4.0);
  EXPECT_EQ(read("time_s,callsign,range_m\n0,AFR12,1\n1,,2\n").measurements.size(), 2u) << "a name need not be told";
}

TEST(RecordingCsv, LateRowsAreSortedWithinTheWindow) {
  const std::string text = "time_s,position_m\n0,0\n2,2\n1,1\n3,3\n2.5,2.5\n";
  EXPECT_THAT(error_of(text), AllOf(HasSubstr("log.csv:4: time_s"), HasSubstr("--sort-window 1")));
  std::istringstream stream(text);
  LogFindings findings;
  const Recording log = read_recording(stream, "log.csv", {.sort_window_s = 1.0}, &findings);
  EXPECT_EQ(findings.late, 2u);
  ASSERT_EQ(log.measurements.size(), 5u);
  for (const Measurement& measurement : log.measurements) EXPECT_EQ(measurement.z(0), measurement.time_s);
  for (std::size_t k = 1; k < 5; ++k) EXPECT_GT(log.measurements[k].time_s, log.measurements[k - 1].time_s);
}

TEST(RecordingCsv, StreamGivesARowBeforeTheNextOneComes) {
  std::stringstream stream;
  stream << "time_s,position_m\n0,0\n";
  MeasurementLog log(CsvReader(stream, "log.csv"));
  EXPECT_TRUE(log.next());
  stream << "1,1\n";
  EXPECT_TRUE(log.next()) << "the first was given without waiting for it";
  EXPECT_EQ(log.measurement().time_s, 1.0);
  EXPECT_FALSE(log.next());
}

TEST(RecordingCsv, WhatCannotBeIsMissingAndCounted) {
  const auto findings_of = [](const std::string& text, int missing) {
    std::istringstream stream(text);
    LogFindings findings;
    EXPECT_EQ(read_recording(stream, "log.csv", {}, &findings).counts.missing, missing) << text;
    return findings;
  };
  EXPECT_EQ(findings_of("time_s,range_m,bearing_deg\n0,5,1\n1,-4,1\n", 1).impossible, 1u);
  EXPECT_EQ(findings_of("time_s,frequency_hz\n0,50\n1,0\n2,-3\n", 2).impossible, 2u);
  EXPECT_EQ(findings_of("time_s,bearing_deg\n0,50\n1,1e12\n", 1).impossible, 1u);
  EXPECT_EQ(findings_of("time_s,bearing_deg\n0,350\n1,511\n2,351\n", 1).not_available, 1u);
  EXPECT_EQ(findings_of("time_s,bearing_deg\n0,510\n1,511\n2,512\n", 0).not_available, 0u) << "turns go on";
  EXPECT_EQ(findings_of("time_s,bearing_deg\n0,350\n1,-999\n2,999\n3,-9999\n4,351\n", 3).not_available, 3u);
  EXPECT_EQ(findings_of("time_s,range_m,bearing_deg\n0,5,1\n1,0,1\n", 1).impossible, 1u);
}

TEST(RecordingCsv, PlotAtZeroZeroOfATargetThatIsNotNearIsMissing) {
  const auto at_zero = [](const std::string& rows) {
    std::istringstream stream("time_s,east_m,north_m\n" + rows);
    LogFindings findings;
    const Recording recording = read_recording(stream, "log.csv", {}, &findings);
    EXPECT_EQ(static_cast<std::size_t>(recording.counts.missing), findings.at_zero) << rows;
    return findings.at_zero;
  };
  EXPECT_EQ(at_zero("0,20000,100\n1,20100,100\n2,0,0\n3,0.0,-0.0\n4,20400,100\n"), 2u);
  EXPECT_EQ(at_zero("0,-200,0\n1,-100,0\n2,0,0\n3,100,0\n"), 0u) << "it passed there";
  EXPECT_EQ(at_zero("0,-4000,0\n1,-2000,0\n2,0,0\n3,2000,0\n"), 0u) << "fast";
  EXPECT_EQ(at_zero("0,0,0\n1,20000,0\n2,20100,0\n"), 0u) << "a log may be counted from its first row";
}

TEST(RecordingCsv, RowsBeyondWhereTrackersFollowAreCounted) {
  std::istringstream stream("time_s,east_m,north_km\n0,15501189,4205\n1,15501266,4205\n2,9e6,4205\n3,3,12000\n");
  LogFindings findings;
  EXPECT_EQ(read_recording(stream, "log.csv", {}, &findings).counts.missing, 0);
  EXPECT_EQ(findings.too_far, 3u);
  EXPECT_THAT(findings.note(), HasSubstr("3 rows farther than 1e+07 m from the origin"));
}

TEST(RecordingCsv, WindowThatIsNamedIsWhatTheWholeFileNeeds) {
  const testing::TemporaryFolder folder;
  std::string text = "time_s,position_m\n";
  for (int k = 120; k > 0; --k) text += fmt::format("{},{}\n", k, 1000 + k);
  const auto path = folder.write("reversed.csv", text);
  EXPECT_THAT(testing::error_message([&] { read_recording(path); }),
              AllOf(HasSubstr("reversed.csv:3: time_s"), HasSubstr("--sort-window 119 "), HasSubstr("--late 119 ")));
  EXPECT_EQ(read_recording(path, {.sort_window_s = 119.0}).measurements.front().time_s, 1.0);
}

TEST(RecordingCsv, AllRowsAtOneTimeAreNoLog) {
  EXPECT_THAT(error_of("time_s,position_m\n1.7e9,1\n1.7e9,2\n1.7e9,3\n"), HasSubstr("one time, 1700000000"));
}

TEST(RecordingCsv, LongHeaderIsReadInLinearTime) {
  std::string header = "time_s,position_m", row = "0,1";
  for (int i = 0; i < 100'000; ++i) {
    header += ",z_" + std::to_string(i);
    row += ",";
  }
  EXPECT_EQ(left_out(header + "\n" + row + "\n").size(), 100'000u);
}

TEST(RecordingCsv, ReadsTheRecordedFlight) {
  const std::filesystem::path path = testing::real_data("radar_range_ajaccio.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  const Recording log = read_recording(path);
  ASSERT_EQ(log.measurements.size(), 2629u);
  EXPECT_EQ(log.counts.missing + log.counts.repeated, 0);
  double squared_m2 = 0.0, fastest_mps = 0.0;
  for (std::size_t k = 0; k < log.measurements.size(); ++k) {
    EXPECT_EQ(log.measurements[k].sigma(0), 150.0);
    squared_m2 += std::pow(log.measurements[k].z(0) - log.truth[0].x[k](0), 2);
    fastest_mps = std::max(fastest_mps, std::abs(log.truth[0].x[k](1)));
  }
  // 150 m of noise over 2629 rows: a chi-square interval of 4.5 standard deviations.
  EXPECT_NEAR(squared_m2 / 2629.0, 22500.0, 4.5 * 22500.0 * std::sqrt(2.0 / 2629.0));
  EXPECT_GT(fastest_mps, 50.0);
  EXPECT_LT(fastest_mps, 200.0);
}

}  // namespace
}  // namespace truebearing::recording_csv_test
