// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/app/program_tests.hpp"
#include "tests/support/array_recording.hpp"
#include "tests/support/flight_study.hpp"
#include "truebearing/io/json_file.hpp"
#include "truebearing/recording/recording_csv.hpp"
#include "truebearing/recording/snapshot_log.hpp"
#include "truebearing/tracker/step_log.hpp"

namespace truebearing::app_test::command_line_test {
namespace {

using nlohmann::json;
using testing::kFlightStudy;

TEST(Program, WrongUsageIsStatus2) {
  const TemporaryFolder folder;
  for (const char* wrong : {"", "fly", "check", "compare", "compare small.toml --rnus 3", "compare small.toml --runs 0",
                            "compare small.toml --runs many", "compare small.toml --threads -1",
                            "simulate scenario.toml", "track small.toml", "rules a b", "--nonsense"}) {
    const Outcome outcome = run(folder, wrong);
    EXPECT_EQ(outcome.status, 2) << wrong;
    EXPECT_THAT(outcome.err, ::testing::StartsWith("truebearing: ")) << wrong;
    EXPECT_TRUE(is_one_line(outcome.err)) << wrong << "\n" << outcome.err;
    EXPECT_TRUE(outcome.out.empty()) << wrong;
  }
}

TEST(Program, TrackWritesWhatTrackersNoticed) {
  const TemporaryFolder folder;
  write_study(folder);
  folder.write("plain.toml", kStudy.substr(0, kStudy.find("[trackers.tuned]")).replace(kStudy.find("pairs"), 24, ""));
  folder.write("good.csv", "time_s,position_m\n1,100\n2,110\n");
  const Outcome none = run(folder, "track plain.toml good.csv --events -");
  EXPECT_EQ(none.status, 0) << none.err;
  EXPECT_EQ(none.out, "tracker,time_s,event,value\n") << "a filter notices nothing";
}

TEST(Program, HelpAndVersionAreStatus0) {
  const TemporaryFolder folder;
  for (const char* fine : {"--help", "--version", "compare --help", "keys --help"}) {
    const Outcome outcome = run(folder, fine);
    EXPECT_EQ(outcome.status, 0) << fine;
    EXPECT_FALSE(outcome.out.empty()) << fine;
  }
}

TEST(Program, BadInputIsStatus1AndOneLineThatNamesWhereAndWhat) {
  const TemporaryFolder folder;
  write_study(folder);
  folder.write("misspelt.toml", replaced(kStudy, "runs = 20\nseed", "rnus = 20\nseed"));
  folder.write("broken.toml", "name = = 1\n");
  folder.write("units.toml", replaced(kStudy, "variance_m2 = 1e7", "sigma_mm = 50.0"));
  folder.write("bell.toml", replaced(kStudy, "\"small\"", "\"sma\\u0007ll\""));
  folder.write("nameless.toml", replaced(kStudy, "\"small\"", "\"\""));
  folder.write("strange.toml", kStudy + "[trackers.\"pl\\nain\"]\nlike = \"plain\"\n");
  folder.write("text.csv", "time_s,position_m\n1,100\n2,ten\n");
  folder.write("back.csv", "time_s,position_m\n1,100\n3,200\n2,150\n");
  folder.write("bearings.csv", "time_s,bearing_deg\n1,100\n");
  folder.write("good.csv", "time_s,position_m\n1,100\n2,110\n");
  folder.write("bad.json", "{\"format\": \"other\"}");
  folder.write("deep.json", std::string(100000, '['));
  folder.write("plain.toml", kStudy.substr(0, kStudy.find("[trackers.tuned]")).replace(kStudy.find("pairs"), 24, ""));
  const std::vector<std::pair<std::string, std::string>> cases{
      {"check nowhere.toml", "nowhere.toml"},
      {"check misspelt.toml", "misspelt.toml:4: rnus"},
      {"check misspelt.toml", "did you mean \"runs\""},
      {"check broken.toml", "broken.toml:1"},
      {"check units.toml", "units.toml"},
      {"check units.toml", "sigma_mm"},
      {"check bell.toml", "is no name: \"sma\\x07ll\""},
      {"check nameless.toml", "nameless.toml:1: name: is no name"},
      {"check strange.toml", "is no name: \"pl\\nain\""},
      {"compare small.toml", "truebearing train small.toml"},
      {"track plain.toml text.csv", "text.csv:3"},
      {"track plain.toml text.csv", "position_m"},
      {"track plain.toml back.csv", "back.csv:4"},
      {"track plain.toml bearings.csv", "position_m"},
      {"track plain.toml nowhere.csv", "nowhere.csv"},
      {"rules bad.json", "bad.json: format"},
      {"rules deep.json", "64 levels"},
      {"rules nowhere.json", "nowhere.json"},
      {"tune plain.toml", "tune"},
      {"train plain.toml", "corrected"},
      {"train small.toml --tracker plain", "plain"},
      {"train small.toml --tracker nfn", "did you mean \"nfnn\""},
      {"train manoeuvre_2d --tracker gru -o -", "two files"}};
  for (const auto& [arguments, says] : cases) {
    const Outcome outcome = run(folder, arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(says)) << arguments;
    EXPECT_TRUE(is_one_line(outcome.err)) << arguments << "\n" << outcome.err;
    EXPECT_THAT(outcome.err, ::testing::Not(HasSubstr("internal error"))) << arguments;
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST(Program, WorksFromScenarioToRules) {
  const TemporaryFolder folder;
  write_study(folder);
  std::filesystem::remove(folder.path() / "small.parameters.toml");

  const Outcome tuned = run(folder, "tune small.toml --quiet");
  EXPECT_EQ(tuned.status, 0) << tuned.err;
  EXPECT_EQ(tuned.err, "") << "quiet";
  const Outcome trained = run(folder, "train small.toml --quiet --threads 1");
  EXPECT_EQ(trained.status, 0) << trained.err;
  EXPECT_EQ(trained.err, "");
  const std::string parameters = folder.read("small.parameters.toml"), model = folder.read("small.nfnn.json");

  EXPECT_EQ(run(folder, "check small.toml").status, 0);
  const Outcome rules = run(folder, "rules small.nfnn.json --sentences");
  EXPECT_EQ(rules.status, 0) << rules.err;
  EXPECT_THAT(rules.out, AllOf(HasSubstr("1. IF"), HasSubstr("4. IF"), HasSubstr("validation")));

  // The same bits again, on another number of threads.
  EXPECT_EQ(run(folder, "tune small.toml --quiet -o again.toml --threads 2").status, 0);
  EXPECT_EQ(run(folder, "train small.toml --quiet -o again.json --threads 2").status, 0);
  EXPECT_EQ(folder.read("again.toml"), parameters);
  EXPECT_EQ(folder.read("again.json"), model);

  const auto compared = [&](const std::string& arguments) {
    const Outcome outcome = run(folder, "compare small.toml --json - " + arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "") << "no progress where output is piped";
    json report = json::parse(outcome.out);  // and nothing else
    for (auto& [name, tracker] : report["trackers"].items()) tracker.erase("ns_per_step");
    return report.dump(2);
  };
  const std::string one = compared("--threads 1");
  EXPECT_EQ(compared("--threads 2"), one);
  EXPECT_EQ(compared("--threads 8"), one);
  EXPECT_NE(compared("--seed 6"), one);
  EXPECT_EQ(json::parse(one)["trackers"].size(), 3u);

  const Outcome afresh = run(folder, "compare small.toml --retrain --runs 5 --json report.json");
  EXPECT_EQ(afresh.status, 0) << afresh.err;
  EXPECT_THAT(afresh.out, HasSubstr("nfnn - tuned"));
  EXPECT_EQ(json::parse(folder.read("report.json"))["runs"], 5);
  EXPECT_EQ(folder.read("small.nfnn.json"), model) << "files are left alone";
  EXPECT_EQ(folder.read("small.parameters.toml"), parameters);
}

std::string plain_study() {
  std::string study = kStudy.substr(0, kStudy.find("[trackers.tuned]"));
  return replaced(study, "pairs = [\"nfnn - tuned\"]\n", "");
}

TEST(Program, TracksWhatItSimulated) {
  const TemporaryFolder folder;
  write_study(folder, plain_study());
  const Outcome simulated = run(folder, "simulate scenario.toml --seed 3 --runs 2 -o logs");
  EXPECT_EQ(simulated.status, 0) << simulated.err;
  EXPECT_EQ(simulated.out + simulated.err, "");
  const std::string log = folder.read("logs/run_0001.csv");
  EXPECT_THAT(log, HasSubstr("truth_position_m"));
  EXPECT_EQ(run(folder, "simulate scenario.toml --seed 3 --runs 2 -o again").status, 0);
  EXPECT_EQ(folder.read("again/run_0001.csv"), log);

  const Outcome tracked = run(folder, "track small.toml logs/run_0001.csv -o steps.csv --json scores.json");
  EXPECT_EQ(tracked.status, 0) << tracked.err;
  EXPECT_THAT(tracked.out, AllOf(HasSubstr("40 measurements"), HasSubstr("NIS/expected")));
  const StepLog steps = read_step_log(folder.path() / "steps.csv", "plain");
  EXPECT_EQ(steps.records.size(), 40u);
  EXPECT_TRUE(json::parse(folder.read("scores.json"))["trackers"]["plain"]["rmse"]["position_m"].is_number());

  // From standard input, to standard output: the same steps and nothing else.
  const Outcome piped = run(folder, "track small.toml - -o - < logs/run_0001.csv");
  EXPECT_EQ(piped.status, 0) << piped.err;
  EXPECT_EQ(piped.out, folder.read("steps.csv"));
  const Outcome scores = run(folder, "track small.toml - --json - < logs/run_0001.csv");
  EXPECT_EQ(scores.status, 0) << scores.err;
  EXPECT_TRUE(json::parse(scores.out).contains("trackers"));
}

// A track in the plane begins before its filter has an innovation, which the columns must hold all the same.
// Range, bearing and range rate of a Doppler radar, from a scenario to a comparison and a track, by three filters.
TEST(Program, FollowsWhatADopplerRadarMeasures) {
  const TemporaryFolder folder;
  folder.write("scenario.toml", R"(kind = "planar_legs"
output = "range_bearing_rate"
period_s = 1.0
target = { position_m = [8000.0, 12000.0], velocity_mps = [-60.0, 20.0] }
legs = [{ duration_s = 30.0 }, { duration_s = 20.0, turn_rate_degps = 3.0 }, { duration_s = 30.0 }]
sensor = { range_sigma_m = 30.0, bearing_sigma_deg = 0.3, range_rate_sigma_mps = 0.5 }
)");
  folder.write("study.toml", R"(name = "doppler"
scenario = "scenario.toml"
runs = 100
scoring = { from_step = 10, pairs = ["imm - kalman"] }
[trackers.kalman]
kind = "kalman"
motion = { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 2.0 }
measurement = { model = "range_bearing_rate", range_sigma_m = 30.0, bearing_sigma_deg = 0.3, range_rate_sigma_mps = 0.5 }
start = { kind = "two_point" }
[trackers.unscented]
like = "kalman"
kind = "unscented"
[trackers.imm]
kind = "imm"
measurement = { model = "range_bearing_rate", range_sigma_m = 30.0, bearing_sigma_deg = 0.3, range_rate_sigma_mps = 0.5 }
start = { kind = "two_point" }
modes = [
  { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 0.5 },
  { model = "coordinated_turn", noise = "discrete", sigma_a_mps2 = 1.0, turn_rates_degps = [-3.0, 3.0] },
]
transition = { leave_first = 0.04, leave_other = 0.1, to_first = 0.8, period_s = 1.0 }
)");
  const Outcome compared = run(folder, "compare study.toml --json result.json");
  ASSERT_EQ(compared.status, 0) << compared.err;
  const auto result = read_json_file(folder.path() / "result.json").at("trackers");
  for (const char* name : {"kalman", "unscented", "imm"}) {
    EXPECT_LT(result.at(name).at("rmse").at("position_m").get<double>(), 60.0) << name;
    EXPECT_LT(result.at(name).at("rmse").at("velocity_mps").get<double>(), 12.0) << name;
  }
  EXPECT_LT(result.at("imm").at("rmse").at("velocity_mps").get<double>(),
            result.at("kalman").at("rmse").at("velocity_mps").get<double>());
  ASSERT_EQ(run(folder, "simulate scenario.toml -o logs").status, 0);
  EXPECT_THAT(folder.read("logs/run_0000.csv"), HasSubstr("range_rate_mps"));
  const Outcome tracked = run(folder, "track study.toml logs/run_0000.csv -o track.csv");
  EXPECT_EQ(tracked.status, 0) << tracked.err;
}

TEST(Program, TrackWritesInnovationsWhole) {
  const TemporaryFolder folder;
  const std::string data = std::string(TRUEBEARING_SOURCE_DIR) + "/data/";
  ASSERT_EQ(run(folder, "simulate " + data + "scenarios/manoeuvre_2d.toml -o logs").status, 0);
  const Outcome tracked = run(folder, "track " + data + "studies/manoeuvre_2d.toml logs/run_0000.csv -o steps.csv");
  ASSERT_EQ(tracked.status, 0) << tracked.err;
  const std::vector<StepRecord> plain = read_step_log(folder.path() / "steps.csv", "plain").records;
  ASSERT_FALSE(plain.empty());
  EXPECT_FALSE(plain.front().innovation);
  ASSERT_TRUE(plain.back().innovation);
  EXPECT_EQ(plain.back().innovation->nu.size(), 2);
  const std::vector<StepRecord> corrected = read_step_log(folder.path() / "steps.csv", "nfnn").records;
  EXPECT_EQ(corrected.size(), plain.size());
  for (const StepRecord& record : corrected) EXPECT_FALSE(record.innovation) << "which a correction has none of";
}

TEST(Program, SimulatesBearingsOfARecordedTrack) {
  const TemporaryFolder folder;
  std::string positions = "time_s,vessel,latitude_deg,longitude_deg\n";
  for (int k = 0; k < 30; ++k)
    for (int vessel = 1; vessel <= 2; ++vessel)
      positions += std::to_string(10 * k) + "," + std::to_string(vessel) + "," +
                   std::to_string(50.0 + 5e-4 * k * vessel) + ",-1.0\n";
  folder.write("ais.csv", positions);
  const std::string scenario = std::string(TRUEBEARING_SOURCE_DIR) + "/data/scenarios/bearings_of_a_vessel.toml";
  const Outcome simulated =
      run(folder, "simulate " + scenario + " --track ais.csv --track-id 2 --track-from 50 --quiet -o logs");
  EXPECT_EQ(simulated.status, 0) << simulated.err;
  const Recording log = read_recording(folder.path() / "logs/run_0000.csv");
  ASSERT_EQ(log.measurements.size(), 25u);
  EXPECT_NEAR(log.truth[0].x[0].head<2>().norm(), 6000.0, 1e-6) << "the scenario's range";
  EXPECT_NEAR(log.truth[0].x[5][3], 1e-4 * 111230.0, 0.01) << "the track's speed";

  const Outcome unsaid = run(folder, "simulate " + scenario + " --track ais.csv -o none");
  EXPECT_EQ(unsaid.status, 1);
  EXPECT_THAT(unsaid.err, AllOf(HasSubstr("ais.csv"), HasSubstr("1, 2")));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "none"));
  EXPECT_EQ(run(folder, "simulate " + scenario + " --track-id 2 -o none").status, 2);
  write_study(folder, plain_study());
  EXPECT_THAT(run(folder, "simulate scenario.toml --track ais.csv -o none").err, HasSubstr("bearings_only"));
}

TEST(Program, TrackWithoutATruthIsNamed) {
  const TemporaryFolder folder;
  folder.write("gps.csv", "time_s,east_m,north_m\n0,1,2\n1,2,3\n");
  const Outcome outcome = run(folder, "simulate bearings_only_m --track gps.csv -o logs");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("truebearing: gps.csv: has no truth of one target")) << outcome.err;
}

TEST(Program, MissingCellsAreCoastedAndCounted) {
  const TemporaryFolder folder;
  write_study(folder, plain_study());
  folder.write("with.csv", "time_s,position_m\n1,100\n2,\n3,nan\n4,inf\n5,300\n5,300\n6,400\n");
  folder.write("without.csv", "time_s,position_m\n1,100\n5,300\n6,400\n");
  const Outcome with = run(folder, "track small.toml with.csv -o with_steps.csv");
  EXPECT_EQ(with.status, 0) << with.err;
  EXPECT_THAT(with.out, HasSubstr("6 measurements, 3 missing, 1 repeated rows dropped"));
  EXPECT_EQ(run(folder, "track small.toml without.csv -o without_steps.csv").status, 0);
  const StepLog a = read_step_log(folder.path() / "with_steps.csv"),
                b = read_step_log(folder.path() / "without_steps.csv");
  ASSERT_EQ(a.records.size(), 6u);
  ASSERT_EQ(b.records.size(), 3u);
  for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 0}, {4, 1}, {5, 2}}) {
    EXPECT_EQ(a.records[i].x, b.records[j].x);
    EXPECT_EQ(a.records[i].P, b.records[j].P);
  }
  EXPECT_EQ(a.records[2].status, StepStatus::coasted);
}

