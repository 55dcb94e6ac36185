// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/recorded_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "tests/support/array_recording.hpp"
#include "tests/support/error_message.hpp"
#include "tests/support/fakes.hpp"
#include "tests/support/flight_study.hpp"
#include "tests/support/radar_study.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/recording/snapshot_log.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing::recorded_file_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;
using testing::replaced;
using testing::TemporaryFolder;

const std::string kPlaneStudy =
    replaced(testing::kFlightStudy, "[scenario]", "[sets]\none = \"one.csv\"\ntwo = \"folder/two.csv\"\n\n[scenario]");

std::string flight(int rows, double latitude_deg) {
  std::string text = "time_s,latitude_deg,longitude_deg,altitude_ft\n";
  for (int k = 0; k < rows; ++k) text += fmt::format("{},{},7.5,1000\n", k, latitude_deg + k * 0.001);
  return text;
}

class RecordedFileTest : public ::testing::Test {
 protected:
  Study load(const std::string& study) { return Study::load(folder_.write("study.toml", study)); }
  std::string error_of(const std::string& study) {
    return error_message([&] { load(study).evaluation_scenarios(); });
  }
  TemporaryFolder folder_;
};

TEST_F(RecordedFileTest, StudyIsComparedOnTheFlightsThatItLists) {
  folder_.write("one.csv", flight(25, 45));
  folder_.write("folder/two.csv", flight(30, -45));
  const Study study = load(kPlaneStudy);
  const std::vector<NamedScenario> sets = study.evaluation_scenarios();
  ASSERT_EQ(sets.size(), 2u);
  EXPECT_EQ(sets[1].name, "two");
  const Recording recording = sets[1].scenario->simulate({});
  EXPECT_EQ(recording.measurements.size(), 30u);
  EXPECT_EQ(recording.measurements[0].sigma.size(), 0) << "as the simulated ones";
  EXPECT_NE(recording.measurements[3].z, recording.truth[0].x[3].head<2>());
  EXPECT_LT((recording.measurements[3].z - recording.truth[0].x[3].head<2>()).norm(), 400.0);
  EXPECT_THAT(sets[1].scenario->note(),
              AllOf(HasSubstr("two.csv"), HasSubstr("30 measurements"), HasSubstr("0 missing")));
  EXPECT_EQ(study.scenario().note(), "");
}

TEST_F(RecordedFileTest, NothingMayStandBesideTheNameOfOne) {
  folder_.write("one.csv", flight(25, 45));
  folder_.write("folder/two.csv", flight(30, -45));
  EXPECT_THAT(error_of(replaced(kPlaneStudy, "one = \"one.csv\"",
                                "one = { scenario = \"one.csv\", steps = 5, period_s = 2.0 }")),
              AllOf(HasSubstr("sets.one."), HasSubstr("stands beside a recorded track"), HasSubstr("\"one.csv\" alone"),
                    HasSubstr("steps"), HasSubstr("period_s")));
  EXPECT_EQ(error_of(replaced(kPlaneStudy, "one = \"one.csv\"", "one = { scenario = \"one.csv\" }")), "no error");
}

TEST_F(RecordedFileTest, SigmaIsReportedWhereTheSimulatedSensorReportsIt) {
  folder_.write("one.csv", flight(25, 45));
  const Study study = load(replaced(kPlaneStudy, "sensor = { position_sigma_m = 50.0",
                                    "sensor = { reported = true, position_sigma_m = 70.0"));
  const auto recorded = study.recorded_scenario(folder_.path() / "one.csv");
  EXPECT_EQ(recorded->simulate({}).measurements[0].sigma, Eigen::Vector2d(50, 50));
}

const std::string kSpaceStudy = R"(name = "space"
[recorded]
position_sigma_m = 20.0
[scenario]
kind = "space_flight"
output = "space"
period_s = 1.0
steps = 10
flight = { speed_mps = 100.0, leg_s = 30.0, turn_s = 10.0, turn_rate_degps = 3.0, roll_in_s = 1.0 }
start = { east_m = 0.0, north_m = 0.0, up_m = 1000.0 }
sensor = { position_sigma_m = 20.0 }
[trackers.filter]
kind = "kalman"
space = "space"
motion = { model = "constant_velocity", noise = "continuous", q_m2ps3 = 1.0 }
measurement = { model = "position", sigma_m = 20.0 }
start = { kind = "one_point", velocity_sigma_mps = 100.0, climb_sigma_mps = 10.0 }
)";
const std::string kSpaceRadar =
    replaced(replaced(kSpaceStudy, "output = \"space\"", "output = \"range_bearing_elevation\""),
             "sensor = { position_sigma_m = 20.0 }",
             "sensor = { range_sigma_m = 10.0, bearing_sigma_deg = 0.1, elevation_sigma_deg = 0.1 }");

