// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/line_array_scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <filesystem>

#include "tests/support/array_scene.hpp"
#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"

namespace truebearing::line_array_scenario_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

const std::string kTime = "kind = \"line_array\"\nperiod_s = 2.0\nfirst_interval = -1\nintervals = 12\n";
const std::string kArray = "[array]\nsensors = 8\nsnapshots = 20\n";
const std::string kSignals = "[signals]\nsnr_db = 10.0\n";
const std::string kTwo = "[[targets]]\nstart_deg = 20.0\nrate_degps = -1.0\n[[targets]]\nstart_deg = -30.0\n";
const std::string kRandom = R"([random]
targets = 4
start_deg = { uniform = [-50.0, 50.0] }
least_separation_sine = 0.1
rate_degps = { uniform = [-1.5, 1.5] }
changes = { choice = [0, 1, 2] }
rate_change_degps = { uniform = [-2.0, 2.0] }
change_at_s = { uniform = [2.0, 10.0] }
change_width_s = { uniform = [1.0, 3.0] }
largest_deg = 55.0
)";

std::unique_ptr<Scenario> read(const std::string& text) {
  const SharedTable table = parse_toml(text, "array.toml");
  return read_scenario(TableReader(table, "array.toml"));
}

Recording run(const std::string& text, std::uint64_t number = 0) {
  return read(text)->simulate({1, Role::evaluation, number});
}

// Of all snapshots of all intervals.
Eigen::MatrixXcd covariance(const Recording& recording) {
  const int M = recording.measurements[0].snapshots->sensors;
  Eigen::MatrixXcd R = Eigen::MatrixXcd::Zero(M, M);
  double count = 0.0;
  for (const Measurement& measurement : recording.measurements)
    for (int t = 0; t < measurement.snapshots->snapshots(); ++t, count += 1.0) {
      const Eigen::VectorXcd x = Eigen::Map<const Eigen::VectorXcd>(measurement.snapshots->snapshot(t).data(), M);
      R += x * x.adjoint();
    }
  return R / count;
}

// 2 Ns [tr(R^-1 R_hat) - M - log det(R^-1 R_hat)] is chi-square with M^2 degrees of freedom where R is the truth.
bool fits(const Eigen::MatrixXcd& sample, const Eigen::MatrixXcd& R, double snapshots) {
  const double M = static_cast<double>(R.rows());
  const Eigen::MatrixXcd ratio = R.partialPivLu().solve(sample);
  const double statistic =
      2.0 * snapshots * (ratio.trace().real() - M - std::log(std::abs(ratio.partialPivLu().determinant())));
  return statistic > chi_square_quantile(0.5 * testing::kMissProbability, M * M) &&
         statistic < chi_square_quantile(1.0 - 0.5 * testing::kMissProbability, M * M);
}

TEST(LineArrayScenario, SaysWhatWasHeardAndWhere) {
  const Recording recording = run(kTime + kArray + kSignals + kTwo);
  EXPECT_EQ(recording.measured, std::vector<std::string>{"snapshots"});
  EXPECT_EQ(recording.truth_space, &angle_space());
  ASSERT_EQ(recording.measurements.size(), 12u);
  EXPECT_TRUE(recording.phases.empty());
  for (std::size_t k = 0; k < 12; ++k) {
    const Measurement& m = recording.measurements[k];
    EXPECT_EQ(m.time_s, 2.0 * (static_cast<double>(k) - 1.0));
    ASSERT_TRUE(m.snapshots);
    EXPECT_EQ(m.snapshots->sensors, 8);
    EXPECT_EQ(m.snapshots->snapshots(), 20);
    EXPECT_EQ(m.snapshots->spacing_wavelengths, 0.5);
    EXPECT_EQ(m.snapshots->interval_s, 2.0);
    EXPECT_EQ(m.z.size(), 0);
  }
  const std::string metres = "[array]\nsensors = 4\nsnapshots = 2\nspacing_m = 0.8\nfrequency_hz = 750.0\n";
  EXPECT_DOUBLE_EQ(run(kTime + metres + kSignals + kTwo).measurements[0].snapshots->spacing_wavelengths, 0.4);
  EXPECT_DOUBLE_EQ(
      run(kTime + metres + "sound_mps = 600.0\n" + kSignals + kTwo).measurements[0].snapshots->spacing_wavelengths,
      1.0);
}

