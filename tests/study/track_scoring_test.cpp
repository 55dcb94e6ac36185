#include "truebearing/study/track_scoring.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/radar_study.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;

ScoringRule read(const std::string& text, const StateSpace& truth = angle_space()) {
  const toml::table table = parse_toml(text, "study.toml");
  TableReader reader(table, "study.toml", "scoring");
  ScoringRule rule;
  read_track_scoring(reader, truth, rule);
  reader.finish();
  return rule;
}

std::string refusal(const std::string& text, const StateSpace& truth = angle_space()) {
  return error_message([&] { read(text, truth); });
}

TEST(TrackScoring, AllKeys) {
  const ScoringRule tracks = read("tracks = { quantity = \"angle_deg\", bad = 3.0, last_steps = 7, excursion = 6.0 }");
  ASSERT_TRUE(tracks.tracks);
  EXPECT_EQ(tracks.tracks->quantity, "angle_deg");
  EXPECT_EQ(tracks.tracks->bad, 3.0);
  EXPECT_EQ(tracks.tracks->last_steps, 7);
  EXPECT_EQ(tracks.tracks->excursion, 6.0);
  EXPECT_FALSE(tracks.gospa);
  const ScoringRule gospa = read("gospa = { quantity = \"angle_deg\", cutoff = 5.0 }");
  ASSERT_TRUE(gospa.gospa);
  EXPECT_EQ(gospa.gospa->quantity, "angle_deg");
  EXPECT_EQ(gospa.gospa->cutoff, 5.0);
  EXPECT_FALSE(gospa.tracks);
}

TEST(TrackScoring, WhatIsNotAskedForIsNotThere) {
  const ScoringRule rule = read("");
  EXPECT_FALSE(rule.tracks || rule.gospa);
  EXPECT_EQ(read("tracks = { quantity = \"angle_deg\", bad = 3.0, excursion = 6.0 }").tracks->last_steps, 5);
}

TEST(TrackScoring, WhatCannotBeScoredIsRefused) {
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
}

TEST(TrackScoring, InAStudy) {
  const testing::TemporaryFolder folder;
  const auto loaded = [&](const std::string& more) {
    return Study::load(
        testing::write_study(folder, testing::replaced(testing::kStudy, "[scoring]\n", "[scoring]\n" + more)));
  };
  const std::string tracks = "tracks = { quantity = \"position_m\", bad = 5000.0, excursion = 20000.0 }\n";
  EXPECT_EQ(loaded(tracks).comparison_options().scoring.tracks->bad, 5000.0);
  EXPECT_THAT(error_message([&] { loaded("times_s = [10.0]\n" + tracks); }),
              AllOf(HasSubstr("scoring.tracks"), HasSubstr("times_s")));
  EXPECT_THAT(error_message([&] { loaded("track = 1\n"); }), HasSubstr("did you mean \"tracks\""));
}

TEST(TrackScoring, StepsLeftOutOfTrainingAreOfAQuantityOfTheTruth) {
  const testing::TemporaryFolder folder;
  const auto loaded = [&](const std::string& limit) {
    const std::string from = "[trackers.nfnn.training]\n";
    return Study::load(testing::write_study(
        folder, testing::replaced(testing::kStudy, from, from + "leave_out_beyond = { " + limit + " }\n")));
  };
  const Study study = loaded("position_m = 9000.0, velocity_mps = 300");
  const auto& limits = study.tracker("nfnn").correction->training.leave_out_beyond;
  const std::vector<std::pair<std::string, double>> wanted{{"position_m", 9000.0}, {"velocity_mps", 300.0}};
  EXPECT_EQ(limits, wanted);
  EXPECT_THAT(error_message([&] { loaded("angle_deg = 3.0"); }),
              HasSubstr("trackers.nfnn.training.leave_out_beyond.angle_deg"));
  EXPECT_THAT(error_message([&] { loaded("position_m = -3.0"); }), HasSubstr("leave_out_beyond.position_m"));
}

}  // namespace
}  // namespace truebearing
