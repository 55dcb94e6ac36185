#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/app/program.hpp"
#include "tests/support/bearing_frequency_runs.hpp"
#include "tests/support/bearing_runs.hpp"
#include "truebearing/recording/recording_csv.hpp"

namespace truebearing::tma_test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::is_one_line;
using ::testing::Not;
using testing::Outcome;
using testing::run;
using testing::TemporaryFolder;

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
}  // namespace truebearing::tma_test