TEST_F(RecordedFileTest, InSpaceAltitudesAreMeasured) {
  const std::filesystem::path one = folder_.write("one.csv", flight(25, 45));
  const Study study = load(kSpaceStudy);
  const auto recorded = study.recorded_scenario(one);
  const Recording recording = recorded->simulate({});
  EXPECT_EQ(&recorded->truth_space(), &space_space());
  ASSERT_EQ(recording.measurements[3].z.size(), 3);
  EXPECT_NEAR(recording.truth[0].x[12][2], 304.8, 0.2);
  const Eigen::Vector3d noise = recording.measurements[3].z - recording.truth[0].x[3].head<3>();
  EXPECT_TRUE(noise.norm() > 0.1 && noise.norm() < 120.0) << noise.transpose();

  // A radar below the track's middle looks straight up there.
  const std::string radar = replaced(
      replaced(
          kSpaceRadar, "position_sigma_m = 20.0\n[scenario]",
          "range_sigma_m = 1e-3\nbearing_sigma_deg = 1e-6\nelevation_sigma_deg = 1e-6\nsite = [0, 0, 4.8]\n[scenario]"),
      "model = \"position\", sigma_m = 20.0",
      "model = \"range_bearing_elevation\", range_sigma_m = 10.0, bearing_sigma_deg = 0.1, elevation_sigma_deg = 0.1");
  const Study radar_study = load(radar);
  const Recording seen = radar_study.recorded_scenario(one)->simulate({});
  EXPECT_EQ(seen.measured[2], "elevation_deg");
  EXPECT_NEAR(seen.measurements[12].z[0], 300.0, 0.2);
  EXPECT_NEAR(seen.truth[0].x[12][2], 300.0, 0.2);
  EXPECT_NEAR(seen.measurements[24].z[2], std::atan2(300.0, 12 * 111.1), 1e-3);
  EXPECT_THAT(error_message([&] {
                load(replaced(radar, "elevation_sigma_deg = 1e-6\nsite = [0, 0, 4.8]", "site = [0, 0]"))
                    .recorded_scenario(one)
                    ->note();
              }),
              AllOf(HasSubstr("study.toml: recorded: tells no elevation"), HasSubstr("elevation_sigma_deg beside")));
}

TEST_F(RecordedFileTest, InThePlaneAltitudesAreNotUsedWhichIsSaid) {
  folder_.write("one.csv", flight(25, 45));
  folder_.write("folder/two.csv", flight(25, 45));
  EXPECT_THAT(load(kPlaneStudy).evaluation_scenarios()[0].scenario->note(),
              HasSubstr("altitudes not used in the plane"));
  const std::string radar =
      replaced(kPlaneStudy, "position_sigma_m = 50.0\n",
               "range_sigma_m = 10.0\nbearing_sigma_deg = 0.1\nelevation_sigma_deg = 0.1\nsite = [0, 0, 0]\n");
  EXPECT_THAT(
      error_message([&] { load(radar).evaluation_scenarios()[0].scenario->note(); }),
      AllOf(HasSubstr("tells an elevation, and the study is in the plane"), HasSubstr("no elevation_sigma_deg")));
}

TEST_F(RecordedFileTest, SnapshotLogIsReplayedWithItsTargets) {
  const std::filesystem::path path = folder_.path() / "log.h5";
  Recording recorded = testing::array_recording();
  const testing::FakeScenario trained_on(recorded);
  write_snapshot_log(path, recorded);
  const RecordedFile file(path, std::nullopt, trained_on, "study.toml");
  EXPECT_EQ(&file.truth_space(), &angle_space());
  EXPECT_EQ(file.simulate({1, Role::evaluation, 3}).truth.size(), 2u);
  EXPECT_EQ(file.simulate({}).snapshots, file.simulate({1, Role::evaluation, 3}).snapshots);
  EXPECT_EQ(file.different_runs(Role::evaluation), 1u);
  EXPECT_THAT(file.note(), AllOf(HasSubstr("log.h5: targets: 2; 4 intervals, 1 missing"), HasSubstr("replays")));

  recorded.truth_space = nullptr;
  recorded.truth.clear();
  write_snapshot_log(path, recorded);
  const RecordedFile without(path, std::nullopt, trained_on, "study.toml");
  EXPECT_THAT(error_message([&] { without.note(); }), AllOf(HasSubstr("log.h5"), HasSubstr("truth_angle_deg")));
}

