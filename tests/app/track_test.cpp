// SPDX-License-Identifier: Apache-2.0
// `truebearing track` on logs of any length, on streams, and what it says to people.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sstream>
#include <sys/resource.h>

#include "tests/app/program_tests.hpp"
#include "tests/support/array_recording.hpp"
#include "truebearing/recording/snapshot_log.hpp"
#include "truebearing/tracker/step_log.hpp"

namespace truebearing::app_test::track_test {
namespace {

const std::string kLineStudy = R"(name = "line"
[scenario]
kind = "line"
period_s = 1.0
steps = 100
target = { position_m = 0.0, velocity_mps = 100.0 }
sensor = { position_sigma_m = 50.0 }
[trackers.plain]
kind = "kalman"
motion = { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 1.0 }
measurement = { model = "position", sigma_m = 50.0 }
start = { kind = "two_point" }
)";

const std::string kArrayStudy = R"(name = "two"
[scenario]
kind = "line_array"
period_s = 0.3
intervals = 10
array = { sensors = 3, spacing_m = 1.0, frequency_hz = 750.0, snapshots = 4 }
signals = { snr_db = 10.0 }
targets = [{ start_deg = 5.0, rate_degps = 1.0 }, { start_deg = -40.0, rate_degps = 0.0 }]
[trackers.joint]
kind = "joint_angles"
targets = 2
noise_power = 1.0
rate_sigma_degps = 2.0
motion = { q_deg2ps3 = 0.001, q_low_deg2ps3 = 0.001, q_high_deg2ps3 = 1.0, log_power_variance_per_s = 0.001 }
)";

// 100 m/s, with noise of about 50 m that repeats.
std::string row(int k, double from_s = 0.0) {
  constexpr std::array kNoise_m{31.0, -62.0, 12.0, 55.0, -41.0, -8.0, 70.0, -53.0, 3.0, -19.0, 44.0};
  return fmt::format("{},{}\n", from_s + k, 100.0 * k + kNoise_m[static_cast<std::size_t>(k) % kNoise_m.size()]);
}

std::string log_of(int rows, double from_s = 0.0) {
  std::string text = "time_s,position_m\n";
  for (int k = 1; k <= rows; ++k) text += row(k, from_s);
  return text;
}

// The most memory that it had, in kB.
long peak_kB(const TemporaryFolder& folder, const std::string& arguments) {
  const TemporaryFolder outputs;
  const pid_t child = start(folder, arguments, outputs.path());
  int status = 0;
  struct rusage used;
  ::wait4(child, &status, 0, &used);
  EXPECT_EQ(status, 0) << outputs.read("err.txt");
  return used.ru_maxrss;
}

TEST(Track, MemoryDoesNotGrowWithTheLog) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer keeps what was freed";
#endif
  const TemporaryFolder folder;
  folder.write("line.toml", kLineStudy);
  folder.write("short.csv", log_of(100));
  folder.write("long.csv", log_of(60000));
  constexpr long kSmall_kB = 8000;  // all records would be 240 MB
  for (const char* output : {"", " -o steps.csv"}) {
    const long least_kB = peak_kB(folder, std::string("track line.toml short.csv") + output);
    EXPECT_LT(peak_kB(folder, std::string("track line.toml long.csv") + output), least_kB + kSmall_kB) << output;
  }
  EXPECT_EQ(read_step_log(folder.path() / "steps.csv").records.size(), 59999u);
}