TEST(LineArrayScenario, NumbersTracksInTheOrderOfTheirFirstAngles) {
  const Recording recording = run(kTime + kArray + kSignals + kTwo);
  ASSERT_EQ(recording.truth.size(), 2u);
  for (std::size_t k = 0; k < 12; ++k) {
    const double time_s = recording.measurements[k].time_s;
    EXPECT_NEAR(recording.truth[0].x[k][0], radians(-30.0), 1e-15);
    EXPECT_NEAR(recording.truth[1].x[k][0], radians(20.0 - time_s), 1e-15);
    EXPECT_EQ(recording.truth[0].x[k][1], 0.0);
    EXPECT_NEAR(recording.truth[1].x[k][1], radians(-1.0), 1e-15);
  }
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_EQ(recording.truth[n].track, static_cast<int>(n));
    EXPECT_DOUBLE_EQ(recording.truth[n].snr.value(), 10.0);
  }
}

TEST(LineArrayScenario, SameKeySameBits) {
  const std::unique_ptr<Scenario> scenario = read(kTime + kArray + "lost_share = 0.1\n" + kSignals + kRandom);
  const auto bits = [](const Recording& recording) {
    std::vector<std::uint64_t> all;
    for (const std::complex<double> value : *recording.snapshots) {
      all.push_back(std::bit_cast<std::uint64_t>(value.real()));
      all.push_back(std::bit_cast<std::uint64_t>(value.imag()));
    }
    for (const Truth& truth : recording.truth)
      for (const BoundedVector& x : truth.x) all.push_back(std::bit_cast<std::uint64_t>(x[0]));
    return all;
  };
  const std::vector<std::uint64_t> first = bits(scenario->simulate({1, Role::evaluation, 7}));
  EXPECT_EQ(first, bits(scenario->simulate({1, Role::evaluation, 7})));
  EXPECT_NE(first, bits(scenario->simulate({1, Role::evaluation, 8})));
  EXPECT_NE(first, bits(scenario->simulate({2, Role::evaluation, 7})));
  EXPECT_NE(first, bits(scenario->simulate({1, Role::training, 7})));
}

TEST(LineArrayScenario, PowersAndNoiseAreAsAsked) {
  const std::string text =
      "kind = \"line_array\"\nperiod_s = 1.0\nintervals = 20\n"
      "[array]\nsensors = 6\nsnapshots = 100\nnoise_power = 3.0\nspacing_wavelengths = 0.4\n"
      "[signals]\nsnr_db = 6.0\n"
      "[[targets]]\nstart_deg = -20.0\n[[targets]]\nstart_deg = 35.0\n";
  testing::ArrayScene scene = testing::scene_of({-20.0, 35.0}, 3.0 * std::pow(10.0, 0.6));
  scene.noise_power = 3.0;
  scene.sensors = 6;
  scene.spacing_wavelengths = 0.4;
  const Eigen::MatrixXcd sample = covariance(run(text));
  EXPECT_TRUE(fits(sample, scene.covariance(), 2000.0));
  EXPECT_FALSE(fits(sample, 1.2 * scene.covariance(), 2000.0));
  scene.angles_rad[0] = radians(-18.0);
  EXPECT_FALSE(fits(sample, scene.covariance(), 2000.0));
}

TEST(LineArrayScenario, SignalsAreAsCorrelatedAsAsked) {
  const std::string text =
      "kind = \"line_array\"\nperiod_s = 1.0\nintervals = 20\n"
      "[array]\nsensors = 6\nsnapshots = 100\n"
      "[signals]\nsnr_db = 10.0\ncorrelation = 0.7\n"
      "[[targets]]\nstart_deg = -20.0\n[[targets]]\nstart_deg = 35.0\n";
  testing::ArrayScene scene = testing::scene_of({-20.0, 35.0});
  scene.sensors = 6;
  const Eigen::MatrixXcd uncorrelated = scene.covariance();
  Eigen::MatrixXcd cross = testing::steering(scene.array(), scene.angles_rad[0]) *
                           testing::steering(scene.array(), scene.angles_rad[1]).adjoint();
  const Eigen::MatrixXcd R = uncorrelated + 0.7 * 10.0 * (cross + cross.adjoint());
  const Eigen::MatrixXcd sample = covariance(run(text));
  EXPECT_TRUE(fits(sample, R, 2000.0));
  EXPECT_FALSE(fits(sample, uncorrelated, 2000.0));
}

