// SPDX-License-Identifier: Apache-2.0
// A log that several sensors wrote: which of them a row is of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <vector>

#include "tests/support/error_message.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/recording/recording_csv.hpp"

namespace truebearing::several_sensors_log_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;

RecordingOptions options_of(std::vector<Source> sources) {
  RecordingOptions options;
  options.measured = Measured::several(sources).components;
  options.sources = std::move(sources);
  return options;
}

const Source kLaser{"laser", {"east_m", "north_m"}}, kRadar{"radar", {"range_m", "bearing_deg", "range_rate_mps"}};
const std::string kHeader = "time_s,east_m,north_m,range_m,bearing_deg,range_rate_mps\n";

Recording read(const std::string& text, std::vector<Source> sources = {kLaser, kRadar}) {
  std::istringstream stream(text);
  return read_recording(stream, "log.csv", options_of(std::move(sources)));
}

std::string error_of(const std::string& text, std::vector<Source> sources = {kLaser, kRadar}) {
  return error_message([&] { read(text, std::move(sources)); });
}

TEST(SeveralSensorsLog, TheCellsThatAreFilledTellWhose) {
  const Recording log = read(kHeader + "0,3,4,,,\n0.05,,,5,90,-1\n");
  ASSERT_EQ(log.sources.size(), 2u);
  EXPECT_EQ(log.measurements[0].source, 0);
  EXPECT_EQ(log.measurements[0].z, Eigen::Vector2d(3, 4));
  EXPECT_EQ(log.measurements[1].source, 1);
  EXPECT_LT((log.measurements[1].z - Eigen::Vector3d(5, kPi / 2, -1)).norm(), 1e-15);
  EXPECT_EQ(log.counts.missing, 0);
}

TEST(SeveralSensorsLog, AColumnMayNameTheSensor) {
  const std::vector<Source> two{{"north_radar", {"range_m", "bearing_deg"}},
                                {"south_radar", {"range_m", "bearing_deg"}}};
  const Recording log =
      read("time_s,sensor,range_m,bearing_deg\n0,south_radar,5,10\n1,north_radar,6,20\n2,south_radar,,\n", two);
  EXPECT_EQ(log.measurements[0].source, 1);
  EXPECT_EQ(log.measurements[1].source, 0);
  EXPECT_EQ(log.measurements[2].source, 1);
  EXPECT_EQ(log.counts.missing, 1);
  EXPECT_THAT(error_of("time_s,sensor,range_m,bearing_deg\n0,west_radar,5,10\n", two),
              AllOf(HasSubstr("west_radar"), HasSubstr("north_radar, south_radar")));
  EXPECT_THAT(error_of("time_s,range_m,bearing_deg\n0,5,10\n", two),
              AllOf(HasSubstr("north_radar and south_radar apart"), HasSubstr("a column `sensor`")));
}

TEST(SeveralSensorsLog, TheSameNumbersOfTwoSensorsAreTwoRows) {
  const std::vector<Source> two{{"a", {"east_m", "north_m"}}, {"b", {"east_m", "north_m"}}};
  const Recording log = read("time_s,sensor,east_m,north_m\n1,a,100,0\n1,b,100,0\n2,a,200,0\n2,a,200,0\n", two);
  EXPECT_EQ(log.measurements.size(), 3u);
  EXPECT_EQ(log.counts.repeated, 1);
  EXPECT_THAT(error_of("time_s,sensor,east_m,north_m\n0,radar,3,4\n"),
              AllOf(HasSubstr("radar"), HasSubstr("one of laser")));
}

TEST(SeveralSensorsLog, ARowIsOfOneSensor) {
  EXPECT_THAT(error_of(kHeader + "0,3,4,5,,\n"), AllOf(HasSubstr("log.csv:2"), HasSubstr("a row for each sensor")));
}

TEST(SeveralSensorsLog, OfTwoThatFitTheOneThatMeasuresLessIsMeant) {
  const std::vector<Source> sources{{"doppler", {"range_m", "bearing_deg", "range_rate_mps"}},
                                    {"plain", {"range_m", "bearing_deg"}}};
  const Recording log = read("time_s,range_m,bearing_deg,range_rate_mps\n0,5,10,\n1,5,10,2\n", sources);
  EXPECT_EQ(log.measurements[0].source, 1);
  EXPECT_EQ(log.measurements[1].source, 0);
}

TEST(SeveralSensorsLog, ALogOfOneOfThemIsRead) {
  EXPECT_EQ(read("time_s,range_m,bearing_deg,range_rate_mps\n0,5,90,-1\n").measurements[0].source, 1);
  EXPECT_THAT(error_of("time_s,depth_m\n0,5\n"),
              AllOf(HasSubstr("measures depth_m"), HasSubstr("east_m, north_m of laser")));
}

TEST(SeveralSensorsLog, SigmasAreThoseOfTheRowsSensor) {
  const Recording log = read(
      "time_s,east_m,north_m,range_m,bearing_deg,range_rate_mps,east_sigma_m,north_sigma_m,range_sigma_m,bearing_sigma_deg,"
      "range_rate_sigma_mps\n0,3,4,,,,0.1,0.2,,,\n1,,,5,90,-1,,,0.3,2,0.4\n2,3,4,,,,,,,,\n");
  EXPECT_EQ(log.measurements[0].sigma, Eigen::Vector2d(0.1, 0.2));
  EXPECT_LT((log.measurements[1].sigma - Eigen::Vector3d(0.3, radians(2.0), 0.4)).norm(), 1e-15);
  EXPECT_EQ(log.measurements[2].sigma.size(), 0);  // the sensor's own hold
  EXPECT_FALSE(log.measurements[2].is_missing());
}

TEST(SeveralSensorsLog, ClocksThatAreAheadAreSetRightAndTheirRowsPutInOrder) {
  RecordingOptions options = options_of({kLaser, kRadar});
  options.clock_offsets_s = {0.0, 0.3};  // the radar's
  std::istringstream stream(kHeader + "0,3,4,,,\n0.1,3,4,,,\n0.2,3,4,,,\n0.45,,,5,90,-1\n0.5,3,4,,,\n");
  const Recording log = read_recording(stream, "log.csv", options);
  std::vector<double> times_s;
  for (const Measurement& measurement : log.measurements) times_s.push_back(measurement.time_s);
  EXPECT_THAT(times_s, ::testing::Pointwise(::testing::DoubleNear(1e-12), {0.0, 0.1, 0.15, 0.2, 0.5}));
  EXPECT_EQ(log.measurements[2].source, 1);
}

TEST(SeveralSensorsLog, ReadsBackAsItWasWritten) {
  const Recording log = read(kHeader + "0,3,4,,,\n0.05,,,5,90,-1\n0.1,,,,,\n");
  const std::string text = write_recording(log);
  EXPECT_THAT(text, HasSubstr("time_s,sensor,east_m"));
  const Recording again = read(text);
  ASSERT_EQ(again.measurements.size(), 3u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(again.measurements[k].source, log.measurements[k].source);
    EXPECT_EQ(again.measurements[k].z, log.measurements[k].z);
  }
  EXPECT_TRUE(again.measurements[2].is_missing());
}

}  // namespace
}  // namespace truebearing::several_sensors_log_test
