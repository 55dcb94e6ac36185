// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/range_prior_configuration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/error_message.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing::range_prior_configuration_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

RangePrior read(const std::string& text, int dimensions = 2) {
  const SharedTable table = parse_toml(text, "study.toml");
  return read_range_prior(TableReader(table, "study.toml", "trackers.mine.start"), dimensions);
}

TEST(RangePriorConfiguration, ReadsARangeAndASpreadOfVelocities) {
  const RangePrior prior = read("kind = \"range\"\nrange_m = 5e3\nrange_sigma_m = 2e3\nvelocity_sigma_mps = 3.0");
  EXPECT_EQ(prior.range_m, 5e3);
  EXPECT_EQ(prior.range_sigma_m, 2e3);
  EXPECT_EQ(prior.velocity_sigma_mps, 3.0);
  EXPECT_FALSE(prior.between || prior.course);
  EXPECT_TRUE(prior.suffices_with({}));
}

TEST(RangePriorConfiguration, ReadsAClimb) {
  const std::string text = "kind = \"range\"\nrange_m = 5e3\nrange_sigma_m = 2e3\nvelocity_sigma_mps = 60.0\n";
  EXPECT_EQ(read(text + "climb_sigma_mps = 6.0", 3).climb_sigma_mps, 6.0);
  EXPECT_TRUE(std::isnan(read(text, 3).climb_sigma_mps));
  EXPECT_THAT(error_message([&] { read(text + "climb_sigma_mps = 0.0", 3); }), HasSubstr("climb_sigma_mps"));
  EXPECT_THAT(error_message([&] { read(text + "climb_sigma_mps = 6.0"); }), HasSubstr("climb_sigma_mps"));
}

TEST(RangePriorConfiguration, WaitsForAGuessWhereItSaysSo) {
  const RangePrior prior = read(
      "kind = \"range\"\nguess = true\nbetween_m = [3e3, 15e3]\ncourse = { from_bearing_deg = 180, sigma_deg = 52 }");
  EXPECT_EQ(prior.between->low_m, 3e3);
  EXPECT_EQ(prior.between->high_m, 15e3);
  EXPECT_DOUBLE_EQ(prior.course->from_bearing_rad, kPi);
  EXPECT_FALSE(prior.suffices_with({}));
  TargetGuess guess{.range_m = 7e3, .range_sigma_m = 3e3};
  EXPECT_FALSE(prior.suffices_with(guess)) << "a course needs a speed";
  guess.speed_mps = 4.0;
  guess.speed_sigma_mps = 1.0;
  EXPECT_TRUE(prior.suffices_with(guess));
}

TEST(RangePriorConfiguration, RefusesWhatDoesNotFitTogether) {
  const std::string head = "kind = \"range\"\n", range = "range_m = 5e3\nrange_sigma_m = 2e3\n";
  const auto refusal = [](const std::string& text) { return error_message([&] { read(text); }); };
  EXPECT_THAT(refusal(head + "velocity_sigma_mps = 3.0"), HasSubstr("start.range_m"));
  EXPECT_THAT(refusal(head + range), HasSubstr("one of the two"));
  EXPECT_THAT(refusal(head + range + "guess = true\nvelocity_sigma_mps = 3.0"), HasSubstr("range_m"));
  EXPECT_THAT(refusal(head + range + "between_m = [4e3, 4e3]\nvelocity_sigma_mps = 3.0"), HasSubstr("low < high"));
  EXPECT_THAT(refusal(head + range + "course = { from_bearing_deg = 180, sigma_deg = 52 }"), HasSubstr("speed_mps"));
  EXPECT_THAT(refusal("kind = \"rang\"\n"), HasSubstr("kind"));
}

}  // namespace
}  // namespace truebearing::range_prior_configuration_test
