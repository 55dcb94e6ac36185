// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/step_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"

#include "truebearing/core/constants.hpp"

namespace truebearing::step_log_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;
using testing::position;
using testing::radar_log;
using testing::RadarFilter;

StepLog parse(const std::string& text, const std::string& tracker = {}) {
  std::istringstream stream(text);
  return read_step_log(stream, "steps.csv", tracker);
}

std::string error_of(const std::string& text, const std::string& tracker = {}) {
  return error_message([&] { parse(text, tracker); });
}

std::vector<StepRecord> records_of_a_tracker() {
  RadarFilter radar;
  radar.options = {.gate_nis = 3.0, .lost_after_s = 4.0};
  const auto tracker = radar.tracker();
  std::vector<StepRecord> records;
  for (Measurement measurement : radar_log(11, 40)) {
    const int k = static_cast<int>(measurement.time_s);
    if (k % 7 == 0 || (k > 20 && k < 30)) measurement.z[0] = kNaN;
    records.push_back(tracker->step(measurement)[0]);
  }
  return records;
}

TEST(StepLog, WhatIsWrittenReadsBackToTheBit) {
  StepLogWriter writer(line_space(), 1);
  const std::vector<StepRecord> records = records_of_a_tracker();
  for (const StepRecord& record : records) {
    writer.add("plain", record);
    writer.add("other, \"quoted\"", record);
  }
  for (const std::string tracker : {"plain", "other, \"quoted\""}) {
    const StepLog log = parse(writer.str(), tracker);
    EXPECT_EQ(log.space, &line_space());
    EXPECT_TRUE(log.has_innovation);
    ASSERT_EQ(log.records.size(), records.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
      const StepRecord &read = log.records[i], &written = records[i];
      EXPECT_EQ(read.track, written.track);
      EXPECT_EQ(read.time_s, written.time_s);
      EXPECT_EQ(read.status, written.status);
      EXPECT_EQ(read.x, written.x);
      EXPECT_EQ(read.P, written.P);
      ASSERT_EQ(read.innovation.has_value(), written.innovation.has_value()) << i;
      if (!read.innovation) continue;
      EXPECT_EQ(read.innovation->z, written.innovation->z);
      EXPECT_EQ(read.innovation->nu, written.innovation->nu);
      EXPECT_EQ(read.innovation->S, written.innovation->S);
      EXPECT_NEAR(read.innovation->nis, written.innovation->nis, 1e-12 * (1.0 + written.innovation->nis));
    }
  }
}

TEST(StepLog, WrittenAgainItIsTheSameText) {
  StepLogWriter writer(line_space(), 1);
  for (const StepRecord& record : records_of_a_tracker()) writer.add("plain", record);
  StepLogWriter again(line_space(), 1);
  for (const StepRecord& record : parse(writer.str()).records) again.add("plain", record);
  EXPECT_EQ(again.str(), writer.str());
}

TEST(StepLog, SeveralTracksOfOneTimeAndInnovationsWithoutMeasurementAreWritten) {
  StepLogWriter writer(angle_space(), 1);
  for (const double time_s : {1.0, 2.0})
    for (const int track : {0, 1}) {
      StepRecord record;
      record.space = &angle_space();
      record.time_s = time_s;
      record.track = track;
      record.x = Eigen::Vector2d(0.1 * track, time_s);
      record.P = Eigen::Matrix2d::Identity();
      record.innovation = Innovation{{}, BoundedVector::Constant(1, 0.5), BoundedMatrix::Constant(1, 1, 2.0), 0.125};
      writer.add("array", record);
    }
  EXPECT_THAT(writer.str(), HasSubstr(",,0.5,2\n")) << "no z, but nu and S";
  const StepLog log = parse(writer.str());
  EXPECT_EQ(log.space, &angle_space());
  ASSERT_EQ(log.records.size(), 4u);
  EXPECT_EQ(log.records[1].track, 1);
  EXPECT_EQ(log.records[1].time_s, 1.0);
  EXPECT_EQ(log.records[2].track, 0);
  EXPECT_EQ(log.records[3].x, Eigen::Vector2d(0.1, 2.0));
}

