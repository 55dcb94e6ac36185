// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/measured_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/error_message.hpp"
#include "tests/support/radar_study.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing::measured_check_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

const std::string kBatch = R"(
[trackers.batch]
kind = "bearings_batch"
method = "ml"
measurement = { model = "bearing", bearing_sigma_deg = 1.0 }
)";
const std::string kRaw = R"(
[trackers.raw]
kind = "raw"
components = ["position_m"]
sigma = [150.0]
)";
std::string study_on(const std::string& scenario, const std::string& trackers, const std::string& sets = {}) {
  return "name = \"pairs\"\nscenario = \"" TRUEBEARING_SOURCE_DIR "/data/scenarios/" + scenario + ".toml\"\n" + sets +
         trackers;
}

std::string refusal(const std::string& study) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.write("pairs.toml", study);
  return error_message([&] { Study::load(path); });
}

TEST(MeasuredCheck, TrackerOfSomethingElseIsRefusedByName) {
  EXPECT_EQ(refusal(study_on("cho_s1", kBatch)), "no error");
  EXPECT_THAT(refusal(study_on("radar_1d_paper", kBatch)),
              ::testing::ContainsRegex(
                  "pairs.toml:[0-9]+: trackers.batch: measures bearing .bearing_deg., the scenario gives position "
                  ".position_m."));
  EXPECT_THAT(refusal(study_on("cho_s1", kRaw)),
              HasSubstr("trackers.raw: measures position (position_m), the scenario gives bearing (bearing_deg)"));
  EXPECT_THAT(refusal(study_on("array_a_0db", kRaw)), HasSubstr("the scenario gives snapshots (snapshots)"));
}

TEST(MeasuredCheck, BearingsMayComeWithFrequencies) {
  EXPECT_EQ(refusal(study_on("passive_sonar_a", kBatch)), "no error");
  const std::string heard = testing::replaced(testing::replaced(kBatch, "\"bearing\"", "\"bearing_frequency\""),
                                              "= 1.0", "= 1.0, frequency_sigma_hz = 0.02");
  EXPECT_EQ(refusal(study_on("passive_sonar_a", heard)), "no error");
  EXPECT_THAT(refusal(study_on("cho_s1", heard)), HasSubstr("measures bearing_frequency (bearing_deg, frequency_hz)"));
}

TEST(MeasuredCheck, SetsMeasureWhatTheTrackersTakeToo) {
  const auto sets = [](const std::string& scenario) {
    return "[sets]\nother = \"" TRUEBEARING_SOURCE_DIR "/data/scenarios/" + scenario + ".toml\"\n";
  };
  EXPECT_EQ(refusal(study_on("cho_s1", kBatch, sets("cho_s2"))), "no error");
  EXPECT_THAT(refusal(study_on("cho_s1", kBatch, sets("radar_2d"))),
              HasSubstr("trackers.batch: measures bearing (bearing_deg), the set \"other\" gives "));
}

TEST(MeasuredCheck, ArraysHaveMoreSensorsThanThereAreTargets) {
  const auto trackers = [](const std::string& targets) {
    return "[trackers.paper]\nkind = \"subspace_angles\"\nq_deg2ps3 = 1.0\nsigma_deg = 2.0\ntargets = " + targets +
           "\n";
  };
  EXPECT_EQ(refusal(study_on("array_a_0db", trackers("14"))), "no error");
  EXPECT_EQ(refusal(study_on("array_a_0db", trackers("\"mdl\""))), "no error");
  EXPECT_THAT(refusal(study_on("array_a_0db", trackers("15"))),
              HasSubstr("trackers.paper: follows 15 targets, which takes an array of 16 sensors; the scenario has 15"));
}

/// A user's own tracker, which does not say what it measures.
class Quiet final : public Tracker {
 public:
  std::span<const StepRecord> step(const Measurement&) override { return {}; }
  void reset() override {}
  std::unique_ptr<Tracker> fresh() const override { return std::make_unique<Quiet>(); }
  const StateSpace& space() const override { return line_space(); }
};

TEST(MeasuredCheck, WhoDoesNotSayIsNotRefused) {
  const auto scenario = load_scenario(TRUEBEARING_SOURCE_DIR "/data/scenarios/radar_1d_paper.toml");
  EXPECT_EQ(error_message([&] { check_measured(Quiet(), "quiet", *scenario, {}); }), "no error");
}

/// What every scenario says is what its runs measure.
TEST(MeasuredCheck, ScenariosSayWhatTheirRunsMeasure) {
  for (const auto& file : std::filesystem::directory_iterator(TRUEBEARING_SOURCE_DIR "/data/scenarios")) {
    const auto scenario = load_scenario(file.path());
    const Recording run = scenario->simulate({});
    ASSERT_TRUE(scenario->measured()) << file.path();
    EXPECT_EQ(scenario->measured()->components, run.measured) << file.path();
    EXPECT_EQ(scenario->reports_sigma(), run.measurements.front().sigma.size() > 0) << file.path();
  }
}

}  // namespace
}  // namespace truebearing::measured_check_test
