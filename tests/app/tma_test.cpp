// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/app/program_tests.hpp"
#include "tests/support/bearing_frequency_runs.hpp"
#include "tests/support/bearing_runs.hpp"
#include "truebearing/recording/recording_csv.hpp"

namespace truebearing::app_test::tma_test {
namespace {

using nlohmann::json;

// The first bearings of one of Cho's runs, as a log with truth.
std::string log_until(double end_s) {
  Recording recording = testing::data_scenario("cho_s1")->simulate({1, Role::evaluation, 0});
  while (recording.measurements.back().time_s > end_s) {
    recording.measurements.pop_back();
    recording.truth[0].x.pop_back();
  }
  return write_recording(recording);
}

TEST(TmaCommand, SaysRangeCourseAndSpeedWithTheirSpread) {
  const TemporaryFolder folder;
  folder.write("log.csv", log_until(1000.0));
  const Outcome text = run(folder, "tma log.csv");
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("range m"), HasSubstr("course deg"), HasSubstr("speed m/s"),
                              HasSubstr("95 % ellipse"), HasSubstr("white"), Not(HasSubstr("not determined"))));

  const Outcome outcome = run(folder, "tma log.csv --json -");
  const json answer = json::parse(outcome.out);
  EXPECT_TRUE(answer["range_determined"]);
  for (const char* key : {"range_m", "course_deg", "speed_mps", "east_m", "north_m"}) {
    const double error = answer["estimate"][key].get<double>() - answer["truth"][key].get<double>();
    EXPECT_LT(std::abs(error), 5.0 * answer["standard_deviation"][key].get<double>()) << key;
  }
  EXPECT_LT(answer["standard_deviation"]["range_m"].get<double>(), 500.0);
  EXPECT_FALSE(answer["manoeuvre"]["detected"]);
  EXPECT_EQ(answer["solver"]["starts"], 3);
}

// The target of tests/recording/logs/passive.rep, whose comment says how it goes: at the last bearing, 2380 s after the
// beginning, -9505 m East and 4812 m North of own ship's first position, which at the first bearing is 32, 26 m away.
TEST(TmaCommand, ReadsTheReplayFilesOfDebrief) {
  const TemporaryFolder folder;
  const std::string log = TRUEBEARING_SOURCE_DIR "/tests/recording/logs/passive.rep";
  const Outcome outcome = run(folder, "tma " + log + " --sigma 0.5 --frequency-sigma 0.01 --json -");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json answer = json::parse(outcome.out);
  EXPECT_TRUE(answer["range_determined"]);
  const auto expect = [&](const char* key, double truth) {
    EXPECT_LT(std::abs(answer["estimate"][key].get<double>() - truth),
              4.0 * answer["standard_deviation"][key].get<double>())
        << key;
  };
  expect("east_m", -9505.4 - 31.5);
  expect("north_m", 4812.4 - 26.5);
  expect("range_m", 16917.0);
  expect("course_deg", 250.0);
  expect("speed_mps", 10.0 * 1852.0 / 3600.0);
  EXPECT_LT(answer["standard_deviation"]["range_m"].get<double>(), 200.0);
  EXPECT_THAT(run(folder, "check " + log).out, AllOf(HasSubstr("80 rows"), HasSubstr("can be used")));
  const Outcome tracked = run(folder, "track passive_sonar_a " + log);
  EXPECT_EQ(tracked.status, 0) << tracked.err;
  EXPECT_THAT(tracked.out, HasSubstr("80 measurements, 0 missing"));
}

TEST(TmaCommand, SaysPlainlyWhereTheRangeIsNotDetermined) {
  const TemporaryFolder folder;
  folder.write("log.csv", log_until(200.0));  // before own ship's first turn
  const Outcome text = run(folder, "tma log.csv");
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("not determined"), HasSubstr("DO NOT DETERMINE THE RANGE"),
                              HasSubstr("at any range"), Not(HasSubstr("95 % ellipse"))));
  const json answer = json::parse(run(folder, "tma log.csv --json -").out);
  EXPECT_FALSE(answer["range_determined"]);
  EXPECT_LT(answer["observability"]["rank"], 4);
  EXPECT_EQ(answer["hypotheses"].size(), 6u);
  EXPECT_NEAR(answer["hypotheses"][2]["range_m"].get<double>(), 5000.0, 1.0);
}

