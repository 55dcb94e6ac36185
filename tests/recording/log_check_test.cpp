// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/log_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fmt/format.h>

#include "tests/support/temporary_folder.hpp"

namespace truebearing::log_check_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;

LogReport check(const std::string& text, const RecordingOptions& options = {}) {
  const TemporaryFolder folder;
  return check_log(folder.write("log.csv", text), options);
}

std::string bearings(double scale, int rows = 30) {
  std::string text = "time_s,bearing_deg,snr_db\n";
  for (int k = 0; k < rows; ++k) text += fmt::format("{},{},3\n", 4 * k, scale * (100 + k));
  return text;
}

TEST(LogCheck, SaysWhatColumnsAreTakenFor) {
  const LogReport report = check(bearings(1.0));
  EXPECT_TRUE(report.is_usable());
  EXPECT_THAT(report.oddities, IsEmpty());
  EXPECT_EQ(report.rows, 30u);
  EXPECT_EQ(report.columns[0].taken_for, "time");
  EXPECT_EQ(report.columns[1].taken_for, "measured bearing_deg");
  EXPECT_EQ(report.columns[1].least, 100.0);
  EXPECT_EQ(report.columns[1].greatest, 129.0);
  EXPECT_FALSE(report.columns[2].is_used);
  EXPECT_EQ(report.median_period_s, 4.0);
  EXPECT_EQ(report.last_s, 116.0);
}

TEST(LogCheck, SaysWhoTakesNoticeOfAltitudes) {
  std::string text = "time_s,latitude_deg,longitude_deg,altitude_ft\n";
  for (int k = 0; k < 30; ++k) text += fmt::format("{},{},7.5,{}\n", k, 45.0 + 0.001 * k, 1000 + k);
  const LogReport report = check(text);
  EXPECT_TRUE(report.is_usable());
  EXPECT_EQ(report.columns[3].taken_for, "height, to studies in space alone: altitude_m");
  EXPECT_EQ(report.columns[3].unit, "ft");
  EXPECT_EQ(report.columns[3].greatest, 1029.0);
}

TEST(LogCheck, CountsRowsThatHaveNoTime) {
  const LogReport report = check("range_m,bearing_deg\n1,2\n3,4\n5,6\n");
  EXPECT_FALSE(report.is_usable());
  EXPECT_EQ(report.rows, 3u);
  EXPECT_TRUE(std::isnan(report.first_s));
  EXPECT_TRUE(std::isnan(report.last_s));
  EXPECT_EQ(report.repeated + report.late + report.gaps, 0u);
  EXPECT_THAT(report.faults, ::testing::ElementsAre(HasSubstr("has no column \"time_s\"")));
}

TEST(LogCheck, TimesThatCannotBeReadAreNoFirstOne) {
  const LogReport some = check("time_s,range_m\nxx,1\n100,2\n101,3\n");
  EXPECT_EQ(some.first_s, 100.0);
  EXPECT_EQ(some.last_s, 101.0);
  EXPECT_TRUE(std::isnan(check("time_s,range_m\nxx,1\nyy,2\n").last_s));
}

TEST(LogCheck, CountsGapsAndRepeatedRows) {
  const LogReport report = check("time_s,position_m\n0,1\n1,2\n2,3\n2,3\n3,4\n9,5\n");
  EXPECT_TRUE(report.is_usable());
  EXPECT_EQ(report.gaps, 1u);
  EXPECT_EQ(report.longest_gap_after_s, 3.0);
  EXPECT_EQ(report.greatest_period_s, 6.0);
  EXPECT_EQ(report.repeated, 1u);
}

TEST(LogCheck, LateRowsAreAFaultUnlessTheyMayBeSorted) {
  const std::string text = "time_s,position_m\n0,1\n2,2\n1,3\n";
  EXPECT_THAT(check(text).faults, Contains(HasSubstr("log.csv:4: time_s")));
  const LogReport sorted = check(text, {.sort_window_s = 5.0});
  EXPECT_TRUE(sorted.is_usable());
  EXPECT_EQ(sorted.late, 1u);
}

