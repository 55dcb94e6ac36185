// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/evaluation/corrected_set.hpp"
#include "tests/support/correction_models.hpp"
#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "truebearing/evaluation/report.hpp"
#include "truebearing/tracker/raw_tracker.hpp"

namespace truebearing::comparison_test {
namespace {

using nlohmann::json;
using testing::error_message;
using ::testing::HasSubstr;

TrackerSet trackers() {
  Ensemble ensemble = testing::radar_ensemble();
  ensemble.add(
      "raw", std::make_unique<RawTracker>(state_space_of_components({"position_m"}), BoundedVector::Constant(1, 3e3)));
  TrackerSet set(std::move(ensemble));
  for (const char* name : {"plain", "tuned", "raw"}) set.show_member(name);
  RandomStream random({}, StreamId::test);
  CorrectionModel model = testing::line_model(testing::radar_features(), testing::random_parameters(random, 4, 6, 2),
                                              "plain", "tuned", "wide");
  set.show_correction("nfnn", testing::shared(model), {});
  return set;
}

ComparisonOptions options(int threads) {
  ComparisonOptions made;
  made.seed = 3;
  made.runs = 24;
  made.threads = threads;
  made.pairs = {{"nfnn", "tuned"}, {"raw", "plain"}};
  made.bounds = {"tuned"};
  made.scoring.loss_thresholds = {{"position_m", 5000.0}};
  return made;
}

Comparison compared(int threads, bool two_sets = false) {
  const LineScenario scenario = testing::radar_family(40), longer = testing::radar_family(50);
  std::vector<NamedScenario> scenarios{{"family", &scenario}};
  if (two_sets) scenarios.push_back({"longer", &longer});
  Comparison comparison = compare(trackers(), scenarios, options(threads));
  comparison.study = "a study";
  return comparison;
}

TEST(Comparison, IsTheSameForAnyNumberOfThreadsByteForByte) {
  for (const bool two_sets : {false, true}) {
    const std::string one = comparison_json(compared(1, two_sets));
    EXPECT_EQ(comparison_json(compared(2, two_sets)), one);
    EXPECT_EQ(comparison_json(compared(8, two_sets)), one);
  }
}

TEST(Comparison, AnotherSeedOrRoleGivesOtherRuns) {
  const LineScenario scenario = testing::radar_family(40);
  ComparisonOptions other = options(1);
  const auto rmse = [&] {
    return compare(trackers(), {{"family", &scenario}}, other).tracker("plain")->quantities[0].rmse;
  };
  const double evaluation = rmse();
  other.role = Role::validation;
  EXPECT_NE(rmse(), evaluation);
  other.role = Role::evaluation;
  other.seed = 4;
  EXPECT_NE(rmse(), evaluation);
}

TEST(Comparison, JsonHasTheShapeThatOtherProgramsRead) {
  Comparison comparison = compared(2);
  comparison.ns_per_step = {{"plain", 12.5}};
  const json report = json::parse(comparison_json(comparison));
  EXPECT_EQ(report["study"], "a study");
  EXPECT_EQ(report["seed"], 3);
  EXPECT_EQ(report["runs"], 24);
  EXPECT_TRUE(report["version"].is_string());
  ASSERT_EQ(report["trackers"].size(), 4u);
  for (const auto& [name, tracker] : report["trackers"].items()) {
    for (const char* key : {"rmse", "rmse_se", "median", "ratio_to_plain"}) {
      EXPECT_TRUE(tracker[key]["position_m"].is_number()) << name << " " << key;
      EXPECT_EQ(tracker[key].contains("velocity_mps"), name != "raw") << name << " " << key;
    }
    for (const char* key : {"loss_rate", "nees", "coverage95"})
      EXPECT_TRUE(tracker[key].is_number()) << name << " " << key;
    EXPECT_TRUE(tracker["metrics"].is_array());
    EXPECT_EQ(tracker["series"]["time_s"].size(), 40u);
    EXPECT_EQ(tracker["series"]["rmse"]["position_m"].size(), 40u);
    EXPECT_EQ(tracker.contains("ns_per_step"), name == "plain");
  }
  EXPECT_EQ(report["trackers"]["plain"]["ratio_to_plain"]["position_m"], 1.0);
  EXPECT_EQ(report["bounds"]["tuned"]["position_m"], report["trackers"]["tuned"]["rmse"]["position_m"]);
  EXPECT_TRUE(report["bounds"]["tuned"]["series"].is_object());
  EXPECT_TRUE(report["paired"]["nfnn - tuned"]["velocity_mps"]["se"].is_number());
  EXPECT_FALSE(report["paired"]["raw - plain"].contains("velocity_mps"));
  EXPECT_FALSE(report.contains("sets"));
  EXPECT_TRUE(report["trackers"]["nfnn"]["correction"]["limited_share"].is_number());
}

TEST(Comparison, OfSeveralSetsHasEachAndAllTogether) {
  const json report = json::parse(comparison_json(compared(2, true)));
  ASSERT_EQ(report["sets"].size(), 2u);
  const double steps = report["trackers"]["plain"]["scored_steps"];
  EXPECT_EQ(steps, 24.0 * (40 + 50));
  const auto squares = [](const json& part) {
    const double rmse = part["trackers"]["plain"]["rmse"]["position_m"],
                 count = part["trackers"]["plain"]["scored_steps"];
    return rmse * rmse * count;
  };
  EXPECT_NEAR(squares(report), squares(report["sets"]["family"]) + squares(report["sets"]["longer"]),
              1e-9 * squares(report));
}

TEST(Comparison, TableHasARowForEveryTrackerAndPair) {
  const std::string table = comparison_table(compared(1));
  for (const char* text : {"a study: 24 runs, seed 3", "plain", "tuned", "raw", "nfnn", "nfnn - tuned", "raw - plain"})
    EXPECT_THAT(table, HasSubstr(text));
}

// (RMSE of tuned - RMSE) / (RMSE of tuned - RMSE of the bound), where both are there.
TEST(Comparison, SaysHowFarEachTrackerComesFromTunedToTheBound) {
  Comparison comparison = compared(1);
  EXPECT_FALSE(json::parse(comparison_json(comparison))["trackers"]["plain"].contains("share_of_way"))
      << "tuned is the bound itself";
  comparison.bounds = {"nfnn"};
  const auto rmse = [&](const char* name) -> double& {
    for (TrackerSummary& summary : comparison.trackers)
      if (summary.name == name) return summary.quantities[0].rmse;
    throw std::out_of_range(name);
  };
  rmse("tuned") = 100.0;
  rmse("nfnn") = 80.0;
  rmse("plain") = 90.0;
  rmse("raw") = 110.0;
  json trackers = json::parse(comparison_json(comparison))["trackers"];
  EXPECT_EQ(trackers["plain"]["share_of_way"]["position_m"], 0.5);
  EXPECT_EQ(trackers["tuned"]["share_of_way"]["position_m"], 0.0);
  EXPECT_EQ(trackers["nfnn"]["share_of_way"]["position_m"], 1.0);
  EXPECT_EQ(trackers["raw"]["share_of_way"]["position_m"], -0.5);
  for (const char* text : {"nfnn (bound)", "way to nfnn", "0.500", "-0.500"})
    EXPECT_THAT(comparison_table(comparison), HasSubstr(text));
  rmse("nfnn") = 101.0;
  trackers = json::parse(comparison_json(comparison))["trackers"];
  EXPECT_TRUE(trackers["plain"]["share_of_way"]["position_m"].is_null()) << "no way down";
}

TEST(Comparison, PairOfAnUnknownTrackerIsRefused) {
  const LineScenario scenario = testing::radar_family(5);
  ComparisonOptions bad = options(1);
  bad.pairs = {{"nfnn", "nobody"}};
  EXPECT_THAT(error_message([&] { compare(trackers(), {{"family", &scenario}}, bad); }), HasSubstr("nobody"));
}

TEST(Comparison, ProgressCountsTheRunsOfAllSets) {
  const LineScenario scenario = testing::radar_family(5);
  ComparisonOptions watched = options(2);
  std::size_t last = 0, total = 0;
  watched.progress = [&](std::size_t done, std::size_t all) { last = std::max(last, done), total = all; };
  compare(trackers(), {{"a", &scenario}, {"b", &scenario}}, watched);
  EXPECT_EQ(last, 48u);
  EXPECT_EQ(total, 48u);
}

TEST(TrackerSet, UnknownMemberIsRefused) {
  TrackerSet set{Ensemble{}};
  EXPECT_THAT(error_message([&] { set.show_member("plain"); }), HasSubstr("plain"));
}

}  // namespace
}  // namespace truebearing::comparison_test
