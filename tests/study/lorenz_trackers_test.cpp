// SPDX-License-Identifier: Apache-2.0
// Filters of the Lorenz attractor as a study makes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/recording/recording_csv.hpp"
#include "truebearing/simulation/lorenz_scenario.hpp"
#include "truebearing/study/tracker_registry.hpp"

namespace truebearing::lorenz_trackers_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

const std::string kMotion = "motion = { model = \"lorenz_rk4\", step_s = 0.02, sigma = 0.1 }\n";
const std::string kMeasurement = "measurement = { model = \"lorenz\", sigma = 0.5 }\n";
const std::string kStart = "start = { kind = \"prior\", x = [1, 1, 1], variance = [1, 1, 1] }\n";

std::unique_ptr<Tracker> make(const std::string& text, const std::string& kind = "kalman") {
  const SharedTable table = parse_toml(text, "study.toml");
  TableReader reader(table, "study.toml", "trackers.mine");
  return make_tracker(kind, reader);
}

// Moved as the filters of this test believe.
Recording run(std::uint64_t number, const Eigen::Matrix3d& rotation = Eigen::Matrix3d::Identity()) {
  LorenzParameters parameters;
  parameters.steps = 100;
  parameters.truth = LorenzMotion<LorenzRungeKutta>{{}, 0.02};
  parameters.process_sigma = 0.1;
  parameters.start.fill(Distribution(Distribution::Kind::normal, {1.0, 1.0}));
  parameters.sigma = 0.5;
  parameters.rotation = rotation;
  return LorenzScenario(parameters).simulate({4, Role::evaluation, number});
}

double last_nees(Tracker& tracker, const Recording& recording, double* mean = nullptr) {
  tracker.reset();
  double nees = 0.0;
  if (mean) *mean = 0.0;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const StepRecord& record = tracker.step(recording.measurements[k])[0];
    EXPECT_EQ(record.status, StepStatus::ok);
    nees = mahalanobis_squared(record.P, BoundedVector(recording.truth[0].x[k] - record.x));
    if (mean) *mean += nees / static_cast<double>(recording.measurements.size());
  }
  return nees;
}

TEST(LorenzTrackers, AreConsistentOnTheirOwnModel) {
  for (const char* kind : {"kalman", "unscented"}) {
    const auto tracker = make(kMotion + kMeasurement + kStart, kind);
    EXPECT_EQ(&tracker->space(), &lorenz_space());
    double sum = 0.0;
    constexpr int kRuns = 60;
    for (std::uint64_t i = 0; i < kRuns; ++i) sum += last_nees(*tracker, run(i));
    EXPECT_FALSE(testing::is_too_small(sum, 3 * kRuns)) << kind;
    EXPECT_FALSE(testing::is_too_large(sum, 3 * kRuns)) << kind;
  }
}

TEST(LorenzTrackers, ASensorThatIsTurnedHasToBeKnown) {
  const Recording turned = run(1, rotation_of({0.0, 0.0, 10.0}));
  const auto straight = make(kMotion + kMeasurement + kStart);
  const auto knows =
      make(kMotion + "measurement = { model = \"lorenz\", sigma = 0.5, rotation_deg = [0, 0, 10] }\n" + kStart);
  const auto has_matrix =
      make(kMotion +
           "measurement = { model = \"lorenz\", sigma = 0.5, matrix = [0.984807753012208, -0.17364817766693033, 0, "
           "0.17364817766693033, 0.984807753012208, 0, 0, 0, 1] }\n" +
           kStart);
  double of_straight = 0.0, of_knowing = 0.0;
  last_nees(*straight, turned, &of_straight);
  last_nees(*knows, turned, &of_knowing);
  EXPECT_GT(of_straight, 5.0 * of_knowing);
  EXPECT_NEAR(last_nees(*has_matrix, turned), last_nees(*knows, turned), 1e-9);
}

TEST(LorenzTrackers, MultipleModelsMixTheirMotions) {
  const std::string modes =
      "modes = [{ model = \"lorenz_rk4\", step_s = 0.02, sigma = 0.1 }, { model = \"lorenz_taylor\", terms = 2, step_s = "
      "0.02, sigma = 0.1 }]\ntransition = { leave_first = 0.01, leave_other = 0.01, period_s = 0.02 }\n";
  const auto imm = make(modes + kMeasurement + kStart, "imm");
  const Recording recording = run(2);
  for (const Measurement& measurement : recording.measurements) {
    const StepRecord& record = imm->step(measurement)[0];
    EXPECT_NEAR(record.mode_probabilities->sum(), 1.0, 1e-9);
  }
}