TEST(TmaCommand, EveryMethodAnswers) {
  const TemporaryFolder folder;
  folder.write("log.csv", log_until(600.0));
  for (const char* method : {"ml", "map", "gauss_newton", "levenberg", "levenberg_marquardt"}) {
    const Outcome outcome = run(folder, std::string("tma log.csv --json - --method ") + method);
    EXPECT_EQ(outcome.status, 0) << method << outcome.err;
    EXPECT_NEAR(json::parse(outcome.out)["estimate"]["bearing_deg"].get<double>(),
                json::parse(outcome.out)["truth"]["bearing_deg"].get<double>(), 3.0)
        << method;
  }
  EXPECT_EQ(run(folder, "tma log.csv --method newton").status, 2);
}

TEST(TmaCommand, ReportsAManoeuvreInsideTheWindow) {
  const TemporaryFolder folder;
  folder.write("turn.toml", testing::kTurningTarget);
  ASSERT_EQ(run(folder, "simulate turn.toml -o logs").status, 0);
  const Outcome outcome = run(folder, "tma logs/run_0000.csv");
  EXPECT_THAT(outcome.out, HasSubstr("CHANGED ITS VELOCITY"));
  const json answer = json::parse(run(folder, "tma logs/run_0000.csv --json -").out);
  EXPECT_NEAR(answer["manoeuvre"]["time_s"].get<double>(), 1000.0, 150.0);
  EXPECT_FALSE(json::parse(run(folder, "tma logs/run_0000.csv --to 900 --json -").out)["manoeuvre"]["detected"]);
}

// Kim and Song's scenario with frequencies, as a log with truth; every tenth frequency is missing.
std::string frequency_log(const std::function<double(double)>& f0_hz, bool with_velocity = true) {
  using testing::KimSong;
  RandomStream stream({1, Role::evaluation, 0}, StreamId::test);
  Recording recording;
  recording.measured = {"bearing_deg", "frequency_hz"};
  recording.truth_space = &plane_frequency_space();
  recording.truth.resize(1);
  int k = 0;
  for (double t = 0.0; t <= KimSong::kEnd_s; t += KimSong::kPeriod_s) {
    Measurement measurement{.time_s = t,
                            .z = KimSong::measured(t, f0_hz(t), 1.0, stream),
                            .sigma = Eigen::Vector2d(KimSong::kSigma_rad, KimSong::kSigma_hz),
                            .sensor = KimSong::own_ship(t)};
    if (++k % 10 == 0) measurement.z[1] = std::nan("");
    if (!with_velocity) measurement.sensor->velocity_mps.setZero();
    recording.measurements.push_back(measurement);
    BoundedVector x(5);
    x << KimSong::target(t), f0_hz(t);
    recording.truth[0].x.push_back(x);
  }
  return write_recording(recording);
}

TEST(TmaCommand, UsesFrequenciesAndSaysWhatTheSourceSends) {
  const TemporaryFolder folder;
  folder.write("log.csv", frequency_log(testing::jump(0.0)));
  const Outcome text = run(folder, "tma log.csv");
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("136 frequencies, 15 missing"), HasSubstr("source Hz"),
                              HasSubstr("no sign that the source changed"), Not(HasSubstr("CHANGED"))));
  const json answer = json::parse(run(folder, "tma log.csv --json -").out);
  const json only_bearings = json::parse(run(folder, "tma log.csv --bearings-only --json -").out);
  EXPECT_NEAR(answer["estimate"]["frequency_hz"].get<double>(), answer["truth"]["frequency_hz"].get<double>(), 0.05);
  EXPECT_LT(2.0 * answer["standard_deviation"]["range_m"].get<double>(),
            only_bearings["standard_deviation"]["range_m"].get<double>());
  EXPECT_TRUE(answer["source"]["used"]);
  EXPECT_FALSE(only_bearings.contains("source"));
  EXPECT_EQ(answer["residuals"]["degrees_of_freedom"], 151 + 136 - 5);
}

