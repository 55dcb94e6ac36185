// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/verdict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/result_texts.hpp"

namespace truebearing::verdict_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ResultJson;
using testing::results_json;

Results read(const ResultJson& json) {
  return parse_results(json.dump(), "r.json");
}

TEST(Verdict, AnswersWhatWasCompared) {
  const Results results = read(results_json());
  EXPECT_EQ(question(results), "Does nfnn err less than tuned? small, 3 runs, seed 5.");
  EXPECT_EQ(answer(results),
            "nfnn is 14 % below tuned in position (9 standard errors); 7.5 % above the bound bank in position; "
            "consistent (NEES 2.1, 2 expected).");
}

TEST(Verdict, AsksOfTheTrackerThatErrsLeast) {
  ResultJson json = results_json();
  const ResultJson pair = json["paired"]["nfnn - tuned"];
  json["paired"] = ResultJson::object();
  json["paired"]["tuned - nfnn"] = pair;
  json["paired"]["nfnn - tuned"] = pair;
  EXPECT_THAT(question(read(json)), HasSubstr("Does nfnn err less than tuned?"));
  EXPECT_THAT(answer(read(json)), HasSubstr("nfnn is 14 % below tuned"));
}

TEST(Verdict, IsNotOfATrackerWithoutAnError) {
  ResultJson json = results_json();
  const ResultJson pair = json["paired"]["nfnn - tuned"];
  json["trackers"]["tuned"]["rmse"]["position_m"] = nullptr;
  json["paired"] = ResultJson::object();
  json["paired"]["tuned - nfnn"] = pair;
  json["paired"]["nfnn - tuned"] = pair;
  EXPECT_THAT(question(read(json)), HasSubstr("Does nfnn err less than tuned?"));
}

TEST(Verdict, SaysWhereNoDifferenceCanBeTold) {
  ResultJson json = results_json();
  json["paired"]["nfnn - tuned"]["position_m"]["se"] = 14.4;
  EXPECT_THAT(answer(read(json)), HasSubstr("no difference can be told"));
}

TEST(Verdict, NamesTheBestWhereNothingWasPaired) {
  ResultJson json = results_json();
  json["paired"] = ResultJson::object();
  EXPECT_THAT(question(read(json)), HasSubstr("Which tracker errs least?"));
  EXPECT_THAT(answer(read(json)), HasSubstr("nfnn has the least position error, RMSE 86 m, 14 % below tuned"));
}

TEST(Verdict, SaysWhoClaimsTooMuch) {
  ResultJson json = results_json();
  json["trackers"]["nfnn"]["nees"] = 20.0;
  EXPECT_THAT(answer(read(json)), HasSubstr("claims to know more than it does"));
  json["trackers"]["nfnn"]["nees"] = 0.01;
  EXPECT_THAT(answer(read(json)), HasSubstr("knows more than it claims"));
  json["trackers"]["nfnn"]["nees"] = nullptr;
  EXPECT_THAT(answer(read(json)), Not(HasSubstr("NEES")));
}

TEST(Verdict, ShareOfTheWayIsFromTheBaselineToTheBound) {
  EXPECT_EQ(share_of_the_way(90.0, 100.0, 80.0), 50.0);
  EXPECT_EQ(share_of_the_way(100.0, 100.0, 80.0), 0.0);
  EXPECT_TRUE(std::isnan(share_of_the_way(90.0, 80.0, 100.0))) << "no way up";
}

}  // namespace
}  // namespace truebearing::verdict_test