TEST(Program, WrongUnitIsReported) {
  const TemporaryFolder folder;
  write_study(folder, plain_study());
  for (const double unit : {1e3, 1e-3}) {
    std::ostringstream log;
    log << "time_s,position_m\n";
    for (int k = 1; k <= 20; ++k) log << k << ',' << unit * (5000.0 + 200.0 * k + (k % 3 - 1) * 3000.0) << '\n';
    folder.write("log.csv", log.str());
    const Outcome outcome = run(folder, "track small.toml log.csv");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("plain"), HasSubstr(unit > 1.0 ? "another unit" : "a sigma too large")))
        << unit;
  }
}

TEST(Program, FailedCommandLeavesItsOutputsAsTheyWere) {
  const TemporaryFolder folder;
  write_study(folder, plain_study());
  folder.write("bad.csv", "time_s,position_m\n1,100\n2,ten\n");
  folder.write("steps.csv", "the old steps");
  folder.write("scores.json", "the old scores");
  const int files = folder.files();
  EXPECT_EQ(run(folder, "track small.toml bad.csv -o steps.csv --json scores.json").status, 1);
  EXPECT_EQ(run(folder, "compare nowhere.toml --json scores.json").status, 1);
  EXPECT_EQ(run(folder, "train small.toml -o steps.csv").status, 1);
  EXPECT_EQ(run(folder, "tune small.toml -o steps.csv").status, 1);
  EXPECT_EQ(folder.read("steps.csv"), "the old steps");
  EXPECT_EQ(folder.read("scores.json"), "the old scores");
  EXPECT_EQ(folder.files(), files) << "nothing is left behind";
}