TEST(TmaCommand, SaysClearlyWhenTheSourceChanged) {
  const TemporaryFolder folder;
  folder.write("log.csv", frequency_log(testing::jump(30.0, 600.0, 800.0)));
  const Outcome text = run(folder, "tma log.csv");
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("THE SOURCE CHANGED ITS FREQUENCY at 602 s"), HasSubstr("and again at 805 s")));
  const json answer = json::parse(run(folder, "tma log.csv --json -").out);
  ASSERT_EQ(answer["source"]["changes"].size(), 2u);
  EXPECT_EQ(answer["source"]["changes"][0]["time_s"], 602.0);
  EXPECT_NEAR(answer["source"]["changes"][0]["frequency_hz"].get<double>(), 130.0, 0.1);
  ASSERT_EQ(answer["source"]["levels"].size(), 3u);
  EXPECT_EQ(answer["source"]["levels"][0]["frequency_hz"], answer["source"]["levels"][2]["frequency_hz"]);
  EXPECT_THAT(run(folder, "tma log.csv --frequency-changes switch").out, HasSubstr("bearings alone"));
  EXPECT_THAT(run(folder, "tma log.csv --frequency-changes ignored").out, HasSubstr("taken for granted"));
  const json ignored = json::parse(run(folder, "tma log.csv --frequency-changes ignored --json -").out);
  EXPECT_FALSE(ignored["residuals"]["fits"]);
}

TEST(TmaCommand, SaysThatASmallJumpMayBeAManoeuvre) {
  const TemporaryFolder folder;
  folder.write("small.csv", frequency_log(testing::jump(0.06, 600.0, 800.0)));
  folder.write("large.csv", frequency_log(testing::jump(30.0, 600.0, 800.0)));
  EXPECT_THAT(run(folder, "tma small.csv").out,
              AllOf(HasSubstr("THE SOURCE CHANGED ITS FREQUENCY"), HasSubstr("Or the target manoeuvred: ")));
  EXPECT_THAT(run(folder, "tma large.csv").out, Not(HasSubstr("Or the target manoeuvred")));
}

TEST(TmaCommand, FrequenciesThatCannotBeUsedAreOneLineErrors) {
  const TemporaryFolder folder;
  folder.write("log.csv", frequency_log(testing::jump(0.0)));
  folder.write("still.csv", frequency_log(testing::jump(0.0), false));
  for (const auto& [arguments, word] : std::vector<std::pair<std::string, std::string>>{
           {"log.csv --method gauss_newton", "--bearings-only"}, {"still.csv", "sensor_east_mps"}}) {
    const Outcome outcome = run(folder, "tma " + arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(word));
  }
  EXPECT_EQ(run(folder, "tma log.csv --method gauss_newton --bearings-only").status, 0);
  EXPECT_EQ(run(folder, "tma still.csv --bearings-only").status, 0);
}

// A log in which one cell of a row is replaced.
std::string with_cell(const std::string& log, std::size_t line, std::size_t column, const std::string& cell) {
  std::istringstream in(log);
  std::string changed, row;
  for (std::size_t k = 1; std::getline(in, row); ++k) {
    if (k == line) {
      std::size_t begin = 0;
      for (std::size_t c = 0; c < column; ++c) begin = row.find(',', begin) + 1;
      row.replace(begin, row.find(',', begin) - begin, cell);
    }
    changed += row + "\n";
  }
  return changed;
}

TEST(TmaCommand, NamesTheRowOfAnOutlierAndNoManoeuvre) {
  const TemporaryFolder folder;
  folder.write("log.csv", with_cell(log_until(1000.0), 42, 1, "500"));
  const Outcome text = run(folder, "tma log.csv");
  EXPECT_THAT(text.out.substr(0, text.out.find('\n')), AllOf(HasSubstr("outlier"), HasSubstr("line 42")));
  EXPECT_THAT(text.out, HasSubstr("no sign that the target changed its velocity"));
  const json answer = json::parse(run(folder, "tma log.csv --json -").out);
  EXPECT_FALSE(answer["manoeuvre"]["detected"]);
  EXPECT_EQ(answer["outliers"]["bearings"].size(), 1u);
  EXPECT_EQ(answer["outliers"]["bearings"][0]["line"], 42);
  EXPECT_EQ(answer["causes"][0]["kind"], "outliers");
  EXPECT_EQ(answer["verdict"], text.out.substr(0, text.out.find('\n')));
}

