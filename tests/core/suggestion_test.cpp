// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/suggestion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace truebearing::suggestion_test {
namespace {

const std::vector<std::string> kNames{"position_m", "velocity_mps", "steps"};

TEST(Suggestion, NearestByEdits) {
  EXPECT_EQ(nearest_name("postion_m", kNames), "position_m");
  EXPECT_EQ(nearest_name("velocity_kn", kNames), "velocity_mps");
  EXPECT_EQ(nearest_name("step", kNames), "steps");
}

TEST(Suggestion, NothingIsNearToWhatIsFar) {
  EXPECT_EQ(nearest_name("qqqqqqqqqq", kNames), "");
  EXPECT_EQ(nearest_name("steps", {}), "");
}

TEST(Suggestion, ListsTheValidNames) {
  EXPECT_EQ(suggestion("stepps", kNames), "did you mean \"steps\"? one of position_m, velocity_mps, steps");
  EXPECT_EQ(suggestion("qqqqqqqqqq", kNames), "position_m, velocity_mps, steps");
}

TEST(Suggestion, ListsNoMoreThanTwelve) {
  EXPECT_THAT(suggestion("qqqqqqqqqq", std::vector<std::string>(25, "a")), ::testing::EndsWith("a, ..."));
  EXPECT_THAT(suggestion("qqqqqqqqqq", std::vector<std::string>(24, "a")), ::testing::EndsWith("a, a"));
}

TEST(Suggestion, NearMissIsASlipAndNoOtherWord) {
  for (const char* slip : {"postion_m", "Position_M", "position-m", "psoition_m", "position_mm"})
    EXPECT_EQ(near_miss(slip, kNames), "position_m") << slip;
  for (const char* other : {"altitude_m", "position_error_m", "velocity", "snr_db"})
    EXPECT_EQ(near_miss(other, kNames), "") << other;
}

TEST(Suggestion, HostileNameIsCheap) {
  EXPECT_EQ(nearest_name(std::string(100'000'000, 'q'), kNames), "");
}

}  // namespace
}  // namespace truebearing::suggestion_test