// Ahead by a period, what is published is the next step's prediction, and the filter is none the worse for it.
TEST(LorenzTrackers, AheadOfTimeIsTheNextPrediction) {
  const auto now = make(kMotion + kMeasurement + kStart),
             ahead = make(kMotion + kMeasurement + "ahead_s = 0.02\n" + kStart);
  const Recording recording = run(3);
  BoundedVector x, expected;
  BoundedMatrix P;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const StepRecord& of_now = now->step(recording.measurements[k])[0];
    if (k > 0) {
      EXPECT_LT((of_now.prediction->x - x).norm(), 1e-9 * x.norm());
      EXPECT_LT((of_now.prediction->P - P).norm(), 1e-9 * P.norm());
    }
    const StepRecord& of_ahead = ahead->step(recording.measurements[k])[0];
    EXPECT_EQ(of_ahead.innovation->nu, of_now.innovation->nu);
    x = of_ahead.x;
    P = of_ahead.P;
  }
}

// So far ahead that nothing is known there: the records say so, and the filter is none the worse for it.
TEST(LorenzTrackers, TooFarAheadFailsAndTheFilterGoesOn) {
  const auto now = make(kMotion + kMeasurement + kStart),
             ahead = make(kMotion + kMeasurement + "ahead_s = 1000\n" + kStart);
  for (const Measurement& measurement : run(3).measurements) {
    const StepRecord& of_now = now->step(measurement)[0];
    const auto records = ahead->step(measurement);
    ASSERT_EQ(records.size(), 1u);
    EXPECT_EQ(records[0].status, StepStatus::failed);
    EXPECT_EQ(records[0].track, of_now.track);
    EXPECT_EQ(records[0].innovation->nu, of_now.innovation->nu);
  }
}

TEST(LorenzTrackers, LogsAreReadAsTheyWereWritten) {
  const Recording recording = run(4);
  std::istringstream text(write_recording(recording));
  const Recording read = read_recording(text, "run.csv");
  EXPECT_EQ(read.measured, lorenz_space().components);
  EXPECT_EQ(read.truth_space, &lorenz_space());
  ASSERT_EQ(read.measurements.size(), recording.measurements.size());
  EXPECT_LT((read.measurements[7].z - recording.measurements[7].z).norm(), 1e-5);
  EXPECT_LT((read.truth[0].x[7] - recording.truth[0].x[7]).norm(), 1e-5);
}

TEST(LorenzTrackers, SayWhatIsWrong) {
  const auto refusal = [](const std::string& text, const std::string& kind = "kalman") {
    return error_message([&] { make(text, kind); });
  };
  EXPECT_THAT(refusal("motion = { model = \"constant_velocity\" }\n" + kMeasurement + kStart), HasSubstr("lorenz_rk4"));
  EXPECT_THAT(refusal(kMotion + "measurement = { model = \"position\", sigma_m = 1.0 }\n" + kStart),
              HasSubstr("motion.model"));
  EXPECT_THAT(refusal(kMotion + kMeasurement + "start = { kind = \"two_point\" }\n"), HasSubstr("start.kind"));
  EXPECT_THAT(
      refusal(kMotion + "measurement = { model = \"lorenz\", sigma = 1, rotation_deg = [0, 0, 1], matrix = [1] }\n" +
              kStart),
      HasSubstr("both of matrix and rotation_deg"));
  EXPECT_THAT(refusal(kMotion + kMeasurement + kStart + "ahead_s = -1\n"), HasSubstr("ahead_s"));
  EXPECT_THAT(
      refusal(kMotion + kMeasurement + kStart +
                  "prior_velocities_mps = [1]\nmeasurement_variance_factors = [1]\nprocess_noise_factors = [1]\n",
              "kalman_bank"),
      HasSubstr("kalman_bank"));
  EXPECT_THAT(refusal("modes = [{ model = \"learned\" }, { model = \"learned\" }]\ntransition = { leave_first = 0.1, "
                      "leave_other = 0.1, period_s = 1 }\n" +
                          kMeasurement + kStart,
                      "imm"),
              HasSubstr("only motion"));
}

}  // namespace
}  // namespace truebearing::lorenz_trackers_test
