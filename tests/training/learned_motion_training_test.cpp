// SPDX-License-Identifier: Apache-2.0
// Learned motion from a study to a file and back into a filter, on a small Lorenz study.
#include "training/learned_motion_training.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/error_message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/correction/learned_motion_file.hpp"

namespace truebearing::learned_motion_training_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

const std::string kText = R"(name = "small"
runs = 4
[scenario]
kind = "lorenz"
period_s = 0.02
steps = 200
truth = { model = "lorenz_rk4", step_s = 0.01 }
start = { x = { normal = [1, 1] }, y = { normal = [1, 1] }, z = { normal = [1, 1] } }
sensor = { sigma = 1.0 }
[trackers.learned]
kind = "kalman"
measurement = { model = "lorenz", sigma = 1.0 }
start = { kind = "prior", x = [1.0, 1.0, 1.0], variance = [1.0, 1.0, 1.0] }
[trackers.learned.motion]
model = "learned"
file = "learned.json"
around = { model = "lorenz_taylor", terms = 5, step_s = 0.02, sigma = 0.15 }
training = { rules = 30, runs = 10, iterations = 40 }
[trackers.ekf]
kind = "kalman"
motion = { model = "lorenz_taylor", terms = 5, step_s = 0.02, sigma = 0.15 }
measurement = { model = "lorenz", sigma = 1.0 }
start = { kind = "prior", x = [1.0, 1.0, 1.0], variance = [1.0, 1.0, 1.0] }
)";

Study write(const TemporaryFolder& folder, const std::string& text = kText) {
  return Study::load(folder.write("small.toml", text));
}

std::string replaced(const std::string& from, const std::string& to) {
  return std::string(kText).replace(kText.find(from), from.size(), to);
}

TEST(LearnedMotionTraining, TakesAwayMostOfWhatAPredictionMisses) {
  const TemporaryFolder folder;
  const Study study = write(folder);
  EXPECT_THAT(error_message([&] { study.make_tracker("learned"); }),
              AllOf(HasSubstr("learned.json"), HasSubstr("truebearing train")));
  LearnedMotionReport report;
  const MotionResidual residual = train_learned_motion(study, "learned", {.seed = 1}, &report);
  EXPECT_EQ(report.rows, 10 * 199);
  EXPECT_NEAR(residual.period_s, 0.02, 1e-12);
  EXPECT_LT(report.remaining, 0.4);

  folder.write("learned.json", learned_motion_text(residual));
  const Comparison comparison =
      compare(study.make_tracker_set(), study.evaluation_scenarios(), study.comparison_options());
  EXPECT_LT(comparison.tracker("learned")->quantities[0].rmse, 0.8 * comparison.tracker("ekf")->quantities[0].rmse);
}

TEST(LearnedMotionTraining, SameSeedIsTheSameMotionOnAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const Study study = write(folder, replaced("iterations = 40", "iterations = 3"));
  const auto text = [&](std::uint64_t seed, int threads) {
    return learned_motion_text(train_learned_motion(study, "learned", {.seed = seed, .threads = threads}));
  };
  EXPECT_EQ(text(1, 1), text(1, 4));
  EXPECT_NE(text(1, 1), text(2, 1));
}

TEST(LearnedMotionTraining, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_message([&] { write(folder, replaced("rules = 30", "rules = 0")); }),
              HasSubstr("trackers.learned.motion.training.rules"));
  EXPECT_THAT(error_message([&] { write(folder, replaced("file = \"learned.json\"\n", "")); }), HasSubstr("file"));
  const Study study = write(folder);
  folder.write("learned.json", "{}");
  EXPECT_THAT(error_message([&] { study.make_tracker("learned"); }), HasSubstr("format"));
}

}  // namespace
}  // namespace truebearing::learned_motion_training_test
