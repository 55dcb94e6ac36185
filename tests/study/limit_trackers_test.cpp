// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/limit_trackers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/error_message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/study/study.hpp"
#include "truebearing/study/tracker_registry.hpp"

namespace truebearing::limit_trackers_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::error_message;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;

const std::string kFlight = R"(
[scenario.flight]
speed_mps = { uniform = [150.0, 350.0] }
leg_s = { uniform = [10.0, 40.0] }
turn_s = 20.0
turn_rate_degps = 3.0
roll_in_s = 0.0
)";
const std::string kSensor = "[scenario.sensor]\nposition_sigma_m = 100.0\n";
const std::string kLimit = "[trackers.limit]\nkind = \"particle_limit\"\nparticles = 100\n";

std::string study_of(const std::string& output, const std::string& sensor, const std::string& more = {}) {
  return "name = \"small\"\n[scenario]\nkind = \"planar_flight\"\noutput = \"" + output +
         "\"\nperiod_s = 1.0\nsteps = 30\nsite = { range_m = 20000.0 }\n" + kFlight + sensor + kLimit + more;
}

struct Loaded {
  TemporaryFolder folder;
  Study study;
  explicit Loaded(const std::string& text) : study(Study::load(folder.write("study.toml", text))) {}
};

std::string refusal(const std::string& text) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.write("study.toml", text);
  return error_message([&] { Study::load(path); });
}

TEST(ParticleLimitKind, IsABoundOfItsScenario) {
  const Loaded loaded(study_of("plane", kSensor));
  EXPECT_THAT(loaded.study.bounds(), ElementsAre("limit"));
  EXPECT_THAT(loaded.study.comparison_options().bounds, ElementsAre("limit"));
  EXPECT_THAT(loaded.study.comparison_options(true).bounds, IsEmpty()) << "a recorded flight is of no family";
  EXPECT_EQ(loaded.study.note(), "");
  const auto tracker = loaded.study.make_tracker("limit");
  const Recording run = loaded.study.scenario().simulate({});
  for (const Measurement& measurement : run.measurements) EXPECT_EQ(tracker->step(measurement).size(), 1u);
}

TEST(ParticleLimitKind, TakesPositionsAndRangesWithBearings) {
  const std::string polar = "[scenario.sensor]\nrange_sigma_m = 50.0\nbearing_sigma_deg = 0.3\n";
  EXPECT_EQ(refusal(study_of("range_bearing", polar)), "no error");
  EXPECT_EQ(refusal(study_of("plane", kSensor + "reported = true\n")), "no error");
  EXPECT_THAT(refusal(study_of("range_bearing_rate", polar + "range_rate_sigma_mps = 1.0\n")),
              AllOf(HasSubstr("trackers.limit"), HasSubstr("range_bearing_rate")));
  EXPECT_THAT(refusal(study_of("range", kSensor)), HasSubstr("output \"range\""));
}

TEST(ParticleLimitKind, RefusesWhatItDoesNotModel) {
  EXPECT_THAT(refusal(study_of("plane", kSensor + "outlier_share = 0.1\noutlier_factor = 10.0\n")),
              HasSubstr("outliers"));
  EXPECT_THAT(refusal(study_of("plane", kSensor + "false_share = 0.1\nfalse_radius_m = 1e3\n")),
              HasSubstr("false plots"));
  EXPECT_THAT(refusal(study_of("plane", "[scenario.sensor]\nposition_covariance_m2 = [1e4, 10.0, 10.0, 1e4]\n")),
              HasSubstr("correlated"));
  EXPECT_THAT(refusal(study_of("plane", "[scenario.sensor]\nposition_sigma_m = { uniform = [10.0, 100.0] }\n")),
              HasSubstr("standard deviation that is drawn"));
  EXPECT_THAT(
      refusal("name = \"line\"\n[scenario]\nkind = \"line\"\nperiod_s = 1.0\nsteps = 10\ntarget = { position_m = "
              "0.0, velocity_mps = 1.0 }\nsensor = { position_sigma_m = 1.0 }\n" +
              kLimit),
      AllOf(HasSubstr("planar flights"), HasSubstr("\"planar_flight\"")));
  EXPECT_THAT(refusal(study_of("plane", kSensor, "partcles = 7\n")), HasSubstr("did you mean \"particles\""));
}