TEST(TmaCommand, SeesNoManoeuvreOfASteadyTargetByAnyMethod) {
  const TemporaryFolder folder;
  folder.write("log.csv", log_until(1000.0));
  folder.write("open.csv", log_until(300.0));
  for (const char* method :
       {"--method ml", "--huber 2", "--method map", "--method levenberg", "--method levenberg_marquardt"})
    for (const char* log : {"log.csv", "open.csv"}) {
      const json answer = json::parse(run(folder, fmt::format("tma {} {} --json -", log, method)).out);
      EXPECT_FALSE(answer["manoeuvre"]["detected"]) << method << log;
      EXPECT_EQ(answer["range_determined"], std::string(log) == "log.csv") << method << log;
    }
}

TEST(TmaCommand, SaysNullWhereNothingIsKnown) {
  const TemporaryFolder folder;
  folder.write("log.csv", log_until(200.0));
  const json answer = json::parse(run(folder, "tma log.csv --json -").out);
  for (const char* key : {"range_m", "course_deg", "speed_mps", "east_m", "north_mps"}) {
    EXPECT_TRUE(answer["estimate"][key].is_null()) << key;
    EXPECT_TRUE(answer["standard_deviation"][key].is_null()) << key;
  }
  EXPECT_TRUE(answer["estimate"]["bearing_deg"].is_number());
  EXPECT_TRUE(answer["ellipse95"]["semi_major_m"].is_null());
}

TEST(TmaCommand, SaysWhichSigmaWouldFit) {
  const TemporaryFolder folder;
  folder.write("log.csv", log_until(1000.0));
  for (const auto& [sigma, kind] : {std::pair("5", "noise_smaller"), std::pair("0.1", "noise_larger")}) {
    const json answer = json::parse(run(folder, fmt::format("tma log.csv --json - --sigma {}", sigma)).out);
    EXPECT_FALSE(answer["residuals"]["fits"]) << sigma;
    EXPECT_NEAR(answer["residuals"]["bearing_sigma_that_fits_deg"].get<double>(), 1.0, 0.15) << sigma;
    ASSERT_EQ(answer["causes"].size(), 1u) << sigma;
    EXPECT_EQ(answer["causes"][0]["kind"], kind);
  }
}

TEST(TmaCommand, OfBearingsThatAreAllTheSameSaysSo) {
  const TemporaryFolder folder;
  std::string log = "time_s,bearing_deg,bearing_sigma_deg,sensor_east_m,sensor_north_m\n";
  for (int i = 0; i < 30; ++i) log += fmt::format("{},45,1,{},0\n", 4 * i, 20 * i);
  folder.write("log.csv", log);
  const Outcome text = run(folder, "tma log.csv");
  EXPECT_THAT(text.out,
              AllOf(HasSubstr("SMALLER THAN THE NOISE"), Not(HasSubstr("nan")), Not(HasSubstr("as it should"))));
  const json answer = json::parse(run(folder, "tma log.csv --json -").out);
  EXPECT_TRUE(answer["residuals"]["lag_one_sigmas"].is_null());
  EXPECT_TRUE(answer["residuals"]["white"].is_null());
}

TEST(TmaCommand, PrintsSecondsOfAnEpochWhole) {
  const TemporaryFolder folder;
  std::istringstream in(log_until(1000.0));
  std::string log, row;
  std::getline(in, row);
  log = row + "\n";
  while (std::getline(in, row)) {
    const std::size_t comma = row.find(',');
    log += fmt::format("{:.0f}{}\n", 1.7e9 + std::stod(row.substr(0, comma)), row.substr(comma));
  }
  folder.write("log.csv", log);
  EXPECT_THAT(run(folder, "tma log.csv").out, AllOf(HasSubstr("from 1700000000 to 1700001000 s"),
                                                    HasSubstr("at 1700001000 s"), Not(HasSubstr("e+09"))));
}