const std::string kHeader = "time_s,track,x_position_m,x_velocity_mps,P_1_1,P_1_2,P_2_2\n";

TEST(StepLog, OfAnotherProgramNeedsOnlyStateAndCovariance) {
  const StepLog log = parse(kHeader + "1,0,10,2,4,1,9\n2,0,12,2,4,1,9\n2,1,-5,0,4,0,9\n");
  EXPECT_FALSE(log.has_innovation);
  ASSERT_EQ(log.records.size(), 3u);
  EXPECT_EQ(log.records[0].x, Eigen::Vector2d(10.0, 2.0));
  EXPECT_EQ(log.records[0].P(1, 0), 1.0);
  EXPECT_EQ(log.records[0].status, StepStatus::ok);
  EXPECT_EQ(log.records[2].track, 1);
  EXPECT_FALSE(log.records[0].innovation);
}

TEST(StepLog, StateOfItsOwnBecomesAStateSpace) {
  const StepLog log = parse("time_s,track,x_range_m,P_1_1\n1,0,10,4\n");
  EXPECT_EQ(log.space->components, std::vector<std::string>{"range_m"});
}

TEST(StepLog, DecreasingTimeIsNamedWithItsLine) {
  EXPECT_THAT(error_of(kHeader + "1,0,10,2,4,1,9\n3,0,10,2,4,1,9\n2,0,12,2,4,1,9\n"),
              AllOf(HasSubstr("steps.csv:4"), HasSubstr("time_s"), HasSubstr("2 after 3")));
}

TEST(StepLog, TimeThatIsNoNumberIsRefused) {
  EXPECT_THAT(error_of(kHeader + "1,0,10,2,4,1,9\n,0,12,2,4,1,9\n"), HasSubstr("steps.csv:3"));
}

TEST(StepLog, CovarianceThatIsNoneIsRefused) {
  for (const char* P : {"4,100,9", "-4,0,9", "4,1,nan", "4,1,", "0,1,9"})
    EXPECT_THAT(error_of(kHeader + "1,0,10,2,4,1,9\n2,0,10,2," + P + "\n"),
                AllOf(HasSubstr("steps.csv:3"), HasSubstr("positive semi-definite")))
        << P;
}

TEST(StepLog, StateThatIsNotFiniteIsRefused) {
  EXPECT_THAT(error_of(kHeader + "1,0,nan,2,4,1,9\n"), AllOf(HasSubstr("steps.csv:2"), HasSubstr("finite")));
}

TEST(StepLog, MissingColumnsAreListed) {
  EXPECT_THAT(error_of("track,x_position_m,P_1_1\n0,1,1\n"), HasSubstr("time_s"));
  EXPECT_THAT(error_of("time_s,x_position_m,P_1_1\n0,1,1\n"), HasSubstr("track"));
  EXPECT_THAT(error_of("time_s,track,P_1_1\n0,0,1\n"), HasSubstr("x_<component>"));
  EXPECT_THAT(error_of("time_s,track,x_position_m,x_velocity_mps,P_1_1,P_2_2\n"), HasSubstr("P_1_1 to P_2_2"));
}

TEST(StepLog, TextWhereANumberBelongsIsRefused) {
  EXPECT_THAT(error_of(kHeader + "1,0,ten,2,4,1,9\n"), AllOf(HasSubstr("steps.csv:2"), HasSubstr("x_position_m")));
  for (const char* track : {"0.5", "-1", "nan", "1e30"})
    EXPECT_THAT(error_of(kHeader + "1," + track + ",10,2,4,1,9\n"),
                AllOf(HasSubstr("steps.csv:2"), HasSubstr("track")));
  EXPECT_THAT(error_of("time_s,track,status,x_range_m,P_1_1\n1,0,fine,10,4\n"), HasSubstr("coasted"));
}

TEST(StepLog, TrackerThatIsNotInItIsRefused) {
  EXPECT_THAT(error_of(kHeader + "1,0,10,2,4,1,9\n", "mine"), AllOf(HasSubstr("mine"), HasSubstr("tracker")));
  EXPECT_THAT(error_of("time_s,tracker,track,x_range_m,P_1_1\n1,theirs,0,10,4\n", "mine"), HasSubstr("mine"));
  EXPECT_THAT(error_of(kHeader), HasSubstr("no rows"));
}