TEST(Track, AnswersARowOfAStreamAsItComes) {
  const TemporaryFolder folder;
  folder.write("line.toml", kLineStudy);
  const std::string log = (folder.path() / "log").string(), steps = (folder.path() / "steps").string();
  ASSERT_EQ(::mkfifo(log.c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo(steps.c_str(), 0600), 0);
  for (const char* arguments : {"track line.toml - -o - < log > steps", "track line.toml log -o steps"}) {
    const TemporaryFolder outputs;
    const pid_t child = start(folder, arguments, outputs.path());
    // Neither waits for the other end, which the program opens when it likes, or never where it gives up.
    std::FILE* to = std::fopen(log.c_str(), "r+");
    const int from = ::open(steps.c_str(), O_RDONLY | O_NONBLOCK);
    const auto answer = [&] {  // what comes within ten seconds
      struct pollfd waiting {
        from, POLLIN, 0
      };
      std::array<char, 4096> text;
      if (::poll(&waiting, 1, 10000) != 1) return std::string("nothing");
      return std::string(text.data(), static_cast<std::size_t>(std::max<ssize_t>(::read(from, text.data(), 4096), 0)));
    };
    std::fputs("time_s,position_m,truth_position_m\n1,100,100\n2,200,200\n", to);
    std::fflush(to);
    EXPECT_THAT(answer(), AllOf(HasSubstr("time_s,tracker"), HasSubstr("\n2,plain,0,ok,200,"))) << arguments;
    std::fputs("3,300,300\n", to);
    std::fflush(to);
    EXPECT_THAT(answer(), HasSubstr("3,plain,0,ok,300,")) << arguments;
    std::fclose(to);
    EXPECT_EQ(wait_for(child), 0) << outputs.read("err.txt");
    ::close(from);
  }
}

TEST(Track, SaysWhereTheTargetWasLast) {
  const TemporaryFolder folder;
  folder.write("line.toml", kLineStudy);
  folder.write("log.csv", log_of(50));
  const Outcome outcome = run(folder, "track line.toml log.csv");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("last estimate"), HasSubstr("position m"), HasSubstr("velocity m/s"),
                                 ::testing::ContainsRegex("plain +50 +(49|50)[0-9][0-9] \\+- ")));
}

TEST(Track, MarksWhatIsInconsistent) {
  const TemporaryFolder folder;
  folder.write("line.toml", kLineStudy);
  folder.write("sure.toml", replaced(kLineStudy, "sigma_m = 50.0 }\nstart", "sigma_m = 10.0 }\nstart"));
  folder.write("log.csv", log_of(200));
  EXPECT_THAT(run(folder, "track sure.toml log.csv").out, ::testing::ContainsRegex("\\([0-9.]+-[0-9.]+\\) \\*"));
}

TEST(Track, StuckSensorIsNotTakenForAnotherUnit) {
  const TemporaryFolder folder;
  folder.write("line.toml", kLineStudy);
  std::string stuck = "time_s,position_m\n", in_the_end = log_of(100);
  for (int k = 1; k <= 60; ++k) stuck += fmt::format("{},1234.5\n", k);
  for (int k = 101; k <= 400; ++k) in_the_end += fmt::format("{},1234.5\n", k);
  folder.write("stuck.csv", stuck);
  folder.write("end.csv", in_the_end);
  folder.write("unit.csv", "time_s,position_m\n1,0\n2,1e5\n3,7e5\n4,2e4\n5,9e6\n6,3e4\n");
  for (const char* log : {"stuck.csv", "end.csv"}) {
    const Outcome outcome = run(folder, std::string("track line.toml ") + log);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("stuck"), HasSubstr("smoothed"), HasSubstr("sigma too large"))) << log;
    EXPECT_THAT(outcome.out + outcome.err, AllOf(Not(HasSubstr("another unit")), Not(HasSubstr("nan")))) << log;
  }
  EXPECT_THAT(run(folder, "track line.toml unit.csv").err, HasSubstr("another unit"));
}

TEST(Track, ClockOfTheDayIsThatOfTheStudyFromTheFirstRowOn) {
  const TemporaryFolder folder;
  folder.write("line.toml",
               replaced(kLineStudy, "kind = \"two_point\"", "kind = \"prior\", x = [0.0, 0.0], variance = [1e4, 1e4]"));
  folder.write("log.csv", log_of(60));
  folder.write("late.csv", log_of(60, 1.7e9));
  folder.write("cut.csv", replaced(log_of(60), row(1), ""));
  ASSERT_EQ(run(folder, "track line.toml log.csv -o steps.csv").status, 0);
  const Outcome outcome = run(folder, "track line.toml late.csv -o late_steps.csv");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.err, HasSubstr("counted from 1700000000 s"));
  EXPECT_THAT(outcome.out, HasSubstr("1700000060"));
  EXPECT_EQ(run(folder, "track line.toml cut.csv").err, "") << "it begins within the study's times";
  const StepLog early = read_step_log(folder.path() / "steps.csv"),
                late = read_step_log(folder.path() / "late_steps.csv");
  ASSERT_EQ(early.records.size(), late.records.size());
  for (std::size_t k = 0; k < early.records.size(); ++k) {
    EXPECT_EQ(late.records[k].time_s, early.records[k].time_s + 1.7e9);
    EXPECT_EQ(late.records[k].x, early.records[k].x);
  }
}

