// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/metric_registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/angle_tracks.hpp"
#include "tests/support/error_message.hpp"
#include "tests/support/radar_study.hpp"
#include "truebearing/evaluation/track_metrics.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing::metric_registry_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;

ScoringRule read(const std::string& text, const StateSpace& truth = angle_space()) {
  const SharedTable table = parse_toml(text, "study.toml");
  TableReader reader(table, "study.toml", "scoring");
  ScoringRule rule;
  read_metrics(reader, truth, rule);
  reader.finish();
  return rule;
}

std::string refusal(const std::string& text, const StateSpace& truth = angle_space()) {
  return error_message([&] { read(text, truth); });
}

// What becomes of a track of a target at 0 degrees that says these angles.
TrackOutcome outcome(const ScoringRule& rule, const std::vector<double>& angles_deg) {
  Ensemble ensemble;
  ensemble.add("told", testing::told_tracker(testing::AnglesOfTracks{{0, angles_deg}}));
  TrackerSet set(std::move(ensemble));
  set.show_member("told");
  const Recording recording = testing::angle_recording({{0, std::vector<double>(angles_deg.size(), 0.0)}});
  return score_recording(set, {Scorer(angle_space(), angle_space())}, recording, rule)[0].of<TrackFigures>()->outcome;
}

TEST(MetricRegistry, WithoutAKeyThereAreTheUsualFamilies) {
  const ScoringRule rule = read("");
  EXPECT_EQ(rule.families.size(), usual_metrics().size());
  EXPECT_EQ(ScoringRule{}.families.size(), usual_metrics().size());
  EXPECT_FALSE(rule.assignment);
}

TEST(MetricRegistry, AllKeysOfTracks) {
  const ScoringRule rule = read("tracks = { quantity = \"angle_deg\", bad = 3.0, last_steps = 2, excursion = 6.0 }");
  EXPECT_EQ(rule.families.size(), usual_metrics().size() + 1);
  EXPECT_FALSE(rule.assignment);
  EXPECT_TRUE(outcome(rule, {5.9, 5.9, 5.9, 2.9, 2.9}).is_clean());
  EXPECT_TRUE(outcome(rule, {5.9, 5.9, 5.9, 3.1, 3.1}).is_loss()) << "bad";
  EXPECT_TRUE(outcome(rule, {6.1, 0.0, 0.0, 0.0, 0.0}).excursion);
  const ScoringRule five = read("tracks = { quantity = \"angle_deg\", bad = 3.0, excursion = 6.0 }");
  EXPECT_TRUE(outcome(five, {0.0, 5.0, 5.0, 5.0, 0.1, 0.1}).is_loss()) << "over five steps by default";
  EXPECT_TRUE(outcome(five, {5.0, 5.0, 5.0, 0.1, 0.1, 0.1}).is_clean());
}

TEST(MetricRegistry, AllKeysOfGospa) {
  const ScoringRule rule = read("gospa = { quantity = \"angle_deg\", cutoff = 5.0 }");
  EXPECT_EQ(rule.families.size(), usual_metrics().size() + 1);
  ASSERT_TRUE(rule.assignment);
  EXPECT_EQ(rule.assignment->quantity, "angle_deg");
  EXPECT_EQ(rule.assignment->cutoff, 5.0);
}

TEST(MetricRegistry, WhatCannotBeScoredIsRefused) {
  EXPECT_THAT(refusal("tracks = { quantity = \"angle_rad\", bad = 3.0, excursion = 6.0 }"),
              AllOf(HasSubstr("scoring.tracks.quantity"), HasSubstr("did you mean \"angle_deg\"")));
  EXPECT_THAT(refusal("gospa = { quantity = \"position_m\", cutoff = 3.0 }", plane_space()),
              AllOf(HasSubstr("scoring.gospa.quantity"), HasSubstr("one component")));
  EXPECT_THAT(refusal("tracks = { quantity = \"angle_deg\", bad = 0.0, excursion = 6.0 }"),
              HasSubstr("scoring.tracks.bad"));
  EXPECT_THAT(refusal("tracks = { quantity = \"angle_deg\", bad = 3.0 }"), HasSubstr("scoring.tracks.excursion"));
  EXPECT_THAT(refusal("tracks = { quantity = \"angle_deg\", bad = 3.0, excursion = 6.0, last_steps = 0 }"),
              HasSubstr("scoring.tracks.last_steps"));
  EXPECT_THAT(refusal("tracks = { quantity = \"angle_deg\", bad = 3.0, excursion = 6.0, last_step = 5 }"),
              HasSubstr("did you mean \"last_steps\""));
  EXPECT_THAT(refusal("gospa = { quantity = \"angle_deg\", cut = 5.0 }"), HasSubstr("scoring.gospa.cutoff"));
  EXPECT_THAT(refusal("tracks = { quantity = \"angle_deg\", bad = 3.0, excursion = 6.0 }\n"
                      "gospa = { quantity = \"angle_deg\", cutoff = 5.0 }"),
              HasSubstr("one of the two"));
  EXPECT_THAT(refusal("times_s = [1.0]\ngospa = { quantity = \"angle_deg\", cutoff = 5.0 }"),
              AllOf(HasSubstr("scoring.gospa"), HasSubstr("times_s")));
}

TEST(MetricRegistry, InAStudy) {
  const testing::TemporaryFolder folder;
  const auto loaded = [&](const std::string& more) {
    return Study::load(
        testing::write_study(folder, testing::replaced(testing::kStudy, "[scoring]\n", "[scoring]\n" + more)));
  };
  const std::string tracks = "tracks = { quantity = \"position_m\", bad = 5000.0, excursion = 20000.0 }\n";
  EXPECT_EQ(loaded(tracks).comparison_options().scoring.families.size(), usual_metrics().size() + 1);
  EXPECT_THAT(error_message([&] { loaded("times_s = [10.0]\n" + tracks); }),
              AllOf(HasSubstr("scoring.tracks"), HasSubstr("times_s")));
  EXPECT_THAT(error_message([&] { loaded("track = 1\n"); }), HasSubstr("did you mean \"tracks\""));
}

}  // namespace
}  // namespace truebearing::metric_registry_test
