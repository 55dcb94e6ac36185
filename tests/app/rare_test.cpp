// SPDX-License-Identifier: Apache-2.0
// truebearing rare, as a user calls it.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/app/program_tests.hpp"

namespace truebearing::app_test::rare_test {
namespace {

TEST(Rare, TellsTheLossRateWithItsErrorAndCountsPlainRunsBesideIt) {
  const TemporaryFolder folder;
  write_study(folder, tuned_study());
  const Outcome outcome = run(
      folder,
      "rare small.toml plain --loss position_m=4000 --draws 100 --repetitions 12 --plain 4000 --json rare.json --quiet");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr("plain of small: lost, its last error in position_m beyond 4000, with probability "));
  EXPECT_THAT(outcome.out, HasSubstr("12 repetitions of "));
  EXPECT_THAT(outcome.out, HasSubstr("4000 plain runs: "));
  const nlohmann::json json = nlohmann::json::parse(folder.read("rare.json"));
  const double rate = json["loss_rate"], se = json["loss_rate_se"], plain = json["plain"]["loss_rate"],
               plain_se = json["plain"]["loss_rate_se"];
  EXPECT_EQ(json["repetitions"].size(), 12u);
  EXPECT_EQ(json["loss_thresholds"]["position_m"], 4000.0);
  EXPECT_EQ(json["levels"].back()["probability"], rate);
  EXPECT_GT(rate, 0.0);
  EXPECT_LT(std::abs(rate - plain), 4.0 * std::hypot(se, plain_se));

  EXPECT_EQ(
      run(folder, "rare small.toml plain --loss position_m=4000 --draws 100 --repetitions 2 --json -").out,
      run(folder, "rare small.toml plain --loss position_m=4000 --draws 100 --repetitions 2 --threads 1 --json -").out);
}

TEST(Rare, OfWhatWasNotFoundItDoesNotSayThatItIsImpossible) {
  const TemporaryFolder folder;
  write_study(folder, tuned_study());
  const Outcome outcome =
      run(folder, "rare small.toml plain --loss position_m=6500 --draws 30 --repetitions 2 --seed 3 --json none.json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("was not found"), HasSubstr("no repetition found a loss"), Not(HasSubstr("+- 0"))));
  EXPECT_TRUE(nlohmann::json::parse(folder.read("none.json"))["loss_rate_se"].is_null());
}

TEST(Rare, WhatCannotBeToldIsRefused) {
  const TemporaryFolder folder;
  write_study(folder, tuned_study());
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Outcome outcome = run(folder, "rare " + arguments);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(message));
  };
  refused("small.toml tund", "tuned");
  refused("small.toml plain --loss speed=3", "--loss: \"speed\" is no quantity of plain");
  refused("small.toml plain --loss position_m", "--loss: is \"position_m\"; valid: QUANTITY=ERROR, as position_m=1000");
  refused("small.toml plain --loss position_m=-1", "--loss: is \"position_m=-1\"");
  refused("small.toml plain --set other", "--set: \"other\" is no set of the study");
  refused("small.toml plain --json small.toml", "small.toml");
  folder.write("none.toml", replaced(tuned_study(), "loss_thresholds = { position_m = 20000.0 }", ""));
  refused("none.toml plain", "scoring.loss_thresholds: say of no quantity of plain when it is lost");
}

}  // namespace
}  // namespace truebearing::app_test::rare_test