const std::string kSource =
    "duration_s = 700.0\nown_ship = { speed_mps = 5.0, course_deg = 0.0, turns = [{ time_s = 200.0, by_deg = 90.0 }] }\n"
    "source = { frequency_hz = 120.0 }\n";
const std::string kTurn =
    "turns = [{ time_s = { uniform = [400.0, 500.0] }, by_deg = { uniform = [20.0, 90.0] }, "
    "rate_degps = 1.0, share = 0.85, either_side = true }]";

std::string sonar_study(const std::string& turns = kTurn, const std::string& limit = "hand_over_s = 350.0\n",
                        const std::string& source = kSource, const std::string& sensor = {}) {
  return "name = \"small\"\n[scenario]\nkind = \"passive_sonar\"\nperiod_s = 7.0\n" + source +
         "target = { range_m = 6000.0, bearing_deg = 40.0, speed_mps = 4.0, course_deg = 200.0" +
         (turns.empty() ? "" : ", " + turns) + " }\nsensor = { bearing_sigma_deg = 1.0, frequency_sigma_hz = 0.02" +
         sensor + " }\n[trackers.limit]\nkind = \"particle_limit\"\nparticles = 100\n" + limit +
         "measurement = { model = \"bearing_frequency\", bearing_sigma_deg = 1.0, frequency_sigma_hz = 0.02 }\n"
         "batch = { method = \"map\", prior = { kind = \"velocity\", velocity_sigma_mps = 3.0 } }\n";
}

TEST(ParticleLimitKind, IsABoundOfASourceThatTurnsOnce) {
  const Loaded loaded(sonar_study());
  EXPECT_THAT(loaded.study.bounds(), ElementsAre("limit"));
  EXPECT_EQ(loaded.study.note(), "");
  const auto tracker = loaded.study.make_tracker("limit");
  const Recording run = loaded.study.scenario().simulate({});
  for (const Measurement& measurement : run.measurements) {
    const auto records = tracker->step(measurement);
    const bool follows = !records.empty() && records[0].mode_probabilities;
    EXPECT_EQ(follows, measurement.time_s > 350.0) << measurement.time_s;
  }
  EXPECT_TRUE(std::any_of(tracker->events().begin(), tracker->events().end(),
                          [](const TrackEvent& event) { return event.kind == TrackEvent::Kind::handed_over; }));
}

