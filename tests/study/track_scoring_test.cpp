#include "truebearing/study/track_scoring.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/radar_study.hpp"
#include "truebearing/core/angle.hpp"
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

std::optional<AngleBound> bound(const std::string& text, const StateSpace& truth = angle_space()) {
  const toml::table table = parse_toml(text, "study.toml");
  TableReader reader(table, "study.toml", "scoring");
  const std::optional<AngleBound> read = read_angle_bound(reader, truth);
  reader.finish();
  return read;
}

TEST(AngleBoundScoring, AllKeys) {
  const auto found = bound("angle_bound = { q_deg2ps3 = 0.5, rate_sigma_degps = 3.0, apart_deg = 8.0 }");
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(found->q_rad2ps3, 0.5 * radians(1.0) * radians(1.0));
  EXPECT_DOUBLE_EQ(found->rate_sigma_radps, radians(3.0));
  EXPECT_DOUBLE_EQ(found->apart_rad, radians(8.0));
  EXPECT_FALSE(bound(""));
  const auto plain = bound("angle_bound = {}");
  ASSERT_TRUE(plain);
  EXPECT_DOUBLE_EQ(plain->q_rad2ps3, AngleBound{}.q_rad2ps3);
  EXPECT_DOUBLE_EQ(plain->rate_sigma_radps, AngleBound{}.rate_sigma_radps);
  EXPECT_DOUBLE_EQ(plain->apart_rad, AngleBound{}.apart_rad);
}

TEST(AngleBoundScoring, WhatCannotBeIsRefused) {
  const auto refused = [](const std::string& text, const StateSpace& truth = angle_space()) {
    return error_message([&] { bound(text, truth); });
  };
  EXPECT_THAT(refused("angle_bound = {}", plane_space()), AllOf(HasSubstr("scoring.angle_bound"), HasSubstr("plane")));
  EXPECT_THAT(refused("angle_bound = { q_deg2ps3 = 0.0 }"), HasSubstr("scoring.angle_bound.q_deg2ps3"));
  EXPECT_THAT(refused("angle_bound = { rate_sigma_deg = 1.0 }"), HasSubstr("did you mean \"rate_sigma_degps\""));
}

TEST(AngleBoundScoring, InAStudy) {
  const testing::TemporaryFolder folder;
  const std::string scenarios = std::string(TRUEBEARING_SOURCE_DIR) + "/data/scenarios/";
  const auto loaded = [&](const std::string& scenario, const std::string& sets) {
    return Study::load(testing::write_study(
        folder, "name = \"angles\"\nscenario = \"" + scenarios + scenario + "\"\n" + sets +
                    "[scoring]\nangle_bound = { q_deg2ps3 = 0.04 }\n[trackers.joint]\nkind = \"joint_angles\"\n"
                    "targets = 5\nnoise_power = 1.0\nrate_sigma_degps = 2.0\nmotion = { q_deg2ps3 = 0.03 }\n"));
  };
  const std::string still = "array_a_5db.toml", moving = "array_a_moving_10db.toml";
  const auto set = [&](const std::string& scenario) {
    return "[sets]\nfirst = \"" + scenarios + still + "\"\nsecond = \"" + scenarios + scenario + "\"\n";
  };
  EXPECT_DOUBLE_EQ(loaded(still, "").comparison_options().angle_bound->q_rad2ps3, 0.04 * radians(1.0) * radians(1.0));
  EXPECT_TRUE(loaded(still, set("array_a_0db.toml")).comparison_options().angle_bound);
  EXPECT_THAT(error_message([&] { loaded(moving, ""); }),
              AllOf(HasSubstr("scoring.angle_bound"), HasSubstr("those of the scenario move")));
  EXPECT_THAT(error_message([&] { loaded(still, set(moving)); }),
              AllOf(HasSubstr("scoring.angle_bound"), HasSubstr("the set \"second\"")));
  EXPECT_THAT(error_message([&] { loaded(still, "[sets]\nlog = \"log.csv\"\n"); }),
              AllOf(HasSubstr("scoring.angle_bound"), HasSubstr("signal-to-noise"), HasSubstr("the set \"log\"")));
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
