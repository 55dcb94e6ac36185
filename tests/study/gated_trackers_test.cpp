// SPDX-License-Identifier: Apache-2.0
// What a gate promises of trackers as a study makes them: one that was shown something wrong is soon as good as one that
// was not, and measurements that are far off cost little.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/temporary_folder.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing::gated_trackers_test {
namespace {

constexpr std::size_t kRuns = 40;
constexpr const char* kTrackers = R"(
[trackers.kf]
kind = "kalman"
space = "plane"
motion = { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 20.0 }
measurement = { model = "position", sigma_m = 100.0 }
start = { kind = "two_point" }

[trackers.kf_gate]
like = "kf"
gate_probability = 0.9999

[trackers.imm]
like = "kf"
kind = "imm"
modes = [
  { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 2.0 },
  { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 40.0 },
]
transition = { leave_first = 0.05, leave_other = 0.1, period_s = 1.0 }

[trackers.imm_gate]
like = "imm"
gate_probability = 0.9999
)";

Study study_of(const std::string& scenario) {
  const testing::TemporaryFolder folder;
  return Study::load(folder.write("gated.toml", "name = \"gated\"\nscenario = \"" TRUEBEARING_SOURCE_DIR
                                                "/data/scenarios/" +
                                                    scenario + "\"\n" + kTrackers));
}

std::vector<Recording> runs_of(const Study& study) {
  std::vector<Recording> runs;
  for (std::size_t run = 0; run < kRuns; ++run) runs.push_back(study.scenario().simulate({.seed = 1, .run = run}));
  return runs;
}

// Of the position, over the runs and the steps from `from_step` on.
double rmse_m(const Study& study, const std::string& name, const std::vector<Recording>& runs, std::size_t from_step) {
  const std::unique_ptr<Tracker> tracker = study.make_tracker(name);
  double squared = 0.0;
  std::size_t steps = 0;
  for (const Recording& run : runs) {
    tracker->reset();
    for (std::size_t k = 0; k < run.measurements.size(); ++k) {
      const auto records = tracker->step(run.measurements[k]);
      if (k < from_step) continue;
      if (records.empty()) return std::nan("");
      squared += (records[0].x - run.truth[0].x[k]).head<2>().squaredNorm();
      ++steps;
    }
  }
  return std::sqrt(squared / static_cast<double>(steps));
}

// In a direction of each run's own.
Eigen::Vector2d away(double distance_m, std::size_t run) {
  const double angle_rad = 2.0 * std::numbers::pi * 0.618 * static_cast<double>(run);
  return distance_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
}

constexpr std::size_t kPlotsToFindBack = 10;
constexpr double kAsGood = 1.05;

TEST(GatedTrackers, TenPlotsAfterAWrongFirstOneAreAsGoodAsWithoutIt) {
  const Study study = study_of("manoeuvre_2d.toml");
  const std::vector<Recording> clean = runs_of(study);
  for (const char* name : {"kf_gate", "imm_gate"}) {
    const double expected_m = rmse_m(study, name, clean, kPlotsToFindBack + 1);
    for (const double off_m : {5e3, 1e4, 2e4, 5e4}) {
      std::vector<Recording> wrong = clean;
      for (std::size_t run = 0; run < kRuns; ++run) wrong[run].measurements[0].z += away(off_m, run);
      EXPECT_LE(rmse_m(study, name, wrong, kPlotsToFindBack + 1), kAsGood * expected_m) << name << ", " << off_m;
    }
  }
}

TEST(GatedTrackers, TenPlotsAfterAJumpOfTheSensorAreAsGoodAsWithoutIt) {
  constexpr std::size_t kJump = 60;
  const Study study = study_of("manoeuvre_2d.toml");
  const std::vector<Recording> clean = runs_of(study);
  std::vector<Recording> jumped = clean;
  for (std::size_t run = 0; run < kRuns; ++run)
    for (std::size_t k = kJump; k < jumped[run].measurements.size(); ++k) {
      jumped[run].measurements[k].z += away(1e4, run);
      jumped[run].truth[0].x[k].head<2>() += away(1e4, run);
    }
  for (const char* name : {"kf_gate", "imm_gate"}) {
    const double expected_m = rmse_m(study, name, clean, kJump + kPlotsToFindBack);
    EXPECT_LE(rmse_m(study, name, jumped, kJump + kPlotsToFindBack), kAsGood * expected_m) << name;
    EXPECT_GT(rmse_m(study, name, jumped, kJump), 2.0 * rmse_m(study, name, clean, kJump)) << "there was one to find";
  }
}

// 3 % of the plots have ten times the standard deviation.
TEST(GatedTrackers, OutliersCostMuchLess) {
  const Study study = study_of("manoeuvre_2d_outliers.toml");
  const std::vector<Recording> runs = runs_of(study);
  for (const std::string name : {"kf", "imm"})
    EXPECT_LE(rmse_m(study, name + "_gate", runs, 8), 0.65 * rmse_m(study, name, runs, 8)) << name;
}

}  // namespace
}  // namespace truebearing::gated_trackers_test