TEST(LogCheck, MisspeltColumnIsAFaultWithTheNearestName) {
  const LogReport report = check("time_s,position_m,position_sigm_m\n0,1,1\n");
  EXPECT_THAT(report.faults, Contains(HasSubstr("did you mean \"position_sigma_m\"")));
  EXPECT_EQ(report.columns.size(), 3u);
}

TEST(LogCheck, AbbreviatedPositionIsAFaultWithItsName) {
  const LogReport report = check("time_s,lat_deg,lon_deg\n0,45,7\n1,45.1,7\n");
  EXPECT_THAT(report.faults, Contains(HasSubstr("did you mean \"latitude_deg\"")));
  EXPECT_THAT(report.faults, Contains(HasSubstr("did you mean \"longitude_deg\"")));
  EXPECT_TRUE(check("time_s,east_m,north_m,lat_deg,lon_deg\n0,45,7,1,2\n1,45.1,7,1,2\n").is_usable())
      << "beside what is measured";
}

TEST(LogCheck, LogWithoutAMeasurementCannotBeUsed) {
  EXPECT_THAT(check("time_s,east_m,north_m\n0,,\n1,,\n").faults, Contains(HasSubstr("no usable measurement")));
  EXPECT_TRUE(check("time_s,east_m,north_m\n0,,\n1,5,7\n").is_usable());
}

TEST(LogCheck, PositionsBeyondWhereTrackersFollowAreOdd) {
  const LogReport report = check("time_s,east_m,north_m\n0,15501189,4205185\n1,15501266,4205219\n");
  EXPECT_THAT(report.oddities, Contains(HasSubstr("2 rows farther than 1e+07 m from the origin")));
}

TEST(LogCheck, AllFaultsAreSaid) {
  const LogReport report = check("time_s,position_m,position_sigma_m\n0,a,1\n1,2,b\n2,3,-1\n");
  EXPECT_THAT(report.faults, Contains(HasSubstr("log.csv:2: position_m")));
  EXPECT_THAT(report.faults, Contains(HasSubstr("log.csv:3: position_sigma_m")));
  EXPECT_EQ(report.columns[1].unreadable, 1u);
}

TEST(LogCheck, AsksForUnitsThatWouldFitBetter) {
  EXPECT_THAT(check(bearings(0.0175)).oddities, Contains(HasSubstr("radians")));
  std::string millis = "time_s,position_m\n", tones = "time_s,frequency_hz\n", stuck = "time_s,position_m\n";
  for (int k = 0; k < 30; ++k) {
    millis += fmt::format("{},{}\n", 1.7e12 + 1000.0 * k, k);
    tones += fmt::format("{},{}\n", k, 0.1 + 0.001 * k);
    stuck += fmt::format("{},7\n", k);
  }
  EXPECT_THAT(check(millis).oddities, Contains(HasSubstr("time_ms")));
  EXPECT_THAT(check(tones).oddities, Contains(HasSubstr("frequency_khz")));
  EXPECT_THAT(check(stuck).oddities, Contains(HasSubstr("30 rows up to line 31 measure the same")));
  EXPECT_THAT(check("time_s,range_m\n0,1\n1,-2\n").oddities, Contains(HasSubstr("1 impossible")));
}

TEST(LogCheck, PositionsOfSeveralTargets) {
  std::string text = "time_s,icao24,latitude_deg,longitude_deg\n";
  for (int k = 0; k < 25; ++k)
    for (const char* name : {"4b1a2c", "3e5"}) text += fmt::format("{},{},{},7.5\n", 10 * k, name, 45 + 0.001 * k);
  const LogReport report = check(text);
  EXPECT_TRUE(report.is_usable());
  EXPECT_EQ(report.targets, 2u);
  EXPECT_EQ(report.median_period_s, 10.0) << "of one target's rows";
  EXPECT_EQ(report.columns[2].taken_for, "position on the globe latitude_deg");
}

}  // namespace
}  // namespace truebearing::log_check_test