TEST(StepLog, TooManyComponentsAreRefused) {
  std::string header = "time_s,track", row = "1,0";
  for (int i = 1; i <= 11; ++i) {
    header += ",x_c" + std::to_string(i);
    row += ",1";
  }
  EXPECT_THAT(error_of(header + "\n" + row + "\n"), HasSubstr("1 to 10"));
  header = "time_s,track,x_range_m,P_1_1";
  row = "1,0,1,1";
  for (const char* name : {"z", "nu"})
    for (int i = 1; i <= 11; ++i) {
      header += "," + std::string(name) + "_" + std::to_string(i);
      row += ",1";
    }
  EXPECT_THAT(error_of(header + "\n" + row + "\n"), HasSubstr("at most 10"));
}

TEST(StepLog, InnovationsOfTwoSizesAreTheirSensors) {
  StepLogWriter writer(line_space(), StepLogWriter::Columns{2, {"long", "short"}, false});
  std::vector<StepRecord> records(3);
  for (std::size_t k = 0; k < records.size(); ++k) {
    StepRecord& record = records[k];
    const int size = k == 1 ? 1 : 2;
    record.time_s = static_cast<double>(k);
    record.space = &line_space();
    record.x = Eigen::Vector2d(1.0, 2.0);
    record.P = Eigen::Matrix2d::Identity();
    record.source = size == 1 ? 1 : 0;
    record.innovation = Innovation{BoundedVector::Constant(size, 5.0), BoundedVector::Constant(size, 0.5),
                                   BoundedMatrix::Identity(size, size), 0.25 * size};
    writer.add("mine", record);
  }
  const StepLog log = parse(writer.str());
  ASSERT_EQ(log.records.size(), 3u);
  for (std::size_t k = 0; k < records.size(); ++k) {
    EXPECT_EQ(log.records[k].source, records[k].source);
    EXPECT_EQ(log.records[k].innovation->nu, records[k].innovation->nu);
    EXPECT_EQ(log.records[k].innovation->S, records[k].innovation->S);
    EXPECT_DOUBLE_EQ(log.records[k].innovation->nis, records[k].innovation->nis);
    EXPECT_EQ(log.z[k].size(), records[k].innovation->z.size());
  }
}

TEST(StepLog, MeasurementAndTruthAreReadWhereTheyAre) {
  const StepLog log =
      parse("time_s,track,x_position_m,P_1_1,z_1,truth_position_m,truth_velocity_mps\n1,0,5,2,7,6,\n2,0,5,2,,6,1\n");
  EXPECT_FALSE(log.has_innovation);
  ASSERT_EQ(log.z.size(), 2u);
  EXPECT_EQ(log.z[0][0], 7.0);
  EXPECT_TRUE(std::isnan(log.z[1][0]));
  EXPECT_EQ(log.truth_components, (std::vector<std::string>{"position_m", "velocity_mps"}));
  EXPECT_EQ(log.truth[1][1], 1.0);
  EXPECT_TRUE(std::isnan(log.truth[0][1]));
  const StepLog bare = parse("time_s,track,x_position_m,P_1_1\n1,0,5,2\n");
  EXPECT_EQ(bare.z[0].size(), 0);
  EXPECT_TRUE(bare.truth_components.empty());
}

TEST(StepLog, RowsCanBePutInTheOrderOfTheirTimes) {
  StepLogWriter writer(line_space(), 0);
  StepRecord record;
  record.x = Eigen::Vector2d::Zero();
  record.P = Eigen::Matrix2d::Identity();
  for (const auto& [track, time_s] : {std::pair{1, 1.0}, {1, 2.0}, {2, 1.0}, {2, 2.0}}) {
    record.track = track;
    record.time_s = time_s;
    writer.add("any", record);
  }
  EXPECT_THAT(error_of(writer.str()), HasSubstr("do not decrease"));
  writer.sort_by_time();
  const StepLog log = parse(writer.str());
  ASSERT_EQ(log.records.size(), 4u);
  EXPECT_EQ(log.records[1].track, 2) << "rows of one time stay as they were added";
  EXPECT_EQ(log.records[2].track, 1);
}