TEST(LineArrayScenario, SpreadsThePowersOfTargetsAndRuns) {
  const std::string signals =
      "[signals]\nsnr_db = { uniform = [0.0, 10.0] }\nsnr_spread_db = { choice = [-3.0, 3.0] }\n";
  bool differ_in_a_run = false;
  std::vector<double> first;
  for (std::uint64_t number = 0; number < 20; ++number) {
    const Recording recording = run(kTime + kArray + signals + kTwo, number);
    for (const Truth& truth : recording.truth) {
      const double snr_db = 10.0 * std::log10(truth.snr.value());
      EXPECT_GE(snr_db, -3.0);
      EXPECT_LE(snr_db, 13.0);
    }
    const double apart_db = 10.0 * std::log10(*recording.truth[0].snr / *recording.truth[1].snr);
    EXPECT_TRUE(std::abs(apart_db) < 1e-9 || std::abs(std::abs(apart_db) - 6.0) < 1e-9) << apart_db;
    differ_in_a_run |= std::abs(apart_db) > 1.0;
    first.push_back(*recording.truth[0].snr);
  }
  EXPECT_TRUE(differ_in_a_run);
  EXPECT_GT(testing::moments(first).variance, 1.0);
}

// Almost without noise every snapshot is a steering vector times a number; its phase step tells the angle.
TEST(LineArrayScenario, TargetsStandStillOrMoveInsideAnInterval) {
  for (const bool moving : {false, true}) {
    const Recording recording = run(kTime + "moving = " + (moving ? "true" : "false") +
                                    "\n[array]\nsensors = 8\nsnapshots = 20\n[signals]\nsnr_db = 200.0\n"
                                    "[[targets]]\nstart_deg = 20.0\nrate_degps = -1.0\n");
    for (std::size_t k = 0; k < 12; ++k)
      for (int t = 0; t < 20; ++t) {
        const auto x = recording.measurements[k].snapshots->snapshot(t);
        const double angle_deg = degrees(std::asin(std::arg(x[1] / x[0]) / kPi));
        const double back_s = moving ? (19.0 - t) / 20.0 * 2.0 : 0.0;
        EXPECT_NEAR(angle_deg, 20.0 - (recording.measurements[k].time_s - back_s), 1e-6) << k << ", " << t;
      }
  }
}

TEST(LineArrayScenario, DeadSensorsGiveZerosAndLostSnapshotsNaN) {
  const std::string lossy = "[array]\nsensors = 8\nsnapshots = 20\ndead_sensors = [2, 5]\nlost_share = 0.25\n";
  double lost = 0.0;
  const Recording recording = run(kTime + lossy + kSignals + kTwo);
  for (const Measurement& measurement : recording.measurements)
    for (int t = 0; t < 20; ++t) {
      const auto x = measurement.snapshots->snapshot(t);
      if (std::isnan(x[0].real())) {
        lost += 1.0;
        for (const std::complex<double> value : x) EXPECT_TRUE(std::isnan(value.real()) && std::isnan(value.imag()));
        continue;
      }
      for (std::size_t m = 0; m < 8; ++m) EXPECT_EQ(x[m] == 0.0, m == 2 || m == 5) << m;
    }
  EXPECT_NEAR(lost / 240.0, 0.25, testing::mean_margin(std::sqrt(0.25 * 0.75), 240));
  // What is not lost is what it would have been of the signals, whose draws are others than the losses'.
  EXPECT_EQ(run(kTime + lossy + kSignals + kTwo).truth[0].x, run(kTime + kArray + kSignals + kTwo).truth[0].x);
}

TEST(LineArrayScenario, TruthIsNoneBeforeATargetAppearsAndAfterItVanishes) {
  const std::string coming_and_going =
      "[[targets]]\nstart_deg = 20.0\nappears_s = 4.0\nvanishes_s = 10.0\n[[targets]]\nstart_deg = -30.0\n"
      "[phases]\ncrossing_deg = 5.0\nmanoeuvre_degps2 = 0.05\n";
  const Recording recording = run(kTime + kArray + "noise_power = 1.0\n" + kSignals + coming_and_going);
  const Eigen::VectorXcd a = testing::steering({8, 0.5}, radians(20.0));
  double power_there = 0.0, power_away = 0.0;
  for (std::size_t k = 0; k < 12; ++k) {
    const double time_s = recording.measurements[k].time_s;
    const bool is_there = time_s >= 4.0 && time_s < 10.0;
    EXPECT_EQ(recording.truth[1].x[k].array().isNaN().all(), !is_there) << time_s;
    EXPECT_EQ(recording.truth[1].x[k].array().isNaN().any(), !is_there) << time_s;
    EXPECT_EQ(recording.truth[1].phase[k], is_there ? 2 : -1) << time_s;
    EXPECT_EQ(recording.truth[0].phase[k], 2);
    EXPECT_NEAR(recording.truth[0].x[k][0], radians(-30.0), 1e-15);
    const int first = time_s == 4.0 || time_s == 10.0 ? 19 : 0;  // of intervals in which it comes or goes, the end
    for (int t = first; t < 20; ++t) {
      const Eigen::VectorXcd x =
          Eigen::Map<const Eigen::VectorXcd>(recording.measurements[k].snapshots->snapshot(t).data(), 8);
      double& power = is_there ? power_there : power_away;
      power = std::max(power, std::norm(a.dot(x)) / 64.0);
    }
  }
  EXPECT_GT(power_there, 20.0);
  EXPECT_LT(power_away, 10.0);
}