TEST(TmaCommand, TakesFrequenciesThatAreNotPositiveForMissing) {
  const TemporaryFolder folder;
  std::string log = frequency_log(testing::jump(0.0));
  for (const std::size_t line : {5u, 25u, 45u}) log = with_cell(log, line, 2, line == 25u ? "-100" : "0");
  folder.write("log.csv", log);
  const json answer = json::parse(run(folder, "tma log.csv --json -").out);
  EXPECT_EQ(answer["source"]["missing"], 18);
  EXPECT_EQ(answer["source"]["outliers"], 0);
}

TEST(TmaCommand, OfBackBearingsSaysThatTheyMayBe) {
  const TemporaryFolder folder;
  std::istringstream in(log_until(1500.0));
  std::string log, row;
  std::getline(in, row);
  log = row + "\n";
  while (std::getline(in, row)) {
    const std::size_t begin = row.find(',') + 1, end = row.find(',', begin);
    if (end == begin) continue;
    log += fmt::format("{}{}{}\n", row.substr(0, begin), 180.0 + std::stod(row.substr(begin, end - begin)),
                       row.substr(end));
  }
  folder.write("log.csv", log);
  EXPECT_EQ(json::parse(run(folder, "tma log.csv --json -").out)["causes"][0]["kind"], "back_bearings");
}

TEST(TmaCommand, AdviceAfterAManoeuvreDeterminesTheRange) {
  const TemporaryFolder folder;
  folder.write("turn.toml", testing::kTurningTarget);
  ASSERT_EQ(run(folder, "simulate turn.toml -o logs").status, 0);
  const json answer = json::parse(run(folder, "tma logs/run_0000.csv --json -").out);
  EXPECT_NEAR(answer["manoeuvre"]["time_s"].get<double>(), 1015.0, 60.0);
  ASSERT_TRUE(answer["manoeuvre"]["range_determined"]);
  const json &with_change = answer["manoeuvre"]["estimate"], &truth = answer["truth"];
  EXPECT_NEAR(with_change["range_m"].get<double>(), truth["range_m"].get<double>(),
              0.2 * truth["range_m"].get<double>());
  EXPECT_NEAR(with_change["course_deg"].get<double>(), truth["course_deg"].get<double>(), 10.0);
  for (const json& stretch : answer["manoeuvre"]["stretches"]) {
    if (!stretch["range_determined"]) continue;
    const std::string cut = fmt::format("tma logs/run_0000.csv --from {} --to {} --json -",
                                        stretch["from_s"].get<double>(), stretch["to_s"].get<double>());
    const json again = json::parse(run(folder, cut).out);
    EXPECT_TRUE(again["range_determined"]);
    EXPECT_FALSE(again["manoeuvre"]["detected"]);
  }
}

TEST(TmaCommand, BadLogsAreOneLineErrors) {
  const TemporaryFolder folder;
  folder.write("range.csv", "time_s,range_m\n0,1\n1,2\n");
  folder.write("nowhere.csv", "time_s,bearing_deg,bearing_sigma_deg\n0,1,1\n1,2,1\n2,3,1\n3,3,1\n4,4,1\n");
  folder.write("vague.csv", "time_s,bearing_deg,sensor_east_m,sensor_north_m\n0,1,0,0\n1,2,0,1\n2,3,0,2\n");
  folder.write("short.csv",
               "time_s,bearing_deg,bearing_sigma_deg,sensor_east_m,sensor_north_m\n0,1,1,0,0\n1,2,1,0,1\n2,3,1,0,2\n");
  const std::vector<std::pair<std::string, std::string>> cases{{"range.csv", "bearing_deg"},
                                                               {"nowhere.csv", "sensor_east_m"},
                                                               {"vague.csv", "--sigma"},
                                                               {"short.csv", "3 usable bearings"},
                                                               {"absent.csv", "absent.csv"}};
  for (const auto& [log, word] : cases) {
    const Outcome outcome = run(folder, "tma " + log);
    EXPECT_EQ(outcome.status, 1) << log;
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(word));
    EXPECT_TRUE(outcome.out.empty());
  }
}

}  // namespace
}  // namespace truebearing::app_test::tma_test
