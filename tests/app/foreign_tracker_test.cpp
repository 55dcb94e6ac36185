// SPDX-License-Identifier: Apache-2.0
// A tracker that is not ours, OpenCV's Kalman filter, is corrected from its step logs alone: train, track and compare,
// as its owner would. Its targets are those of manoeuvre_2d.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/video/tracking.hpp>
#include <string>
#include <vector>

#include "app/command_line.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/io/csv.hpp"
#include "truebearing/simulation/scenario.hpp"
#include "truebearing/tracker/step_log.hpp"

namespace truebearing::foreign_tracker_test {
namespace {

using nlohmann::json;
using testing::TemporaryFolder;

constexpr double kSigma_m = 100.0;
constexpr double kSigmaA_mps2 = 8.0;
constexpr double kFirstSpeedSigma_mps = 300.0;

// The foreign program: constant velocity, T = 1 s, and a CSV writer of its own.
class ForeignTracker {
 public:
  ForeignTracker() : filter_(4, 2, 0, CV_64F) {
    const double T = 1.0, q = kSigmaA_mps2 * kSigmaA_mps2;
    filter_.transitionMatrix = (cv::Mat_<double>(4, 4) << 1, 0, T, 0, 0, 1, 0, T, 0, 0, 1, 0, 0, 0, 0, 1);
    filter_.measurementMatrix = (cv::Mat_<double>(2, 4) << 1, 0, 0, 0, 0, 1, 0, 0);
    const double pp = q * T * T * T * T / 4, pv = q * T * T * T / 2, vv = q * T * T;
    filter_.processNoiseCov = (cv::Mat_<double>(4, 4) << pp, 0, pv, 0, 0, pp, 0, pv, pv, 0, vv, 0, 0, pv, 0, vv);
    filter_.measurementNoiseCov = kSigma_m * kSigma_m * cv::Mat::eye(2, 2, CV_64F);
  }

  std::string log(const Recording& recording, bool truth) {
    std::vector<std::string> header{"time_s", "track"};
    for (const std::string& component : plane_space().components) header.push_back("x_" + component);
    for (int i = 1; i <= 4; ++i)
      for (int j = i; j <= 4; ++j) header.push_back(fmt::format("P_{}_{}", i, j));
    for (const char* name : {"z_1", "z_2", "nu_1", "nu_2", "S_1_1", "S_1_2", "S_2_2"}) header.emplace_back(name);
    if (truth)
      for (const std::string& component : plane_space().components) header.push_back("truth_" + component);

    CsvWriter csv(header);
    for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
      const Measurement& measurement = recording.measurements[k];
      const cv::Mat z = (cv::Mat_<double>(2, 1) << measurement.z[0], measurement.z[1]);
      cv::Mat nu = cv::Mat::zeros(2, 1, CV_64F), S;
      if (k == 0) {
        begin(measurement.z[0], measurement.z[1]);
        S = filter_.measurementNoiseCov * 2.0;
      } else {
        filter_.predict();
        nu = z - filter_.measurementMatrix * filter_.statePre;
        S = filter_.measurementMatrix * filter_.errorCovPre * filter_.measurementMatrix.t() +
            filter_.measurementNoiseCov;
        filter_.correct(z);
      }
      csv.number(measurement.time_s);
      csv.number(17);
      for (int i = 0; i < 4; ++i) csv.number(filter_.statePost.at<double>(i));
      for (int i = 0; i < 4; ++i)
        for (int j = i; j < 4; ++j)
          csv.number(0.5 * (filter_.errorCovPost.at<double>(i, j) + filter_.errorCovPost.at<double>(j, i)));
      for (int i = 0; i < 2; ++i) csv.number(z.at<double>(i));
      for (int i = 0; i < 2; ++i) csv.number(nu.at<double>(i));
      csv.number(S.at<double>(0, 0));
      csv.number(S.at<double>(0, 1));
      csv.number(S.at<double>(1, 1));
      if (truth)
        for (const double value : recording.truth[0].x[k]) csv.number(value);
      csv.end_row();
    }
    return csv.str();
  }

 private:
  void begin(double east_m, double north_m) {
    const double v = kFirstSpeedSigma_mps * kFirstSpeedSigma_mps, p = kSigma_m * kSigma_m;
    filter_.statePost = (cv::Mat_<double>(4, 1) << east_m, north_m, 0, 0);
    filter_.errorCovPost = (cv::Mat_<double>(4, 4) << p, 0, 0, 0, 0, p, 0, 0, 0, 0, v, 0, 0, 0, 0, v);
  }