TEST_F(RecordedFileTest, SnapshotLogIsNoneOfAStudyThatMeasuresPositions) {
  folder_.write("one.csv", flight(25, 45));
  write_snapshot_log(folder_.path() / "log.h5", testing::array_recording());
  const Study study = load(kPlaneStudy);
  const auto recorded = study.recorded_scenario(folder_.path() / "log.h5");
  EXPECT_THAT(error_message([&] { recorded->note(); }),
              AllOf(HasSubstr("log.h5"), HasSubstr("measures snapshots"), HasSubstr("east_m, north_m")));
}

TEST_F(RecordedFileTest, SaysWhyNothingIsScored) {
  std::string still = "time_s,latitude_deg,longitude_deg\n", millis = still, radians = still;
  for (int k = 0; k < 30; ++k) {
    still += fmt::format("{},{},7.5\n", k, 45 + k * 1e-6);
    millis += fmt::format("{},{},7.5\n", 1.7e12 + 1000.0 * k, 45 + k * 0.001);
    radians += fmt::format("{},{},0.13\n", k, (45 + k * 0.001) * 0.017453292519943295);
  }
  folder_.write("one.csv", still);
  folder_.write("millis.csv", millis);
  folder_.write("radians.csv", radians);
  const Study study = load(replaced(kPlaneStudy, "[recorded]", "[recorded]\nmin_speed_mps = 20.0"));
  const auto note = [&](const char* file) { return study.recorded_scenario(folder_.path() / file)->note(); };
  EXPECT_THAT(note("one.csv"),
              AllOf(HasSubstr("no step is scored"), HasSubstr("min_speed_mps = 20"), HasSubstr("0.11")));
  EXPECT_THAT(note("millis.csv"), HasSubstr("time_ms?"));
  EXPECT_THAT(note("radians.csv"), HasSubstr("latitude_rad?"));
}

TEST_F(RecordedFileTest, LogIsReadAsTheStudySays) {
  folder_.write("one.csv", replaced(flight(25, 45), "time_s", "t"));
  const Study study = load(kPlaneStudy + "\n[log]\ncolumns = { t = \"time_s\" }\n");
  EXPECT_THAT(study.recorded_scenario(folder_.path() / "one.csv")->note(), HasSubstr("25 measurements"));
  EXPECT_THAT(error_of(kPlaneStudy + "\n[log]\nsort_windw_s = 1.0\n"), HasSubstr("did you mean \"sort_window_s\""));
}

TEST_F(RecordedFileTest, AbsentFileIsNamedWhenItIsNeeded) {
  folder_.write("one.csv", flight(25, 45));
  EXPECT_EQ(error_message([&] { load(kPlaneStudy); }), "no error") << "it can be trained without";
  EXPECT_THAT(error_of(kPlaneStudy), AllOf(HasSubstr("two.csv"), HasSubstr("cannot be opened")));
}

TEST_F(RecordedFileTest, CorrectionsAreTaughtOnTheFlightThatTheStudyNames) {
  const std::string taught = testing::kFlightStudy + R"(
[trackers.smoothed]
kind = "smoother"
of = "plain"

[trackers.nfnn]
kind = "corrected"
base = "plain"
model = "nfnn.json"
features = [{ kind = "innovation_average", component = "east_m", alpha = 0.5 }]

[trackers.nfnn.training]
teacher = "smoothed"
runs = 2
rules = 2
scenario = "one.csv"
)";
  folder_.write("one.csv", flight(25, 45));
  const Study study = load(taught);
  const auto scenario = study.scenario(study.tracker("nfnn").correction->training.scenario.value());
  const Recording drawn = scenario->simulate({1, Role::training, 0});
  ASSERT_EQ(drawn.measurements.size(), 25u);
  EXPECT_NE(drawn.measurements[3].z, scenario->simulate({1, Role::training, 1}).measurements[3].z);
  EXPECT_NE(drawn.measurements[3].z, scenario->simulate({1, Role::evaluation, 0}).measurements[3].z);
  const auto refusal = [&](const std::string& named) {
    return error_message([&] { load(replaced(taught, "\"one.csv\"", named)); });
  };
  EXPECT_EQ(refusal("\"absent.csv\""), "no error") << "it can be compared without";
}