TEST(LineArrayScenario, PhasesTellCrossingsFromManoeuvres) {
  const std::string text =
      "kind = \"line_array\"\nperiod_s = 1.0\nintervals = 60\n" + kArray + kSignals +
      "[[targets]]\nstart_deg = -20.0\nrate_degps = 1.0\n[[targets]]\nstart_deg = 0.0\n"
      "[[targets]]\nstart_deg = 60.0\nbend = { height_deg = -5.0, centre_s = 50.0, width_s = 3.0 }\n"
      "[phases]\ncrossing_deg = 2.5\nmanoeuvre_degps2 = 0.05\n";
  const Recording recording = run(text);
  EXPECT_EQ(recording.phases, (std::vector<std::string>{"crossing", "manoeuvre", "quiet"}));
  for (std::size_t k = 0; k < 60; ++k) {
    const double time_s = recording.measurements[k].time_s;
    const int crossing = std::abs(time_s - 20.0) < 2.5 ? 0 : 2;
    EXPECT_EQ(recording.truth[0].phase[k], crossing) << time_s;
    EXPECT_EQ(recording.truth[1].phase[k], crossing) << time_s;
    EXPECT_NE(recording.truth[2].phase[k], 0);
  }
  EXPECT_EQ(recording.truth[2].phase[20], 2);
  EXPECT_EQ(recording.truth[2].phase[48], 1);
}

TEST(LineArrayScenario, RandomTargetsKeepToTheLimits) {
  const std::unique_ptr<Scenario> scenario = read(kTime + kArray + kSignals + kRandom);
  bool changes_rate = false, keeps_rate = false;
  for (std::uint64_t number = 0; number < 100; ++number) {
    const Recording recording = scenario->simulate({1, Role::evaluation, number});
    ASSERT_EQ(recording.truth.size(), 4u);
    for (std::size_t n = 0; n < 4; ++n) {
      const std::vector<BoundedVector>& x = recording.truth[n].x;
      EXPECT_EQ(recording.truth[n].track, static_cast<int>(n));
      EXPECT_LE(std::abs(x[0][0]), radians(50.0));
      if (n > 0) {
        EXPECT_GE(std::sin(x[0][0]) - std::sin(recording.truth[n - 1].x[0][0]), 0.1);
      }
      for (std::size_t k = 0; k < x.size(); ++k) {
        EXPECT_LE(std::abs(x[k][0]), radians(55.0));
        EXPECT_LE(std::abs(x[k][1]), radians(1.5 + 2.0 * 2.0));
        if (k > 0) {
          EXPECT_NEAR(x[k][0] - x[k - 1][0], 2.0 * x[k][1], 1e-12);
        }  // the summed rate
      }
      const double change = std::abs(x.back()[1] - x.front()[1]);
      changes_rate |= change > radians(0.5);
      keeps_rate |= change == 0.0;
    }
  }
  EXPECT_TRUE(changes_rate);
  EXPECT_TRUE(keeps_rate);
}

TEST(LineArrayScenario, RandomTargetsMayComeAndGo) {
  const std::unique_ptr<Scenario> scenario =
      read(kTime + kArray + kSignals + kRandom + "appears_s = { uniform = [-10.0, 10.0] }\nstays_s = 6.0\n");
  int absent = 0, present = 0;
  for (std::uint64_t number = 0; number < 20; ++number) {
    const Recording recording = scenario->simulate({1, Role::evaluation, number});
    for (const Truth& truth : recording.truth) {
      int stays = 0;
      for (const BoundedVector& x : truth.x) stays += !std::isnan(x[0]);
      EXPECT_LE(stays, 4);  // 6 s, and from the first interval on for those that were there before: at most 1 s more
      present += stays;
      absent += static_cast<int>(truth.x.size()) - stays;
    }
  }
  EXPECT_GT(present, 100);
  EXPECT_GT(absent, 100);
}