  cv::KalmanFilter filter_;
};

const std::string kStudy = R"(name = "foreign"
runs = 40

[scenario]
kind = "step_logs"
training = ["training/run_*.csv"]
evaluation = ["evaluation/run_*.csv"]

[scoring]
from_step = 8
pairs = ["corrected - foreign"]

[trackers.foreign]
kind = "recorded"
components = ["east_m", "north_m", "east_mps", "north_mps"]
innovation = true

[trackers.corrected]
kind = "corrected"
base = "foreign"
kappa = 3.0
frame = "track"
covariance = "moments"
model = "foreign.nfnn.json"
features = [
  { kind = "innovation", component = "along_m" },
  { kind = "innovation", component = "cross_m" },
  { kind = "innovation_average", component = "along_m", alpha = 0.5 },
  { kind = "innovation_average", component = "cross_m", alpha = 0.5 },
  { kind = "innovation_average", component = "along_m", alpha = 0.2 },
  { kind = "innovation_average", component = "cross_m", alpha = 0.2 },
  { kind = "innovation_average", component = "along_m", alpha = 0.08 },
  { kind = "innovation_average", component = "cross_m", alpha = 0.08 },
]

[trackers.corrected.training]
rules = 32
runs = 60
from_step = 8
iterations = 60
mirror = "pairs"
)";

void write_logs(const TemporaryFolder& folder, const std::string& name, Role role, std::uint64_t count, bool truth) {
  const auto targets = load_scenario(TRUEBEARING_SOURCE_DIR "/data/scenarios/manoeuvre_2d.toml");
  for (std::uint64_t run = 0; run < count; ++run)
    folder.write(fmt::format("{}/run_{:02}.csv", name, run),
                 ForeignTracker().log(targets->simulate({21, role, run}), truth));
}

int run_program(std::vector<std::string> arguments) {
  std::vector<const char*> argv{"truebearing"};
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  return command_line(static_cast<int>(argv.size()), argv.data());
}

TEST(ForeignTracker, IsCorrectedFromItsLogsAlone) {
  const TemporaryFolder folder;
  write_logs(folder, "training", Role::training, 60, true);
  write_logs(folder, "evaluation", Role::evaluation, 40, true);
  write_logs(folder, "new", Role::validation, 1, false);
  const std::string study = folder.write("study.toml", kStudy).string();
  const std::string model = (folder.path() / "foreign.nfnn.json").string();
  ASSERT_EQ(run_program({"train", study, "--quiet", "-o", model}), 0);

  // A new log, without truth: the foreign estimates come out as they went in, the corrected ones beside them.
  const std::string log = (folder.path() / "new/run_00.csv").string(), steps = (folder.path() / "steps.csv").string();
  ASSERT_EQ(run_program({"track", study, log, "-o", steps}), 0);
  const StepLog foreign = read_step_log(log), replayed = read_step_log(steps, "foreign"),
                corrected = read_step_log(steps, "corrected");
  ASSERT_EQ(replayed.records.size(), foreign.records.size());
  ASSERT_EQ(corrected.records.size(), foreign.records.size());
  int changed = 0;
  for (std::size_t k = 0; k < foreign.records.size(); ++k) {
    EXPECT_EQ(replayed.records[k].x, foreign.records[k].x);
    EXPECT_EQ(replayed.records[k].P, foreign.records[k].P);
    EXPECT_EQ(replayed.records[k].innovation->nu, foreign.records[k].innovation->nu);
    EXPECT_EQ(corrected.records[k].track, 17);
    changed += corrected.records[k].x != foreign.records[k].x;
  }
  EXPECT_GT(changed, 100) << "of 120";

  // New logs with truth: better by more than two standard errors of the paired difference, in both.
  const std::string report = (folder.path() / "report.json").string();
  ASSERT_EQ(run_program({"compare", study, "--quiet", "--json", report}), 0);
  const json paired = json::parse(folder.read("report.json"))["paired"]["corrected - foreign"];
  for (const char* quantity : {"position_m", "velocity_mps"}) {
    const double mean = paired[quantity]["mean"], se = paired[quantity]["se"];
    EXPECT_LT(mean + 2.0 * se, 0.0) << quantity;
  }
}

}  // namespace
}  // namespace truebearing::foreign_tracker_test
