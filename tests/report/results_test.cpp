// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_message.hpp"
#include "tests/support/result_texts.hpp"

namespace truebearing::results_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;
using testing::ResultJson;
using testing::results_json;

std::string error_of(const std::string& text) {
  return error_message([&] { parse_results(text, "r.json"); });
}

TEST(Results, KeepTheStudysOrderAndItsFigures) {
  const Results results = parse_results(results_json().dump(), "r.json");
  ASSERT_EQ(results.all.trackers.size(), 3u);
  EXPECT_EQ(results.all.trackers[0].name, "tuned") << "not in the order of the alphabet";
  EXPECT_EQ(results.all.trackers[1].name, "nfnn");
  EXPECT_TRUE(results.all.trackers[1].corrected);
  EXPECT_TRUE(results.all.trackers[2].is_bound);
  EXPECT_TRUE(results.all.bounds.empty()) << "it is a tracker";
  const ResultQuantity* position = results.all.trackers[1].quantity("position_m");
  ASSERT_NE(position, nullptr);
  EXPECT_EQ(position->rmse, 86.0);
  EXPECT_TRUE(std::isnan(position->series[0])) << "null is not known";
  EXPECT_EQ(position->run_rmse.size(), 3u);
  ASSERT_EQ(results.all.pairs.size(), 1u);
  EXPECT_EQ(results.all.pairs[0].mean, -14.4);
  ASSERT_EQ(results.pictures.size(), 1u);
  EXPECT_EQ(results.pictures[0].tracks[0].xy[0], 50.0);
}

TEST(Results, WithoutDetailsAreReadToo) {
  const Results results = parse_results(results_json(false).dump(), "r.json");
  EXPECT_TRUE(results.all.trackers[0].quantity("position_m")->run_rmse.empty());
  EXPECT_TRUE(results.pictures.empty());
}

TEST(Results, AtFaultSayWhichFileAndWhere) {
  EXPECT_THAT(error_of("{}"), AllOf(HasSubstr("r.json"), HasSubstr("\"study\"")));
  EXPECT_THAT(error_of("[1]"), HasSubstr("r.json"));
  EXPECT_THAT(error_of("no JSON"), HasSubstr("r.json:1"));
  ResultJson json = results_json();
  json["trackers"]["nfnn"]["rmse"]["position_m"] = "much";
  EXPECT_THAT(error_of(json.dump()), HasSubstr("r.json: trackers.nfnn.rmse.position_m: is no number"));
  json = results_json();
  json["pictures"][0]["tracks"][0]["yy"] = {1.0};
  EXPECT_THAT(error_of(json.dump()), HasSubstr("pictures[0].tracks[0]: has columns of unequal length"));
  json = results_json();
  for (const char* column : {"x", "xx", "xy"}) json["pictures"][0]["tracks"][0].erase(column);
  EXPECT_THAT(error_of(json.dump()), HasSubstr("pictures[0].tracks[0]: and the truth are not both in the plane"));
  json = results_json();
  json["trackers"] = ResultJson::object();
  EXPECT_THAT(error_of(json.dump()), HasSubstr("no tracker"));
  json = results_json();
  json["paired"]["nfnn"] = ResultJson::object();
  EXPECT_THAT(error_of(json.dump()), HasSubstr("paired.nfnn"));
}

}  // namespace
}  // namespace truebearing::results_test
