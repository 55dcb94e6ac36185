// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/timed_scoring.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/radar_study.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/evaluation/metric_registry.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing::timed_scoring_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::error_message;
using ::testing::HasSubstr;

struct Read {
  TimedScoring timed;
  ScoringRule rule;
};

Read read(const std::string& text, const StateSpace& truth = plane_space()) {
  const SharedTable table = parse_toml(text, "study.toml");
  TableReader reader(table, "study.toml", "scoring");
  Read made;
  read_metrics(reader, truth, made.rule);
  made.timed = read_timed_scoring(reader, truth, made.rule);
  reader.finish();
  return made;
}

std::string refusal(const std::string& text, const StateSpace& truth = plane_space()) {
  return error_message([&] { read(text, truth); });
}

TEST(TimedScoring, AllKeys) {
  const Read made = read(
      "times_s = [280, 480.5]\ntarget_motion = true\nglobal_minimum = \"ml_225\"\n"
      "bound = { kind = \"cramer_rao\", q_m2ps3 = 9e-6, bearing_sigma_deg = 1.5, prior = { kind = \"range\", range_m = 6000.0, "
      "range_sigma_m = 2000.0, velocity_sigma_mps = 4.0 } }");
  EXPECT_THAT(made.rule.times_s, ElementsAre(280.0, 480.5));
  EXPECT_EQ(made.rule.families.size(), usual_metrics().size() + 1) << "the target's motion";
  EXPECT_EQ(made.timed.global_minimum, "ml_225");
  ASSERT_TRUE(made.timed.cramer_rao && made.timed.cramer_rao->prior);
  EXPECT_EQ(made.timed.cramer_rao->q_m2ps3, 9e-6);
  EXPECT_EQ(made.timed.cramer_rao->bearing_sigma_rad, radians(1.5));
  EXPECT_EQ(made.timed.cramer_rao->prior->range_sigma_m, 2000.0);
}

TEST(TimedScoring, NothingAskedForIsNothing) {
  const Read made = read("", line_space());
  EXPECT_TRUE(made.rule.times_s.empty());
  EXPECT_EQ(made.rule.families.size(), usual_metrics().size());
  EXPECT_FALSE(made.timed.cramer_rao);
  EXPECT_TRUE(made.timed.global_minimum.empty());
  EXPECT_FALSE(read("times_s = [1.0]\nbound = { kind = \"cramer_rao\" }").timed.cramer_rao->prior);
}

TEST(TimedScoring, BoundsOfPassiveSonar) {
  const Read made = read(
      "times_s = [1050.0]\ntarget_motion = true\nbound = { kind = \"cramer_rao\", frequencies = false, "
      "frequency_sigma_hz = 0.03, sound_mps = 1480.0 }",
      plane_frequency_space());
  EXPECT_FALSE(made.timed.cramer_rao->frequencies);
  EXPECT_EQ(made.timed.cramer_rao->frequency_sigma_hz, 0.03);
  EXPECT_EQ(made.timed.cramer_rao->sound_mps, 1480.0);
  const auto plain =
      read("times_s = [1.0]\nbound = { kind = \"cramer_rao\" }", plane_frequency_space()).timed.cramer_rao;
  EXPECT_TRUE(plain->frequencies);
  EXPECT_EQ(plain->sound_mps, 1500.0);
}

TEST(TimedScoring, WhatCannotBeScoredIsRefused) {
  EXPECT_THAT(refusal("times_s = [2.0, 1.0]"), AllOf(HasSubstr("scoring.times_s"), HasSubstr("ascending")));
  EXPECT_THAT(refusal("times_s = [1.0, 1.0]"), HasSubstr("ascending"));
  EXPECT_THAT(refusal("times_s = [-1.0]"), HasSubstr("scoring.times_s"));
  EXPECT_THAT(refusal("target_motion = true"), HasSubstr("times_s"));
  EXPECT_THAT(refusal("bound = { kind = \"cramer_rao\" }"), HasSubstr("times_s"));
  EXPECT_THAT(refusal("global_minimum = \"a\""), HasSubstr("times_s"));
  EXPECT_THAT(refusal("times_s = [1.0]\ntarget_motion = true", line_space()),
              AllOf(HasSubstr("scoring.target_motion"), HasSubstr("plane")));
  EXPECT_THAT(refusal("times_s = [1.0]\nbound = { kind = \"cramer_rau\" }"),
              AllOf(HasSubstr("scoring.bound.kind"), HasSubstr("cramer_rao")));
  EXPECT_THAT(refusal("times_s = [1.0]\nbound = { kind = \"cramer_rao\", q = 1.0 }"), HasSubstr("scoring.bound.q"));
  EXPECT_THAT(refusal("times_s = [1.0]\nbound = { kind = \"cramer_rao\", prior = { kind = \"rang\" } }"),
              HasSubstr("scoring.bound.prior"));
}

TEST(TimedScoring, InAStudy) {
  const testing::TemporaryFolder folder;
  const auto loaded = [&](const std::string& more) {
    return Study::load(
        testing::write_study(folder, testing::replaced(testing::kStudy, "[scoring]\n", "[scoring]\n" + more)));
  };
  const Study study = loaded("times_s = [10.0, 20.0]\nglobal_minimum = \"wide\"\n");
  EXPECT_THAT(study.comparison_options().scoring.times_s, ElementsAre(10.0, 20.0));
  EXPECT_EQ(study.comparison_options().global_minimum, "wide");
  EXPECT_THAT(error_message([&] { loaded("times_s = [10.0]\nglobal_minimum = \"wise\"\n"); }),
              AllOf(HasSubstr("scoring.global_minimum"), HasSubstr("did you mean \"wide\"")));
  EXPECT_THAT(error_message([&] { loaded("time_s = [10.0]\n"); }), HasSubstr("did you mean \"times_s\""));
}

}  // namespace
}  // namespace truebearing::timed_scoring_test