// What `track --late` writes: 2.5 comes late, then 1.5, and what stands after each is written again, by both trackers.
TEST(StepLog, OfRevisedRowsTheLastIsRead) {
  const std::string text =
      "time_s,tracker,track,revised,x_position_m,P_1_1,z_1,nu_1,S_1_1,truth_position_m,sensor\n"
      "1,a,0,0,10,1,10,0,1,5,s\n1,b,0,0,11,1,11,0,1,5,s\n"
      "2,a,0,0,20,1,20,0,1,6,t\n2,b,0,0,21,1,21,0,1,6,t\n"
      "3,a,0,0,30,1,30,0,1,7,s\n3,b,0,0,31,1,31,0,1,7,s\n"
      "2.5,a,0,0,25,1,25,0,1,8,t\n2.5,b,0,0,26,1,26,0,1,8,t\n"
      "3,a,0,1,32,1,30,0,1,7,s\n3,b,0,1,33,1,31,0,1,7,s\n"
      "1.5,a,0,0,15,1,15,0,1,9,s\n1.5,b,0,0,16,1,16,0,1,9,s\n"
      "2,a,0,1,22,1,20,0,1,6,t\n2,b,0,1,23,1,21,0,1,6,t\n"
      "2.5,a,0,1,27,1,25,0,1,8,t\n2.5,b,0,1,28,1,26,0,1,8,t\n"
      "3,a,0,1,34,1,30,0,1,7,s\n3,b,0,1,35,1,31,0,1,7,s\n"
      "4,a,0,0,40,1,40,0,1,9,s\n";
  std::istringstream stream(text);
  const StepLog a = read_step_log(stream, "log.csv", "a");
  ASSERT_EQ(a.records.size(), 6u);
  const std::vector<double> times_s{1, 1.5, 2, 2.5, 3, 4}, x_m{10, 15, 22, 27, 34, 40}, truth_m{5, 9, 6, 8, 7, 9};
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(a.records[k].time_s, times_s[k]);
    EXPECT_EQ(a.records[k].x[0], x_m[k]);
    EXPECT_EQ(a.truth[k][0], truth_m[k]);
    EXPECT_EQ(a.records[k].source, k == 2 || k == 3) << k;
  }
  EXPECT_EQ(a.z.size(), 6u);
  EXPECT_EQ(parse(text).records.size(), 11u) << "of both";
  // A late row that a tracker has no record of is followed by revised ones all the same.
  const std::string header = "time_s,track,revised,x_position_m,P_1_1\n";
  const StepLog silent = parse(header + "1,0,0,10,1\n2,0,0,20,1\n2,0,0,21,1\n2,0,1,22,1\n2,0,1,23,1\n");
  ASSERT_EQ(silent.records.size(), 3u);
  EXPECT_EQ(silent.records[1].x[0], 22.0);
  EXPECT_EQ(silent.records[2].x[0], 23.0) << "two measurements of one time";
  EXPECT_THAT(error_of("time_s,track,x_position_m,P_1_1\n2,0,10,1\n1,0,10,1\n"), HasSubstr("do not decrease"));
  EXPECT_THAT(error_of(header + "2,0,0,10,1\nnan,0,0,10,1\n"), HasSubstr("do not decrease"));
}

TEST(StepLog, RowsCanBeTakenAsTheyCome) {
  StepLogWriter whole(line_space(), 1), pieces(line_space(), 1);
  std::string text;
  for (const StepRecord& record : records_of_a_tracker()) {
    whole.add("plain", record);
    pieces.add("plain", record);
    text += pieces.take();
  }
  EXPECT_EQ(text, whole.str());
  EXPECT_EQ(pieces.take(), "");
}

TEST(StepLog, InnovationOfFewerComponentsFillsTheFirst) {
  StepLogWriter writer(line_space(), 2);
  writer.add("plain", records_of_a_tracker()[0]);
  EXPECT_THAT(writer.str(), ::testing::ContainsRegex("\n1,plain(,[^,\n]+){7},[^,\n]+,,[^,\n]+,,[^,\n]+,,\n"));
}

}  // namespace
}  // namespace truebearing::step_log_test
