// SPDX-License-Identifier: Apache-2.0
// The survey of keys: which kind a table is of, and which kinds nobody has shown it.
#include "truebearing/io/key_survey.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace truebearing {
namespace {

using ::testing::ElementsAre;

TableReader table(const char* toml, const char* path) {
  return {parse_toml(toml, "study.toml"), "study.toml", path};
}

TEST(KeySurvey, ChoicesThatNoTableIsOfAreUnvisited) {
  const KeySurvey survey;
  table("model = \"singer\"", "trackers.a.motion").choice("model", {"singer", "learned", "constant_velocity"});
  table("kind = \"line\"", "scenario").choice("kind", {"line", "lorenz"});
  table("output = \"plane\"", "scenario.sensors.radar").choice("output", {"plane", "range"});
  EXPECT_THAT(unvisited_choices(survey.tables()),
              ElementsAre("motion.constant_velocity", "motion.learned", "scenario.lorenz"));
  table("model = \"learned\"", "trackers.b.modes[1]").choice("model", {"singer", "learned"});  // is a motion too
  EXPECT_THAT(unvisited_choices(survey.tables()), ElementsAre("motion.constant_velocity", "scenario.lorenz"));
}

TEST(KeySurvey, SensorsOfAStudyAndOfAScenarioAreTablesApart) {
  const KeySurvey survey;
  table("model = \"position\"", "sensors.plots").has("sigma_m");
  table("output = \"plane\"", "scenario.sensors.plots").has("missed");
  table("output = \"plane\"", "sensors.plots").has("first_s");  // of a scenario in a file of its own
  table("", "sensors").has("plots");                            // a name of the user's own
  ASSERT_EQ(survey.tables().size(), 2U);
  EXPECT_TRUE(survey.tables().at("sensors").contains("sigma_m"));
  EXPECT_TRUE(survey.tables().at("scenario.sensors").contains("missed"));
  EXPECT_TRUE(survey.tables().at("scenario.sensors").contains("first_s"));
}

TEST(KeySurvey, TrackerThatIsReadWithoutItsKindIsOfTheNotedOne) {
  const KeySurvey survey;
  TableReader tracker = table("modes = []", "trackers.a");
  note_kind(tracker, "imm");
  tracker.has("modes");
  EXPECT_THAT(survey.tables().at("tracker").at("modes").kinds, ElementsAre("imm"));
}

}  // namespace
}  // namespace truebearing