// The study of a passive sonar on a log of its own with another clock: batches, events and scores are the same.
TEST(Track, BatchesAreSolvedInALogOfAnotherClock) {
  const TemporaryFolder folder;
  const std::string data = std::string(TRUEBEARING_SOURCE_DIR) + "/data/";
  ASSERT_EQ(run(folder, "simulate " + data + "scenarios/passive_sonar_b.toml -o logs").status, 0);
  std::istringstream rows(folder.read("logs/run_0000.csv"));
  std::string line, late;
  for (bool header = true; std::getline(rows, line); header = false) {
    const std::size_t comma = line.find(',');
    late += header ? line : fmt::format("{}{}", std::stod(line.substr(0, comma)) + 1.7e9, line.substr(comma));
    late += '\n';
  }
  folder.write("late.csv", late);
  const std::string track = "track " + data + "studies/passive_sonar_turn.toml ";
  const Outcome early = run(folder, track + "logs/run_0000.csv --json early.json --events early.csv");
  const Outcome shifted = run(folder, track + "late.csv --json late.json");
  EXPECT_EQ(shifted.status, 0) << shifted.err;
  EXPECT_THAT(early.out, HasSubstr("range_known"));
  EXPECT_THAT(shifted.out, AllOf(HasSubstr("range_known"), HasSubstr(" 170000"), Not(HasSubstr("1.7e+09"))));
  using nlohmann::json;
  const json of_early = json::parse(folder.read("early.json")), of_late = json::parse(folder.read("late.json"));
  EXPECT_EQ(of_late["trackers"]["imm"]["metrics"], of_early["trackers"]["imm"]["metrics"]);
  EXPECT_EQ(of_late["trackers"]["imm"]["series"]["time_s"][0].get<double>(),
            of_early["trackers"]["imm"]["series"]["time_s"][0].get<double>() + 1.7e9);
}

TEST(Track, SaysWhyNoTrackBegan) {
  const TemporaryFolder folder;
  folder.write("line.toml", kLineStudy);
  folder.write("one.csv", "time_s,position_m\n1,100\n2,\n");
  folder.write("none.csv", "time_s,position_m\n1,\n2,\n");
  EXPECT_THAT(run(folder, "track line.toml one.csv").out,
              HasSubstr("no track began: its start takes two measurements"));
  EXPECT_THAT(run(folder, "track line.toml none.csv").out,
              HasSubstr("no track began: the log has no usable measurement"));
  std::string bearings = "time_s,bearing_deg,bearing_sigma_deg,sensor_east_m,sensor_north_m\n";
  for (int k = 0; k < 30; ++k) bearings += fmt::format("{},{},1,{},0\n", 4 * k, 40.0 + k, 20 * k);
  folder.write("bearings.csv", bearings);
  const std::string studies = std::string(TRUEBEARING_SOURCE_DIR) + "/data/studies/";
  const Outcome family = run(folder, "track " + studies + "bearings_only_family.toml bearings.csv");
  EXPECT_EQ(family.status, 0) << family.err;
  EXPECT_THAT(family.out, AllOf(HasSubstr("nfnn: no track began"), HasSubstr("guess_range_m")));
  EXPECT_THAT(run(folder, "track " + studies + "bearings_only_observable.toml bearings.csv").out,
              HasSubstr("it waits until 1000 s, and the log ends at 116 s"));
}

TEST(Track, BoundThatALogCannotHaveIsLeftOut) {
  const TemporaryFolder folder;
  const std::string data = std::string(TRUEBEARING_SOURCE_DIR) + "/data/";
  ASSERT_EQ(run(folder, "simulate " + data + "scenarios/array_a_10db.toml -o logs").status, 0);
  const Outcome outcome = run(folder, "track " + data + "studies/array_a_10db.toml logs/run_0000.h5 -o steps.csv");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("the bound is left out"), Not(HasSubstr("another unit"))));
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("angle deg"), HasSubstr("clean mse")));
  EXPECT_GT(read_step_log(folder.path() / "steps.csv", "joint").records.size(), 300u);
}

