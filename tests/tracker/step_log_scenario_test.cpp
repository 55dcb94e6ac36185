// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/step_log_scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "tests/support/error_message.hpp"
#include "tests/support/temporary_folder.hpp"

namespace truebearing::step_log_scenario_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

// A log whose first position is `x`.
std::string log_of(double x, bool truth = true) {
  return fmt::format("time_s,track,x_position_m,x_velocity_mps,P_1_1,P_1_2,P_2_2{}\n1,0,{},2,4,1,9{}\n",
                     truth ? ",truth_position_m" : "", x, truth ? ",0" : "");
}

std::unique_ptr<Scenario> scenario(const TemporaryFolder& folder, const std::string& toml) {
  return load_scenario(folder.write("scenario.toml", "kind = \"step_logs\"\nspace = \"line\"\n" + toml),
                       {{"step_logs", read_step_log_scenario}});
}

double first_position(const Scenario& logs, Role role, std::uint64_t run) {
  return logs.simulate({1, role, run}).measurements.at(0).recorded->x[0];
}

TEST(StepLogScenario, RunsReplayTheLogsOfTheirRoleInTurn) {
  const TemporaryFolder folder;
  for (int k = 1; k <= 3; ++k) folder.write(fmt::format("logs/teach_{}.csv", k), log_of(k));
  folder.write("new.csv", log_of(10));
  const auto logs =
      scenario(folder, "training = [\"logs/teach_*.csv\"]\nevaluation = [\"new.csv\", \"logs/teach_2.csv\"]\n");
  EXPECT_EQ(&logs->truth_space(), &line_space());
  for (std::uint64_t run = 0; run < 7; ++run) {
    const double expected = 1.0 + static_cast<double>(run % 3);
    for (const Role role : {Role::training, Role::tuning, Role::validation})
      EXPECT_EQ(first_position(*logs, role, run), expected);
    EXPECT_EQ(first_position(*logs, Role::evaluation, run), run % 2 == 0 ? 10.0 : 2.0);
  }
  EXPECT_EQ(logs->different_runs(Role::training), 3u);
  EXPECT_EQ(logs->different_runs(Role::evaluation), 2u);
  EXPECT_THAT(logs->note(), HasSubstr("recorded tracks: 2, a run each"));
}

TEST(StepLogScenario, ValidationMayHaveLogsOfItsOwn) {
  const TemporaryFolder folder;
  folder.write("a.csv", log_of(1));
  folder.write("b.csv", log_of(2));
  const auto logs = scenario(folder, "training = [\"a.csv\"]\nvalidation = [\"b.csv\"]\nevaluation = [\"a.csv\"]\n");
  EXPECT_EQ(first_position(*logs, Role::validation, 0), 2.0);
  EXPECT_EQ(first_position(*logs, Role::tuning, 0), 1.0);
}

TEST(StepLogScenario, FilesAreReadWhenARunNeedsThem) {
  const TemporaryFolder folder;
  folder.write("new.csv", log_of(10));
  const auto logs =
      scenario(folder, "training = [\"gone_*.csv\"]\nvalidation = [\"gone.csv\"]\nevaluation = [\"new.csv\"]\n");
  EXPECT_EQ(first_position(*logs, Role::evaluation, 0), 10.0);
  EXPECT_THAT(error_message([&] { first_position(*logs, Role::training, 0); }),
              AllOf(HasSubstr("gone_*.csv"), HasSubstr("matches no file")));
  EXPECT_THAT(error_message([&] { first_position(*logs, Role::validation, 0); }), HasSubstr("gone.csv"));
}

TEST(StepLogScenario, LogsThatDoNotFitAreRefused) {
  const TemporaryFolder folder;
  folder.write("bare.csv", log_of(1, false));
  folder.write("good.csv", log_of(1));
  const auto bare = scenario(folder, "training = [\"bare.csv\"]\nevaluation = [\"good.csv\"]\n");
  EXPECT_THAT(error_message([&] { first_position(*bare, Role::training, 0); }),
              AllOf(HasSubstr("bare.csv"), HasSubstr("truth_<component>")));
  auto& logs = dynamic_cast<StepLogScenario&>(*bare);
  EXPECT_EQ(logs.read(folder.path() / "bare.csv").size(), 1u) << "to apply a correction needs no truth";
  logs.require_innovation();
  EXPECT_THAT(error_message([&] { logs.read(folder.path() / "good.csv"); }),
              AllOf(HasSubstr("good.csv"), HasSubstr("innovation = false")));
  const auto plane = load_scenario(
      folder.write("plane.toml", "kind = \"step_logs\"\ntraining = [\"good.csv\"]\nevaluation = [\"good.csv\"]\n"),
      {{"step_logs", read_step_log_scenario}});
  EXPECT_THAT(error_message([&] { first_position(*plane, Role::evaluation, 0); }),
              AllOf(HasSubstr("position_m, velocity_mps"), HasSubstr("east_m, north_m")));
}

TEST(StepLogScenario, OneTrackerOfALogOfSeveral) {
  const TemporaryFolder folder;
  folder.write(
      "both.csv",
      "time_s,tracker,track,x_position_m,x_velocity_mps,P_1_1,P_1_2,P_2_2,truth_position_m\n1,a,0,5,2,4,1,9,0\n1,b,0,6,2,4,1,9,0\n");
  const auto logs = scenario(folder, "tracker = \"b\"\ntraining = [\"both.csv\"]\nevaluation = [\"both.csv\"]\n");
  EXPECT_EQ(first_position(*logs, Role::evaluation, 0), 6.0);
}

TEST(StepLogScenario, KeysAreChecked) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_message([&] { scenario(folder, "evaluation = [\"a.csv\"]\n"); }), HasSubstr("training"));
  EXPECT_THAT(error_message([&] { scenario(folder, "training = []\nevaluation = [\"a.csv\"]\n"); }),
              HasSubstr("names no file"));
  EXPECT_THAT(error_message([&] { scenario(folder, "training = [\"a\"]\nevaluation = [\"a\"]\nevaluate = 1\n"); }),
              HasSubstr("did you mean \"evaluation\""));
  EXPECT_THAT(error_message([&] {
                load_scenario(folder.write("s.toml", "kind = \"step_log\"\n"), {{"step_logs", read_step_log_scenario}});
              }),
              HasSubstr("step_logs"));
}

}  // namespace
}  // namespace truebearing::step_log_scenario_test