TEST(ParticleLimitKind, RefusesATurnThatItDoesNotModel) {
  EXPECT_THAT(refusal(sonar_study("")), AllOf(HasSubstr("trackers.limit"), HasSubstr("does not turn once")));
  EXPECT_THAT(refusal(sonar_study("turns = [{ time_s = 400.0, to_deg = 90.0 }]")), HasSubstr("not by an angle"));
  EXPECT_THAT(refusal(sonar_study("turns = [{ time_s = 400.0, by_deg = -40.0 }]")), HasSubstr("not by an angle"));
  EXPECT_THAT(refusal(sonar_study(kTurn, "hand_over_s = 450.0\n")),
              AllOf(HasSubstr("hand_over_s"), HasSubstr("is 450"), HasSubstr("before the first turn, 400 s")));
  const std::string jumps =
      "duration_s = 700.0\nown_ship = { speed_mps = 5.0, course_deg = 0.0 }\n"
      "source = { frequency_hz = 120.0, changes = [{ time_s = 500.0, by_hz = 5.0 }] }\n";
  EXPECT_THAT(refusal(sonar_study(kTurn, "hand_over_s = 350.0\n", jumps)), HasSubstr("changes its frequency"));
  EXPECT_THAT(
      refusal(sonar_study(kTurn, "hand_over_s = 350.0\n", kSource, ", outlier_share = 0.1, outlier_factor = 5.0")),
      HasSubstr("sensor has outliers"));
  std::string deaf = sonar_study();
  deaf.replace(deaf.rfind("bearing_frequency"), 17, "bearing");
  deaf.erase(deaf.rfind(", frequency_sigma_hz"), std::string(", frequency_sigma_hz = 0.02").size());
  EXPECT_THAT(refusal(deaf),
              AllOf(HasSubstr("measurement"), HasSubstr("of no source"), HasSubstr("bearing_frequency")));
  const std::string silent = "duration_s = 700.0\nown_ship = { speed_mps = 5.0, course_deg = 0.0 }\n";
  std::string bearings = sonar_study(kTurn, "hand_over_s = 350.0\n", silent);
  bearings.replace(bearings.find("passive_sonar"), 13, "bearings_only");
  bearings.erase(bearings.find(", frequency_sigma_hz"), std::string(", frequency_sigma_hz = 0.02").size());
  EXPECT_THAT(refusal(bearings), HasSubstr("target is no source"));
}

TEST(ParticleLimitKind, KnowsNoFlightsOfIntervals) {
  EXPECT_THAT(refusal("name = \"small\"\n[scenario]\nkind = \"planar_flight\"\noutput = \"plane\"\nperiod_s = 1.0\n"
                      "steps = 9\n[scenario.flight]\nspeed_mps = 50.0\nintervals = 2\ninterval_s = 4.0\n"
                      "along_mps2 = 0.0\nacross_mps2 = 5.0\n" +
                      kSensor + kLimit),
              AllOf(HasSubstr("does not know flights of intervals"), HasSubstr("legs and manoeuvres")));
}

TEST(ParticleLimitKind, WantsAScenario) {
  const SharedTable table = parse_toml("particles = 100", "study.toml");
  TableReader reader(table, "study.toml", "trackers.mine");
  EXPECT_THAT(error_message([&] { make_tracker("particle_limit", reader); }), HasSubstr("a study's scenario"));
  EXPECT_THAT(tracker_kinds(), ::testing::Contains("particle_limit"));
  EXPECT_THAT(error_message([] { register_tracker("particle_limit", {}); }), HasSubstr("taken"));
}

TEST(ParticleLimitKind, SetsOfAnotherFamilyAreRefused) {
  const std::string looks = "[sets]\nhalf = { looks = { period_factor = 0.5 } }\n";
  EXPECT_EQ(refusal(study_of("plane", kSensor, looks)), "no error");
  const std::string faster = "[sets]\nfast = { flight = { speed_mps = 900.0 } }\n";
  EXPECT_THAT(refusal(study_of("plane", kSensor, faster)), AllOf(HasSubstr("\"fast\""), HasSubstr("another")));
  const std::string louder = "[sets]\nloud = { sensor = { position_sigma_m = 300.0 } }\n";
  EXPECT_THAT(refusal(study_of("plane", kSensor, louder)), HasSubstr("\"loud\""));
}

TEST(ParticleLimitKind, IsNoBoundOfWhatARecorderKept) {
  const std::string jitter = "[scenario.jitter]\nknots = [0.9, 0.1]\ntime_sigma_s = 0.1\n";
  const Loaded loaded(study_of("plane", kSensor + jitter));
  EXPECT_THAT(loaded.study.bounds(), IsEmpty());
  EXPECT_THAT(loaded.study.note(), AllOf(HasSubstr("limit"), HasSubstr("jitter")));
  EXPECT_THAT(refusal(study_of("plane", kSensor + jitter, "[scoring]\nbounds = [\"limit\"]\n")),
              AllOf(HasSubstr("scoring.bounds"), HasSubstr("jitter")));
}

}  // namespace
}  // namespace truebearing::limit_trackers_test
