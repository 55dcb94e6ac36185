// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/angle_bound_scoring.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/radar_study.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing::angle_bound_scoring_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;

std::optional<AngleBound> bound(const std::string& text, const StateSpace& truth = angle_space()) {
  const SharedTable table = parse_toml(text, "study.toml");
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

}  // namespace
}  // namespace truebearing::angle_bound_scoring_test