TEST(LineArrayScenario, ImpossibleDrawsAreClearErrors) {
  const auto refusal = [](const std::string& text) { return error_message([&] { run(text); }); };
  EXPECT_THAT(refusal(kTime + kArray + kSignals +
                      "[random]\ntargets = 30\nstart_deg = { uniform = [-10.0, 10.0] }\nleast_separation_sine = 0.1\n"),
              HasSubstr("random.least_separation_sine"));
  EXPECT_THAT(refusal(kTime + kArray + kSignals +
                      "[random]\ntargets = 1\nstart_deg = 0.0\nrate_degps = 10.0\nlargest_deg = 20.0\n"),
              HasSubstr("random.largest_deg"));
}

TEST(LineArrayScenario, MisspeltAndWrongKeysAreNamed) {
  const auto refusal = [](const std::string& text) { return error_message([&] { read(text); }); };
  const std::string good = kTime + kArray + kSignals + kTwo;
  EXPECT_EQ(refusal(good), "no error");
  EXPECT_THAT(refusal("intervalls = 3\n" + good), HasSubstr("intervals"));
  EXPECT_THAT(refusal(kTime + kArray + "dead_sensor = [1]\n" + kSignals + kTwo), HasSubstr("dead_sensors"));
  EXPECT_THAT(refusal(kTime + kArray + "dead_sensors = [8]\n" + kSignals + kTwo), HasSubstr("array.dead_sensors"));
  EXPECT_THAT(refusal(kTime + "[array]\nsensors = 1\nsnapshots = 20\n" + kSignals + kTwo), HasSubstr("array.sensors"));
  EXPECT_THAT(refusal(kTime + kArray + "spacing_m = 1.0\n" + kSignals + kTwo), HasSubstr("frequency_hz"));
  EXPECT_THAT(refusal(kTime + kArray + "lost_share = 1.5\n" + kSignals + kTwo), HasSubstr("lost_share"));
  EXPECT_THAT(refusal(kTime + kArray + kTwo), HasSubstr("signals"));
  EXPECT_THAT(refusal(kTime + kArray + "[signals]\nsnr_db = 1.0\ncorrelation = 1.0\n" + kTwo),
              HasSubstr("correlation"));
  EXPECT_THAT(refusal(kTime + kArray + kSignals), HasSubstr("targets"));
  EXPECT_THAT(refusal(good + "[random]\ntargets = 1\nstart_deg = 0.0\n"), HasSubstr("one of the two"));
  EXPECT_THAT(refusal(good + "appear_s = 4.0\n"), HasSubstr("appears_s"));
  EXPECT_THAT(refusal(kTime + kArray + kSignals + kRandom + "largest = 3.0\n"), HasSubstr("largest_deg"));
  EXPECT_THAT(refusal(kTime + kArray + kSignals + "[random]\ntargets = 40\nstart_deg = 0.0\n"), HasSubstr("targets"));
  EXPECT_THAT(refusal(kTime + kArray + kSignals + "[[targets]]\nstart_deg = 80.0\nrate_degps = 1.0\n"),
              HasSubstr("passes 90 deg"));
  EXPECT_THAT(refusal(good + "[phases]\ncrossing_deg = 1.0\n"), HasSubstr("manoeuvre_degps2"));
}

TEST(LineArrayScenario, TheOnesThatComeWithTheToolkitLoadAndRun) {
  int found = 0;
  for (const auto& entry : std::filesystem::directory_iterator(TRUEBEARING_SOURCE_DIR "/data/scenarios")) {
    if (entry.path().filename().string().rfind("array_", 0) != 0) continue;
    ++found;
    const Recording recording = load_scenario(entry.path())->simulate({1, Role::evaluation, 0});
    EXPECT_GE(recording.truth.size(), 5u) << entry.path();
    EXPECT_EQ(recording.measurements[0].snapshots->sensors, 15) << entry.path();
    EXPECT_EQ(recording.measurements[0].snapshots->spacing_wavelengths, 0.5) << entry.path();
  }
  EXPECT_GE(found, 10);
}

}  // namespace
}  // namespace truebearing::line_array_scenario_test