TEST(Track, SaysWhatAnArrayCannotTell) {
  const TemporaryFolder folder;
  const std::string data = std::string(TRUEBEARING_SOURCE_DIR) + "/data/studies/";
  write_snapshot_log(folder.path() / "three.h5", testing::array_recording());
  for (const char* command : {"track ", "compare --quiet --runs 1 --truth three.h5 "}) {
    const Outcome few = run(folder, command + data + "array_a_10db.toml" + (command[0] == 't' ? " three.h5" : ""));
    EXPECT_EQ(few.status, 1);
    EXPECT_TRUE(is_one_line(few.err)) << few.err;
    EXPECT_THAT(few.err, AllOf(HasSubstr("trackers."), HasSubstr("takes an array of"), HasSubstr("three.h5 has 3")));
  }
  Recording wide = testing::array_recording();
  for (Measurement& measurement : wide.measurements) measurement.snapshots->spacing_wavelengths = 2.0;
  write_snapshot_log(folder.path() / "wide.h5", wide);
  folder.write("two.toml", kArrayStudy);
  const Outcome far_apart = run(folder, "track two.toml wide.h5"), near = run(folder, "track two.toml three.h5");
  EXPECT_EQ(far_apart.status, 0) << far_apart.err;
  EXPECT_THAT(far_apart.err, AllOf(HasSubstr("wide.h5"), HasSubstr("2 wavelengths apart, more than half of one")));
  EXPECT_THAT(near.err, Not(HasSubstr("wavelengths")));
  EXPECT_THAT(run(folder, "compare two.toml --quiet --runs 1 --truth wide.h5").out, HasSubstr("more than half of one"));
}

TEST(Track, CorrectedTrackerIsNotShownAsIdle) {
  const TemporaryFolder folder;
  const std::string data = std::string(TRUEBEARING_SOURCE_DIR) + "/data/";
  ASSERT_EQ(run(folder, "simulate " + data + "scenarios/manoeuvre_2d.toml -o logs").status, 0);
  const Outcome outcome = run(folder, "track " + data + "studies/manoeuvre_2d.toml logs/run_0000.csv");
  EXPECT_THAT(outcome.out, AllOf(::testing::ContainsRegex("\nnfnn +119 +- "), HasSubstr("as corrections")));
}

const std::string kTwoSensors = R"(name = "two sensors"
[scenario]
kind = "planar_flight"
period_s = 1.0
steps = 20
flight = { speed_mps = 100.0, leg_s = 1e5, turn_s = 1.0, turn_rate_degps = 0.0, roll_in_s = 0.0 }
site = { range_m = 5000.0 }
sensors = { plots = { output = "plane", position_sigma_m = 10.0, period_s = 2.0 }, radar = { output = "range_bearing", range_sigma_m = 20.0, bearing_sigma_deg = 1.0, period_s = 2.0 } }
[sensors.radar]
model = "range_bearing"
range_sigma_m = 20.0
bearing_sigma_deg = 1.0
[sensors.plots]
model = "position"
sigma_m = 10.0
[trackers.both]
kind = "kalman"
space = "plane"
motion = { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 1.0 }
measurement = { model = "sensors" }
start = { kind = "one_point", velocity_sigma_mps = 200.0 }
)";

TEST(Track, SeveralSensorsWriteOneLog) {
  const TemporaryFolder folder;
  folder.write("two.toml", kTwoSensors);
  folder.write("log.csv",
               "time_s,east_m,north_m,range_m,bearing_deg\n0,3000,4000,,\n1,,,5060,37\n2,3010,4200,,\n3,,,5270,35.5\n");
  const Outcome outcome = run(folder, "track two.toml log.csv -o steps.csv");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("  by plots "), HasSubstr("  by radar "), HasSubstr("4 measurements, 0 missing")));
  const StepLog steps = read_step_log(folder.path() / "steps.csv", "both");
  EXPECT_EQ(steps.records.front().source, 0);
  EXPECT_EQ(steps.records.back().source, 1);
  folder.write("bad.csv", "time_s,east_m,north_m,range_m,bearing_deg\n0,3000,4000,5000,\n");
  EXPECT_THAT(run(folder, "track two.toml bad.csv").err, HasSubstr("a row for each sensor"));
}

