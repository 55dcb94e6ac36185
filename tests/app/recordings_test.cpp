// SPDX-License-Identifier: Apache-2.0
// Recordings as they come, given to the program.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/app/program_tests.hpp"

namespace truebearing::app_test::recordings_test {
namespace {

TEST(ProgramRecordings, CheckSaysWhatALogHolds) {
  const TemporaryFolder folder;
  folder.write("log.csv", "# export\ntime_ms;range_km;remark\n0;1,5;a\n1000;NA;b\n2000;1,75;c\n");
  const Outcome text = run(folder, "check log.csv");
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("measured range_m"), HasSubstr("left out"), HasSubstr("can be used")));
  const Outcome json = run(folder, "check log.csv --json -");
  const auto report = nlohmann::json::parse(json.out);
  EXPECT_EQ(report["usable"], true);
  EXPECT_EQ(report["left_out"], nlohmann::json({"remark"}));
  EXPECT_EQ(report["columns"][1]["missing"], 1);
  EXPECT_EQ(report["period_s"]["median"], 1.0);
}

TEST(ProgramRecordings, CheckSaysWhatAStepLogHolds) {
  const TemporaryFolder folder;
  write_study(folder, replaced(kStudy, "[trackers.nfnn]", "[trackers.nfnn]\nshow = false"));
  folder.write("log.csv", "time_s,position_m\n1,100\n2,110\n3,\n4,130\n");
  ASSERT_EQ(run(folder, "track small.toml log.csv -o steps.csv").status, 0);
  const Outcome whole = run(folder, "check steps.csv");
  EXPECT_EQ(whole.status, 0) << whole.err;
  EXPECT_THAT(whole.out, AllOf(HasSubstr("step log"), HasSubstr("8 records of 1 track, from 1 to 4 s"),
                               HasSubstr("trackers: plain, tuned\n"), HasSubstr("states: position_m, velocity_mps;")));
  folder.write("broken.csv", "time_s,track,x_position_m,x_velocity_mps,P_1_1,P_1_2,P_2_2\n1,0,1,1,1,0,-1\n");
  const Outcome broken = run(folder, "check broken.csv");
  EXPECT_EQ(broken.status, 1);
  EXPECT_THAT(broken.err, AllOf(HasSubstr("broken.csv:2"), HasSubstr("P is not")));
  EXPECT_EQ(run(folder, "check steps.csv --json -").status, 1);
}

TEST(ProgramRecordings, CheckRefusesWhatCannotBeUsed) {
  const TemporaryFolder folder;
  folder.write("log.csv", "time_s,bearng_deg\n0,1\n");
  const Outcome outcome = run(folder, "check log.csv");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("did you mean \"bearing_deg\""));
  EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
}

// What counts twice would make figures look surer than they are.
TEST(ProgramRecordings, ALogThatCannotBeMeasuredAfreshIsOneRun) {
  const TemporaryFolder folder;
  write_study(folder, tuned_study());
  std::string bare = "time_s,position_m,truth_position_m,truth_velocity_mps\n";
  std::string with_sigma = "time_s,position_m,position_sigma_m,truth_position_m,truth_velocity_mps\n";
  for (int k = 1; k <= 20; ++k) {
    bare += fmt::format("{},{},{},100\n", k, 100 * k + k % 3, 100 * k);
    with_sigma += fmt::format("{},{},9,{},100\n", k, 100 * k + k % 3, 100 * k);
  }
  folder.write("bare.csv", bare);
  folder.write("with_sigma.csv", with_sigma);
  const auto runs = [&](const char* log, const char* note) {
    const Outcome outcome = run(folder, fmt::format("compare small.toml --truth {} --runs 30 --json out.json", log));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr(note));
    return nlohmann::json::parse(folder.read("out.json"))["runs"].get<int>();
  };
  EXPECT_EQ(runs("bare.csv", "runs: 1 in place of 30, which would be the same again"), 1);
  EXPECT_EQ(runs("with_sigma.csv", "30 runs"), 30);
}

TEST(ProgramRecordings, WhatIsScoredBehindTheLastStepIsSaidToBe) {
  const TemporaryFolder folder;
  write_study(folder, replaced(tuned_study(), "[scoring]", "[scoring]\nfrom_step = 9000"));
  EXPECT_THAT(run(folder, "compare small.toml --runs 3").out, HasSubstr("It is scored from step 9000 on, and"));
}

TEST(ProgramRecordings, MessagesLeaveTheTerminalAlone) {
  const TemporaryFolder folder;
  folder.write("wild.csv", "\x1b[31mtime\x1b]0;owned\a,position_m\n1,2\n");
  folder.write("unit.csv", "time_s,\x1b[2Jposition\n1,2\n");
  folder.write("long.csv", "time_s," + std::string(900'000, 'p') + "\n1,2\n");
  folder.write("zero.csv", std::string("t\0i\0", 4));
  for (const char* file : {"wild.csv", "unit.csv", "long.csv", "zero.csv"}) {
    const Outcome outcome = run(folder, std::string("tma ") + file);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
    EXPECT_LE(outcome.err.size(), 201u);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(file), Not(HasSubstr("\x1b"))));
  }
}

TEST(ProgramRecordings, MissingTrackIsSaidToBeMissing) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run(folder, std::string("simulate ") + TRUEBEARING_SOURCE_DIR +
                      "/data/scenarios/bearings_of_a_vessel.toml --track MISSING.csv --track-id 33 -o out");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("MISSING.csv"), HasSubstr("cannot be opened")));
}

TEST(ProgramRecordings, TmaTakesOtherNamesAndUnits) {
  const TemporaryFolder folder;
  std::string plain = "time_s,bearing_deg,sensor_east_m,sensor_north_m,bearing_sigma_deg\n";
  std::string other = "t\tazimuth\tsensor_east_km\tsensor_north_km\tbearing_sigma_deg\tnote\n";
  for (int k = 0; k < 60; ++k) {
    const double bearing_deg = 40.0 + 0.3 * k - (k > 30 ? 0.5 * (k - 30) : 0.0);
    const int east_m = 20 * k, north_m = k > 30 ? 40 * (k - 30) : 0;
    plain += fmt::format("{},{:.4f},{},{},1\n", 10 * k, bearing_deg, east_m, north_m);
    other += fmt::format("{}\t{:.4f}\t{}\t{}\t1\tx\n", 10 * k, bearing_deg, 0.001 * east_m, 0.001 * north_m);
  }
  folder.write("plain.csv", plain);
  folder.write("other.tsv", other);
  const Outcome expected = run(folder, "tma - < plain.csv");
  const Outcome mapped = run(folder, "tma - --columns t=time_s,azimuth=bearing_deg < other.tsv");
  EXPECT_EQ(expected.status, 0) << expected.err;
  EXPECT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_EQ(mapped.out, expected.out);
  EXPECT_EQ(mapped.err, "truebearing: -: columns left out: note\n");
}

}  // namespace
}  // namespace truebearing::app_test::recordings_test