TEST(Program, OutputThatCannotBeWrittenIsStatus1) {
  const TemporaryFolder folder;
  write_study(folder, plain_study());
  for (const char* arguments :
       {"compare small.toml --runs 2 --json nowhere/report.json", "simulate scenario.toml -o small.toml",
        "compare small.toml --runs 2 --json - > /dev/full", "check small.toml > /dev/full"}) {
    const Outcome outcome = run(folder, arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_TRUE(is_one_line(outcome.err)) << arguments << "\n" << outcome.err;
    EXPECT_THAT(outcome.err, ::testing::Not(HasSubstr("internal error"))) << arguments;
  }
}

TEST(Program, ComparesOnRecordedPositions) {
  const TemporaryFolder folder;
  folder.write("flight.toml", kFlightStudy);
  folder.write("bare.toml", replaced(kFlightStudy, "[recorded]\nposition_sigma_m = 50.0\nmax_speed_mps = 400.0\n", ""));
  std::ostringstream track;
  track << "time_s,latitude_deg,longitude_deg\n";
  for (int k = 0; k < 30; ++k) track << k << ',' << (k == 20 ? 46.0 : 45.0 + 0.001 * k) << ",7.5\n";
  folder.write("track.csv", track.str());
  const Outcome compared = run(folder, "compare flight.toml --truth track.csv --json report.json");
  EXPECT_EQ(compared.status, 0) << compared.err;
  EXPECT_THAT(compared.out, HasSubstr("track.csv: tracks: 1; 30 measurements, 1 missing, 1 of them glitches"));
  const double rmse_m = json::parse(folder.read("report.json"))["trackers"]["plain"]["rmse"]["position_m"];
  EXPECT_GT(rmse_m, 10.0);
  EXPECT_LT(rmse_m, 50.0 * std::sqrt(2.0)) << "better than the measurements";

  for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
           {"compare bare.toml --truth track.csv", "[recorded] with position_sigma_m in bare.toml"},
           {"track flight.toml track.csv", "truebearing compare flight.toml --truth track.csv"},
           {"compare flight.toml --truth nowhere.csv", "nowhere.csv"}}) {
    const Outcome outcome = run(folder, arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(says)) << arguments;
    EXPECT_TRUE(is_one_line(outcome.err)) << arguments << "\n" << outcome.err;
  }
}

