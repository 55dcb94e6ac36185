// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "tests/app/program_tests.hpp"

namespace truebearing::app_test::new_study_test {
namespace {

class NewStudyOfKind : public ::testing::TestWithParam<const char*> {};

// By its tuned trackers and untaught corrections: those in memory, with little of everything.
TEST_P(NewStudyOfKind, IsValidAndItsTrackersRun) {
  const TemporaryFolder folder;
  const std::string kind = GetParam();
  const Outcome made = run(folder, "new " + kind);
  EXPECT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("truebearing learn " + kind + ".toml --report " + kind + ".html"));
  const Outcome checked = run(folder, "check " + kind + ".toml");
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("nfnn"));
  folder.write("quick.toml", "name = \"quick\"\nlike = \"" + kind +
                                 ".toml\"\n[tuning]\nruns = 5\n[trackers.nfnn.training]\nruns = 60\nrules = "
                                 "4\niterations = 3\n" +
                                 (folder.read(kind + ".toml").find("\ntune = ") == std::string::npos
                                      ? ""
                                      : "[trackers.imm_nfnn.training]\nruns = 60\nrules = 4\niterations = 3\n"));
  const Outcome compared = run(folder, "compare quick.toml --retrain --runs 3 --quiet");
  EXPECT_EQ(compared.status, 0) << compared.err;
  EXPECT_THAT(compared.out, HasSubstr("nfnn"));
}

INSTANTIATE_TEST_SUITE_P(Kinds, NewStudyOfKind,
                         ::testing::Values("radar", "polar", "bearings", "sonar", "array", "flight"),
                         [](const auto& test) { return std::string(test.param); });

TEST(NewStudy, TakesSensorPeriodAndSpeedsFromItsOptions) {
  const TemporaryFolder folder;
  EXPECT_EQ(run(folder, "new radar -o mine.toml --sigma 35.5 --period 4 --speeds 20 60").status, 0);
  const std::string study = folder.read("mine.toml");
  EXPECT_THAT(study, HasSubstr("sensor = { position_sigma_m = 35.5 }"));
  EXPECT_THAT(study, HasSubstr("measurement = { model = \"position\", sigma_m = 35.5 }"));
  EXPECT_THAT(study, HasSubstr("\nperiod_s = 4 "));
  EXPECT_THAT(study, HasSubstr("to_first = 0.7, period_s = 4 }"));
  EXPECT_THAT(study, HasSubstr("speed_mps = { uniform = [20, 60] }"));
  EXPECT_THAT(study, HasSubstr("name = \"mine\"\n"));
  EXPECT_THAT(study, HasSubstr("\"mine.nfnn.json\""));
  EXPECT_THAT(study, Not(HasSubstr("\"radar")));
  EXPECT_EQ(run(folder, "check mine.toml").status, 0);
  EXPECT_EQ(run(folder, "new polar -o polar.toml --sigma 40 0.2").status, 0);
  EXPECT_THAT(folder.read("polar.toml"), HasSubstr("range_sigma_m = 40, bearing_sigma_deg = 0.2 }   # --sigma"));
  EXPECT_THAT(run(folder, "new radar -o b.toml --sigma 40 0.2").err, HasSubstr("truebearing new polar"));
  EXPECT_EQ(run(folder, "new sonar -o sonar.toml --sigma 2 0.1").status, 0);
  EXPECT_THAT(folder.read("sonar.toml"), HasSubstr("bearing_sigma_deg = 2, frequency_sigma_hz = 0.1 }   # --sigma"));
}

TEST(NewStudy, WhatMakesNoSenseIsRefusedAndNothingIsReplaced) {
  const TemporaryFolder folder;
  folder.write("radar.toml", "mine");
  EXPECT_THAT(run(folder, "new radar").err, HasSubstr("is there already"));
  EXPECT_EQ(folder.read("radar.toml"), "mine");
  for (const char* arguments :
       {"new radar -o a.toml --sigma 0", "new radar -o a.toml --sigma 1 2", "new sonar -o a.toml --sigma 1",
        "new array -o a.toml --sigma 1", "new radar -o a.toml --speeds 60 20"}) {
    const Outcome outcome = run(folder, arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
  }
  EXPECT_EQ(run(folder, "new submarine").status, 2);
  EXPECT_EQ(run(folder, "new flight -o a.toml --period nan").status, 2);
  EXPECT_EQ(folder.files(), 1);
}

}  // namespace
}  // namespace truebearing::app_test::new_study_test
