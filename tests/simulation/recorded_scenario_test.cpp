#include "truebearing/simulation/recorded_scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/measurement/recording_csv.hpp"

namespace truebearing {
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
      error_message([] { RecordedScenario(read("time_s,range_m,truth_east_m,truth_north_m\n0,1,2,3\n"), 1.0); }),
      HasSubstr("range_m"));
}

}  // namespace
}  // namespace truebearing