// Measurements of a target at 100 m/s with and without its truth: what is foretold stands in the JSON and on the page.
TEST(Track, WhoForetellsBestIsInTheResultsAndOnThePage) {
  const TemporaryFolder folder;
  folder.write("line.toml", kLineStudy +
                                "[trackers.loose]\nlike = \"plain\"\n"
                                "motion = { sigma_a_mps2 = 500.0 }\n");
  std::string log = "time_s,position_m\n", with_truth = "time_s,position_m,truth_position_m,truth_velocity_mps\n";
  for (int k = 0; k < 100; ++k) {
    const double noise_m = 60.0 * std::sin(12.9898 * k) + 40.0 * std::sin(78.233 * k + 1.0);
    log += fmt::format("{},{}\n", k, 100.0 * k + noise_m);
    with_truth += fmt::format("{},{},{},100\n", k, 100.0 * k + noise_m, 100.0 * k);
  }
  folder.write("log.csv", log);
  folder.write("truth.csv", with_truth);
  for (const char* name : {"log", "truth"}) {
    const Outcome outcome =
        run(folder, fmt::format("track line.toml {0}.csv --foretell 2 --json {0}.json --report {0}.html", name));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const nlohmann::json told = nlohmann::json::parse(folder.read(std::string(name) + ".json"))["foretelling"][0];
    EXPECT_EQ(told["best"], "plain");
    EXPECT_EQ(told["steps"], 2);
    EXPECT_EQ(told["quantity"], "position_m");
    EXPECT_LT(told["trackers"]["plain"]["rmse"], told["trackers"]["loose"]["rmse"]);
    EXPECT_GT(told["trackers"]["loose"]["squared_above_best"],
              3.0 * told["trackers"]["loose"]["squared_above_best_se"].get<double>());
    EXPECT_EQ(told["trackers"]["plain"]["squared_above_best"], 0.0);
    EXPECT_THAT(outcome.out, HasSubstr(told["says"].get<std::string>()));
    EXPECT_THAT(folder.read(std::string(name) + ".html"),
                AllOf(HasSubstr("Who foretells best"), HasSubstr(told["says"].get<std::string>())));
  }
  folder.write("short.csv", "time_s,position_m\n0,0\n1,100\n2,200\n3,300\n");
  const Outcome few = run(folder, "track line.toml short.csv --foretell 2 --json short.json");
  EXPECT_EQ(few.status, 0);
  EXPECT_THAT(few.err, AllOf(HasSubstr("short.csv: --foretell: the log: has"), HasSubstr("or more")));
  EXPECT_THAT(folder.read("short.json"), Not(HasSubstr("foretelling"))) << "and all else stands";
  ASSERT_EQ(run(folder, "track line.toml log.csv --json without.json").status, 0);
  EXPECT_THAT(folder.read("without.json"), Not(HasSubstr("foretelling")));
}

TEST(Track, LateRowsAreTakenWhereTheyBelong) {
  const TemporaryFolder folder;
  folder.write("line.toml", kLineStudy);
  const std::string header = "time_s,position_m\n";
  folder.write("sorted.csv", header + row(1) + row(2) + row(3) + row(4) + row(5) + row(6));
  folder.write("late.csv", header + row(1) + row(2) + row(4) + row(5) + row(3) + row(6));
  EXPECT_THAT(run(folder, "track line.toml late.csv").err, HasSubstr("--sort-window"));
  const Outcome sorted = run(folder, "track line.toml sorted.csv -o sorted_steps.csv"),
                late = run(folder, "track line.toml late.csv --late 3 -o late_steps.csv");
  EXPECT_EQ(late.status, 0) << late.err;
  EXPECT_THAT(late.err, HasSubstr("1 late rows put where they belong, 4 steps run again for them, 0 rows too late"));
  const auto last_line = [&](const std::string& name) {
    const std::string text = folder.read(name);
    return text.substr(text.rfind('\n', text.size() - 2) + 1);
  };
  EXPECT_THAT(folder.read("late_steps.csv"), HasSubstr(",revised,"));
  // Read back, the last revision of each time counts.
  const StepLog read_late = read_step_log(folder.path() / "late_steps.csv"),
                read_sorted = read_step_log(folder.path() / "sorted_steps.csv");
  ASSERT_EQ(read_late.records.size(), read_sorted.records.size());
  for (std::size_t k = 0; k < read_sorted.records.size(); ++k) {
    EXPECT_EQ(read_late.records[k].time_s, read_sorted.records[k].time_s);
    EXPECT_EQ(read_late.records[k].x, read_sorted.records[k].x);
  }
  EXPECT_EQ(replaced(last_line("late_steps.csv"), "6,plain,0,ok,0,", "6,plain,0,ok,"), last_line("sorted_steps.csv"));
  const Outcome too_late = run(folder, "track line.toml late.csv --late 1");
  EXPECT_THAT(too_late.err,
              HasSubstr("0 late rows put where they belong, 0 steps run again for them, 1 rows too late"));
}

}  // namespace
}  // namespace truebearing::app_test::track_test
