// SPDX-License-Identifier: Apache-2.0
// A study's table [sensors.NAME], and what trackers, scenarios and logs make of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/error_message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/recording/recording_csv.hpp"
#include "truebearing/study/study.hpp"
#include "truebearing/study/study_sites.hpp"

namespace truebearing::sensors_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;

const std::string kScenario = R"(
name = "two"
[scenario]
kind = "planar_flight"
period_s = 1.0
steps = 20
flight = { speed_mps = 100.0, leg_s = 1e5, turn_s = 1.0, turn_rate_degps = 0.0, roll_in_s = 0.0 }
site = { start_east_m = 3000.0, start_north_m = 4000.0 }
[scenario.sensors.plots]
output = "plane"
position_sigma_m = 10.0
period_s = 2.0
[scenario.sensors.radar]
output = "range_bearing"
range_sigma_m = 20.0
bearing_sigma_deg = 1.0
period_s = 4.0
)";
const std::string kSensors = R"(
[sensors.radar]
model = "range_bearing"
range_sigma_m = 20.0
bearing_sigma_deg = 1.0
gate_probability = 0.999
[sensors.plots]
model = "position"
sigma_m = 10.0
)";
const std::string kTracker = R"(
[trackers.both]
kind = "kalman"
space = "plane"
motion = { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 1.0 }
measurement = { model = "sensors" }
start = { kind = "one_point", velocity_sigma_mps = 200.0 }
)";
const std::string kPlotsAlone = "[trackers.plots_alone]\nlike = \"both\"\nmeasurement = { use = [\"plots\"] }\n";

Study study_of(const std::string& text) {
  const testing::TemporaryFolder folder;
  return Study::load(folder.write("two.toml", text));
}

std::string error_of(const std::string& text) {
  return error_message([&] { study_of(text); });
}

TEST(Sensors, TrackersReadTheSensorsOfTheirStudy) {
  const Study study = study_of(kScenario + kSensors + kTracker + kPlotsAlone);
  const Recording run = study.scenario().simulate({1, Role::evaluation, 0});
  const auto both = study.make_tracker("both"), alone = study.make_tracker("plots_alone");
  for (const Measurement& measurement : run.measurements) {
    both->step(measurement);
    alone->step(measurement);
  }
  EXPECT_EQ(both->counts().missing, 0);
  EXPECT_EQ(alone->counts().missing, 5);  // the radar's
  EXPECT_EQ(*both->measures(), *study.scenario().measured());
  EXPECT_EQ(study.recording_options().sources.size(), 2u);
}

TEST(Sensors, TheirGatesAreTheirOwn) {
  const Study study = study_of(kScenario + kSensors + kTracker);
  Recording run = study.scenario().simulate({1, Role::evaluation, 0});
  const auto both = study.make_tracker("both");
  for (Measurement& measurement : run.measurements) {
    if (measurement.time_s == 16.0) measurement.z[0] += 500.0;
    const auto records = both->step(measurement);
    if (measurement.time_s != 16.0) continue;
    ASSERT_FALSE(records.empty());
    EXPECT_EQ(records[0].status, measurement.source == 1 ? StepStatus::rejected : StepStatus::ok);
  }
  EXPECT_EQ(both->counts().gated, 1);
}

