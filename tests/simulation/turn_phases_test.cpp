// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/turn_phases.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "tests/support/error_message.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing::turn_phases_test {
namespace {

using ::testing::ElementsAre;
using testing::error_message;
using ::testing::HasSubstr;

TurnPhases read(const std::string& text) {
  const SharedTable table = parse_toml(text, "phases.toml");
  TableReader reader(table, "phases.toml");
  TurnPhases phases = read_turn_phases(reader);
  reader.finish();
  return phases;
}

std::string name(const TurnPhases& phases, double time_s, const std::optional<VesselPath::Turn>& turn) {
  const int phase = phases.at(time_s, turn);
  return phase < 0 ? "none" : phases.names().at(static_cast<std::size_t>(phase));
}

TEST(TurnPhases, FollowTheTurn) {
  const TurnPhases phases = read("after_s = [200.0, 500.0]\nfrom_s = 100.0\n");
  EXPECT_THAT(phases.names(), ElementsAre("before", "turn", "after_200", "after_500", "later", "quiet"));
  const VesselPath::Turn turn{1000.0, 1120.0, radians(60.0)};
  const std::vector<std::pair<double, const char*>> expected{
      {0.0, "none"},         {99.9, "none"},        {100.0, "before"},     {1000.0, "before"},
      {1000.1, "turn"},      {1120.0, "turn"},      {1120.1, "after_200"}, {1320.0, "after_200"},
      {1320.1, "after_500"}, {1620.0, "after_500"}, {1620.1, "later"}};
  for (const auto& [time_s, phase] : expected) EXPECT_EQ(name(phases, time_s, turn), phase) << time_s;
  EXPECT_EQ(name(phases, 99.0, std::nullopt), "none");
  EXPECT_EQ(name(phases, 1000.0, std::nullopt), "quiet");
}

TEST(TurnPhases, SharpTurnsHaveTheirOwn) {
  const TurnPhases phases = read("after_s = [200.0, 500.0]\nsharp_deg = 90.0\n");
  EXPECT_THAT(phases.names(), ElementsAre("before", "turn", "after_200", "after_500", "later", "quiet", "sharp_turn",
                                          "sharp_after_200", "sharp_after_500"));
  for (const double side : {-1.0, 1.0}) {
    const VesselPath::Turn sharp{1000.0, 1120.0, side * radians(90.0)}, gentle{1000.0, 1120.0, side * radians(89.0)};
    EXPECT_EQ(name(phases, 900.0, sharp), "before");
    EXPECT_EQ(name(phases, 1100.0, sharp), "sharp_turn");
    EXPECT_EQ(name(phases, 1200.0, sharp), "sharp_after_200");
    EXPECT_EQ(name(phases, 1400.0, sharp), "sharp_after_500");
    EXPECT_EQ(name(phases, 1700.0, sharp), "later");
    EXPECT_EQ(name(phases, 1100.0, gentle), "turn");
    EXPECT_EQ(name(phases, 1400.0, gentle), "after_500");
  }
  EXPECT_EQ(name(phases, 1700.0, std::nullopt), "quiet");
}

TEST(TurnPhases, IntervalsAscend) {
  EXPECT_THAT(error_message([] { read("after_s = [500.0, 200.0]\n"); }), HasSubstr("ascending"));
  EXPECT_THAT(error_message([] { read("from_s = 3.0\n"); }), HasSubstr("after_s"));
}

}  // namespace
}  // namespace truebearing::turn_phases_test