TEST(Program, SnapshotLogOfAnotherSensorIsRefused) {
  const TemporaryFolder folder;
  write_study(folder, plain_study());
  write_snapshot_log(folder.path() / "log.h5", testing::array_recording());
  write_snapshot_log(folder.path() / "unnamed", testing::array_recording());
  folder.write("text.h5", "time_s,position_m\n1,100\n");
  for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
           {"track small.toml log.h5 -o steps.csv", "log.h5: measures snapshots"},
           {"track small.toml unnamed -o steps.csv", "unnamed: measures snapshots"},
           {"track small.toml text.h5 -o steps.csv", "text.h5: is no HDF5 file"},
           {"compare small.toml --truth log.h5 --json steps.csv", "log.h5: measures snapshots"},
           {"compare small.toml --truth none.h5 --json steps.csv", "none.h5: cannot be opened"}}) {
    const Outcome outcome = run(folder, arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(says)) << arguments;
    EXPECT_TRUE(is_one_line(outcome.err)) << arguments << "\n" << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "steps.csv")) << arguments;
  }
}

TEST(Program, TracksEveryTrackOfAStepLog) {
  const TemporaryFolder folder;
  folder.write("study.toml", R"(name = "logs"
[scenario]
kind = "step_logs"
space = "line"
training = ["*.none"]
evaluation = ["*.none"]
[trackers.foreign]
kind = "recorded"
components = ["position_m", "velocity_mps"]
innovation = false
)");
  const std::string header = "time_s,track,x_position_m,x_velocity_mps,P_1_1,P_1_2,P_2_2";
  const std::string rows[] = {"1,3,10,2,4,1,9", "1,8,-5,0,4,0,9", "2,3,12,2,4,1,9"};
  folder.write("log.csv", header + "\n" + rows[0] + "\n" + rows[1] + "\n" + rows[2] + "\n");
  folder.write("truth.csv", header + ",truth_position_m\n" + rows[0] + ",11\n" + rows[1] + ",-5\n" + rows[2] + ",13\n");
  const Outcome tracked = run(folder, "track study.toml log.csv -o steps.csv");
  EXPECT_EQ(tracked.status, 0) << tracked.err;
  EXPECT_THAT(tracked.out, HasSubstr("3 measurements, 3 missing"));
  const StepLog steps = read_step_log(folder.path() / "steps.csv", "foreign");
  ASSERT_EQ(steps.records.size(), 3u);
  EXPECT_EQ(steps.records[0].track, 3);
  EXPECT_EQ(steps.records[1].track, 8);
  EXPECT_EQ(steps.records[2].x[0], 12.0);
  const Outcome scored = run(folder, "track study.toml truth.csv --json -");
  EXPECT_EQ(scored.status, 0) << scored.err;
  const json report = json::parse(scored.out);
  EXPECT_EQ(report["runs"], 2) << "one per track";
  EXPECT_NEAR(report["trackers"]["foreign"]["rmse"]["position_m"].get<double>(), std::sqrt(2.0 / 3.0), 1e-9);
  const Outcome none = run(folder, "compare study.toml");
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.err, HasSubstr("matches no file"));
}

}  // namespace
}  // namespace truebearing::app_test::command_line_test