TEST_F(RecordedFileTest, WhatTheStudyMustSayOfPositions) {
  folder_.write("one.csv", flight(25, 45));
  folder_.write("folder/two.csv", flight(30, -45));
  const std::string none = replaced(kPlaneStudy, "[recorded]\nposition_sigma_m = 50.0\nmax_speed_mps = 400.0\n", "");
  EXPECT_THAT(error_of(none), AllOf(HasSubstr("one.csv"), HasSubstr("[recorded] with position_sigma_m")));
  const auto with = [&](const std::string& keys) {
    return error_of(replaced(kPlaneStudy, "position_sigma_m = 50.0\nmax", keys + "\nmax"));
  };
  EXPECT_THAT(with(""), HasSubstr("recorded.position_sigma_m"));
  EXPECT_THAT(with("position_sigma_m = 0.0"), HasSubstr("> 0"));
  EXPECT_THAT(with("position_sigma_m = 1.0\nmin_sped_mps = 1.0"), HasSubstr("did you mean \"min_speed_mps\""));
  EXPECT_THAT(with("position_sigma_m = 1.0\nmax_gap_periods = 0.5"), HasSubstr("max_gap_periods"));
  EXPECT_THAT(with("range_sigma_m = 1.0\nbearing_sigma_deg = 1.0\nsite = [0, 5000]"),
              AllOf(HasSubstr("one.csv"), HasSubstr("measures range_m, bearing_deg"),
                    HasSubstr("east_m, north_m, which the study's trackers take")));
}

TEST_F(RecordedFileTest, StudyOnALineTakesNoPositions) {
  folder_.write("one.csv", flight(25, 45));
  testing::write_study(folder_, testing::kStudy + "\n[recorded]\nposition_sigma_m = 1.0\n[sets]\none = \"one.csv\"\n");
  EXPECT_THAT(error_message([&] { Study::load(folder_.path() / "small.toml").evaluation_scenarios(); }),
              AllOf(HasSubstr("measures east_m, north_m"), HasSubstr("position_m, which the study's trackers take")));
}

TEST_F(RecordedFileTest, SetMayBeALogWithTruth) {
  testing::write_study(folder_, testing::kStudy + "\n[sets]\none = \"log.csv\"\ntwo = \"scenario.toml\"\n");
  folder_.write("log.csv", "time_s,position_m,position_sigma_m,truth_position_m\n0,1,10,0\n1,2,10,5\n");
  const Study study = Study::load(folder_.path() / "small.toml");
  EXPECT_EQ(study.evaluation_scenarios()[0].scenario->simulate({}).measurements.size(), 2u);
  folder_.write("log.csv", "time_s,position_m,position_sigma_m,truth_position_m,truth_east_m\n0,1,10,0,0\n");
  EXPECT_THAT(error_message([&] { Study::load(folder_.path() / "small.toml").evaluation_scenarios(); }),
              AllOf(HasSubstr("sets.one"), HasSubstr("another truth")));
}

TEST_F(RecordedFileTest, LogOfSomethingElseIsRefused) {
  testing::write_study(folder_, testing::kStudy);
  const Study study = Study::load(folder_.path() / "small.toml");
  const auto path = folder_.write("log.csv", "time_s,east_m,east_sigma_m,truth_east_m,truth_north_m\n0,1,10,0,0\n");
  const auto recorded = study.recorded_scenario(path);
  EXPECT_THAT(error_message([&] { recorded->simulate({}); }),
              AllOf(HasSubstr("log.csv: measures east_m"), HasSubstr("position_m, which the study's trackers take")));
}

TEST_F(RecordedFileTest, TrackerThatReplaysNeedsLogs) {
  const std::string recorded =
      "\n[trackers.foreign]\nkind = \"recorded\"\ncomponents = [\"east_m\", \"north_m\", \"east_mps\", \"north_mps\"]\n";
  EXPECT_THAT(error_message([&] { load(kPlaneStudy + recorded); }),
              AllOf(HasSubstr("trackers.foreign.innovation"), HasSubstr("`file`")));
  EXPECT_THAT(error_message([&] { load(kPlaneStudy + recorded + "innovation = true\n"); }),
              AllOf(HasSubstr("trackers.foreign"), HasSubstr("no log to replay"), HasSubstr("step_logs")));
  const std::size_t trackers = kPlaneStudy.find("[trackers.plain]");
  const std::string logs =
      "name = \"logs\"\n[scenario]\nkind = \"step_logs\"\ntraining = [\"a.csv\"]\nevaluation = [\"a.csv\"]\n" +
      kPlaneStudy.substr(trackers);
  EXPECT_EQ(error_message([&] { load(logs + recorded + "innovation = true\n"); }), "no error");
  EXPECT_THAT(
      error_message([&] { load(logs + replaced(recorded, "\"east_m\", \"north_m\", ", "") + "innovation = true\n"); }),
      AllOf(HasSubstr("trackers.foreign.components"), HasSubstr("east_mps, north_mps")));
}

TEST_F(RecordedFileTest, ExampleOfAForeignTrackerIsValid) {
  const std::filesystem::path example =
      std::filesystem::path(TRUEBEARING_SOURCE_DIR) / "examples/foreign_tracker/foreign_tracker.toml";
  EXPECT_EQ(error_message([&] { Study::load(example); }), "no error");
}

}  // namespace
}  // namespace truebearing::recorded_file_test