// A platform whose log tells its height; one whose log does not is as high as the site of the study.
TEST(Sensors, PlatformsAreAsHighAsTheirLogSaysElseAsTheirSite) {
  const Study study = study_of(R"(
name = "space"
[scenario]
kind = "space_flight"
output = "range_bearing_elevation"
period_s = 1.0
steps = 10
flight = { speed_mps = 100.0, leg_s = 30.0, turn_s = 10.0, turn_rate_degps = 3.0, roll_in_s = 1.0 }
start = { east_m = 0.0, north_m = 0.0, up_m = 1000.0 }
sensor = { range_sigma_m = 1.0, bearing_sigma_deg = 1e-3, elevation_sigma_deg = 1e-3 }
[trackers.radar]
kind = "kalman"
space = "space"
motion = { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 1.0 }
measurement = { model = "converted_range_bearing_elevation", range_sigma_m = 1.0, bearing_sigma_deg = 1e-3, elevation_sigma_deg = 1e-3, site_m = [0, 0, 300] }
start = { kind = "one_point", velocity_sigma_mps = 100.0 }
)");
  const auto place_of = [&](const std::string& columns, const std::string& cells) {
    std::istringstream log("time_s,range_m,bearing_deg,elevation_deg" + columns + "\n0,5000,90,30" + cells + "\n");
    const Recording recording = read_recording(log, "log.csv", study.recording_options());
    return Eigen::Vector3d(study.make_tracker("radar")->step(recording.measurements[0])[0].x.head<3>());
  };
  const Eigen::Vector3d sight_m(5000.0 * std::cos(radians(30.0)), 0.0, 2500.0);
  EXPECT_LT((place_of("", "") - sight_m - Eigen::Vector3d(0, 0, 300)).norm(), 1e-3);
  const std::string plane = ",sensor_east_m,sensor_north_m";
  EXPECT_LT((place_of(plane, ",10,20") - sight_m - Eigen::Vector3d(10, 20, 300)).norm(), 1e-3);
  EXPECT_LT((place_of(plane + ",sensor_up_m", ",10,20,0") - sight_m - Eigen::Vector3d(10, 20, 0)).norm(), 1e-3);
}

TEST(Sensors, StandWhereTheirStudySays) {
  using Sites = std::vector<Eigen::Vector3d>;
  EXPECT_EQ(sensor_sites(study_of(kScenario + kSensors + kTracker)).site_m, Sites(2, Eigen::Vector3d::Zero()));
  const std::string apart = kSensors.substr(0, kSensors.find("[sensors.plots]")) + "site_m = [5, -6]\n" +
                            kSensors.substr(kSensors.find("[sensors.plots]"));
  EXPECT_EQ(sensor_sites(study_of(kScenario + apart + kTracker)).site_m,
            (Sites{Eigen::Vector3d::Zero(), {5.0, -6.0, 0.0}}));
  const Study space = Study::load(TRUEBEARING_SOURCE_DIR "/data/keys/space.toml");
  EXPECT_EQ(sensor_sites(space).site_m, Sites(1, Eigen::Vector3d::Zero()));
}

TEST(Sensors, ClocksAreThoseOfTheSensorsByName) {
  EXPECT_TRUE(study_of(kScenario + kSensors + kTracker).recording_options().clock_offsets_s.empty());
  const Study study = study_of(kScenario + kSensors + "clock_offset_s = -0.5\n" + kTracker);  // of the plots
  EXPECT_EQ(study.recording_options().clock_offsets_s, (std::vector<double>{-0.5, 0.0}));
}

TEST(Sensors, MistakesSayWhatWouldBeRight) {
  EXPECT_THAT(error_of(kScenario + kTracker),
              AllOf(HasSubstr("trackers.both.measurement"), HasSubstr("[sensors.NAME]")));
  EXPECT_THAT(error_of(kScenario + kSensors + kTracker +
                       "[trackers.one]\nlike = \"both\"\nmeasurement = { use = [\"rader\"] }\n"),
              AllOf(HasSubstr("rader"), HasSubstr("radar")));
  EXPECT_THAT(error_of(kScenario + kSensors + kTracker + "gate_probability = 0.99\n"),
              AllOf(HasSubstr("gate_probability"), HasSubstr("[sensors.NAME]")));
  EXPECT_THAT(error_of(kScenario + kSensors + "sigma_mm = 1.0\n" + kTracker),
              AllOf(HasSubstr("sensors.plots"), HasSubstr("sigma_mm"), HasSubstr("sigma_m")));
  const std::string other = "[sensors.plots]\nmodel = \"position\"\nsigma_m = 10.0\n";
  EXPECT_THAT(error_of(kScenario + other + kTracker),
              AllOf(HasSubstr("both"), HasSubstr("the scenario gives"), HasSubstr("radar: range_m, bearing_deg")));
  EXPECT_THAT(error_of(kScenario + kSensors + "bias = [1.0]\n" + kTracker), AllOf(HasSubstr("bias"), HasSubstr("2")));
}

}  // namespace
}  // namespace truebearing::sensors_test
