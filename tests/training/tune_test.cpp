// SPDX-License-Identifier: Apache-2.0
#include "training/tune.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/error_message.hpp"
#include "tests/support/radar_study.hpp"
#include "tests/support/statistics.hpp"
#include "tests/support/thread_ranks.hpp"
#include "truebearing/simulation/lorenz_scenario.hpp"

namespace truebearing::tune_test {
namespace {

using testing::at_ranks;
using ::testing::Each;
using testing::error_message;
using ::testing::HasSubstr;
using testing::kParameters;
using testing::kStudy;
using testing::replaced;
using testing::TemporaryFolder;

// A family whose R and Q are what they are, seen by a filter that believes other ones.
const std::string kKnown = R"(kind = "line"
period_s = 1.0
steps = 150
process_noise_variance = [100.0, 2500.0]

[target]
position_m = 0.0
velocity_mps = 0.0

[sensor]
position_variance_m2 = 1e4
)";

const std::string kTune = R"(name = "known"
scenario = "known.toml"

[scoring]
from_step = 30

[tuning]
runs = 60

[trackers.filter]
kind = "kalman"
motion = { model = "constant_velocity", noise = "fixed", variance = [300.0, 250.0], period_s = 1.0 }
measurement = { model = "position", variance_m2 = 2e3 }
start = { kind = "prior", x = [0.0, 0.0], variance = [1.0, 1.0] }
tune = ["motion.variance", "measurement.variance_m2"]
)";

Study known(const TemporaryFolder& folder, const std::string& study = kTune) {
  folder.write("known.toml", kKnown);
  return Study::load(folder.write("study.toml", study));
}

TunedValues tune(const Study& study, const std::string& name, int threads, TuneReport* report = nullptr,
                 int evaluations = 160) {
  TuneOptions options;
  options.seed = 2;
  options.threads = threads;
  options.max_evaluations = evaluations;
  return tune_tracker(study, name, options, report);
}

// The ratio of Q to R settles how good the estimates are, and the NEES settles the size of both.
TEST(Tune, FindsTheNoisesThatMadeTheRuns) {
  const TemporaryFolder folder;
  TuneReport report;
  const TunedValues values = tune(known(folder), "filter", 0, &report);
  EXPECT_NEAR(std::log(values.at("measurement.variance_m2")[0] / 1e4), 0.0, 0.15);
  EXPECT_NEAR(std::log(values.at("motion.variance")[1] / 2500.0), 0.0, 0.15);
  EXPECT_LT(report.cost_after, report.cost_before);
  EXPECT_GT(report.evaluations, 10);
  EXPECT_LE(report.evaluations, 161);
}

TEST(Tune, RanksFindTheNumbersOfOneProcessToTheBit) {
  const TemporaryFolder folder;
  const Study study = known(folder);
  TuneReport one;
  const TunedValues values = tune(study, "filter", 1, &one, 40);
  const auto tuned = [&](Ranks& ranks) {
    TuneOptions options{.seed = 2, .threads = 1, .max_evaluations = 40, .progress = {}, .ranks = &ranks};
    TuneReport report;
    const TunedValues found = tune_tracker(study, "filter", options, &report);
    EXPECT_EQ(report.evaluations, one.evaluations);
    EXPECT_EQ(report.cost_before, one.cost_before);
    EXPECT_EQ(report.cost_after, one.cost_after);
    return found;
  };
  EXPECT_THAT(at_ranks(2, tuned), Each(values));
  EXPECT_THAT(at_ranks(61, tuned), Each(values)) << "more than there are runs";
}

// As where one machine's exponential rounds otherwise: nobody goes on with runs of two trackers.
TEST(Tune, RanksThatLookAtDifferentNumbersAreTold) {
  const TemporaryFolder folder;
  const Study study = known(folder),
              other = known(folder, replaced(kTune, "variance_m2 = 2e3", "variance_m2 = 2001.0"));
  const auto messages = at_ranks(2, [&](Ranks& ranks) {
    TuneOptions options{.seed = 2, .threads = 1, .max_evaluations = 10, .progress = {}, .ranks = &ranks};
    return error_message([&] { tune_tracker(ranks.rank() == 0 ? study : other, "filter", options); });
  });
  EXPECT_EQ(messages[0], "rank 1: rounds otherwise than rank 0; valid: machines of one kind");
  EXPECT_EQ(messages[1], "rank 0: rounds otherwise than rank 1; valid: machines of one kind");
}

// Ranks whose first so many exchanges are as they should be, and then one bit is another.
class ThatPart final : public Ranks {
 public:
  ThatPart(Ranks& ranks, int exchanges) : ranks_(ranks), left_(exchanges) {}
  std::size_t rank() const override { return ranks_.rank(); }
  std::size_t size() const override { return ranks_.size(); }
  void send(std::size_t to, std::size_t number, std::string bytes) override {
    ranks_.send(to, number, std::move(bytes));
  }
  std::optional<Message> receive() override { return ranks_.receive(); }
  std::vector<std::string> gather_all(std::string_view bytes) override {
    std::string sent(bytes);
    if (left_-- == 0 && rank() == 1) sent[0] = static_cast<char>(sent[0] ^ 1);
    return ranks_.gather_all(sent);
  }
  void leave() override { ranks_.leave(); }
  [[noreturn]] void abort() override { std::abort(); }

 private:
  Ranks& ranks_;
  int left_;
};

TEST(Tune, RanksThatPartOnTheWayAreTold) {
  const TemporaryFolder folder;
  const Study study = known(folder);
  const auto messages = at_ranks(2, [&](Ranks& ranks) {
    ThatPart parting(ranks, 8);  // of four evaluations
    TuneOptions options{.seed = 2, .threads = 1, .max_evaluations = 20, .progress = {}, .ranks = &parting};
    return error_message([&] { tune_tracker(study, "filter", options); });
  });
  EXPECT_EQ(messages[0], "rank 1: rounds otherwise than rank 0; valid: machines of one kind");
  EXPECT_THAT(messages[1], HasSubstr("rounds otherwise"));
}

// From either side, over seeds: the mean of ln(found / true) is zero within its interval, and no seed is far off.
TEST(Tune, OneNumberAloneIsFoundWithoutBias) {
  const TemporaryFolder folder;
  const std::string right_q = replaced(kTune, "variance = [300.0, 250.0]", "variance = [100.0, 2500.0]");
  const std::string text = replaced(replaced(right_q, "\"motion.variance\", ", ""), "runs = 60", "runs = 40");
  const Study below = known(folder, replaced(text, "variance_m2 = 2e3", "variance_m2 = 1e3"));
  const Study above = known(folder, replaced(text, "variance_m2 = 2e3", "variance_m2 = 1e5"));
  std::vector<double> errors;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    TuneOptions options;
    options.seed = seed;
    options.max_evaluations = 50;
    const double found =
        tune_tracker(seed % 2 == 0 ? below : above, "filter", options).at("measurement.variance_m2")[0];
    errors.push_back(std::log(found / 1e4));
    EXPECT_NEAR(errors.back(), 0.0, 0.25) << seed;
  }
  const testing::Moments moments = testing::moments(errors);
  EXPECT_NEAR(moments.mean, 0.0, testing::mean_margin(std::sqrt(moments.variance), errors.size()));
  EXPECT_LT(std::sqrt(moments.variance), 0.1);
}

TEST(Tune, CommonFactorIsSetByTheNees) {
  const TemporaryFolder folder;
  // Q, R and P0 tuned together: one factor on all of them changes no estimate.
  const std::string all =
      replaced(kTune, "\"measurement.variance_m2\"]", "\"measurement.variance_m2\", \"start.variance\"]");
  for (const char* start : {"variance_m2 = 2e3", "variance_m2 = 2e5"}) {
    const Study study = known(folder, replaced(all, "variance_m2 = 2e3", start));
    ParametersFile parameters;
    parameters.trackers["filter"] = tune(study, "filter", 0, nullptr, 30);
    Study tuned = known(folder, replaced(all, "variance_m2 = 2e3", start));
    tuned.set_parameters(parameters);
    ComparisonOptions options = tuned.comparison_options();
    options.seed = 2;
    options.role = Role::tuning;
    options.runs = tuned.tuning_runs();
    const Comparison comparison = compare(tuned.make_tracker_set(), tuned.evaluation_scenarios(), options);
    EXPECT_NEAR(comparison.trackers[0].nees, 2.0, 1e-6) << start;
  }
}

// A sensor that is turned: H from pairs of truth and measurement, beside the number that is tuned after it.
TEST(Tune, FitsTheMatrixOfASensor) {
  const std::string text = R"(name = "turned"
[scenario]
kind = "lorenz"
period_s = 0.02
steps = 100
truth = { model = "lorenz_rk4", step_s = 0.02 }
start = { x = 1.0, y = 1.0, z = 1.0 }
sensor = { sigma = 0.1, rotation_deg = [2.0, -3.0, 5.0] }
[tuning]
runs = 20
[trackers.filter]
kind = "kalman"
motion = { model = "lorenz_rk4", step_s = 0.02, sigma = 0.01 }
measurement = { model = "lorenz", sigma = 0.3, matrix = [1, 0, 0, 0, 1, 0, 0, 0, 1] }
start = { kind = "prior", x = [1, 1, 1], variance = [1, 1, 1] }
tune = ["measurement.matrix", "measurement.sigma"]
)";
  const TemporaryFolder folder;
  const Study study = Study::load(folder.write("turned.toml", text));
  const TunedValues values = tune(study, "filter", 0, nullptr, 40);
  const Eigen::Matrix3d expected = rotation_of({2.0, -3.0, 5.0});
  const std::vector<double>& found = values.at("measurement.matrix");
  ASSERT_EQ(found.size(), 9u);
  // 2000 measurements of .1 over states that spread by some eight: 3e-4 of standard deviation.
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(found[static_cast<std::size_t>(3 * i + j)], expected(i, j), 2e-3);
  EXPECT_EQ(values.count("measurement.sigma"), 1u);
  const Study alone = Study::load(folder.write("alone.toml", replaced(text, ", \"measurement.sigma\"]", "]")));
  EXPECT_EQ(tune(alone, "filter", 0).at("measurement.matrix"), found);
  // One measurement of one state tells no matrix.
  const Study still = Study::load(
      folder.write("still.toml", replaced(replaced(text, "steps = 100", "steps = 1"), "runs = 20", "runs = 1")));
  EXPECT_THAT(error_message([&] { tune(still, "filter", 0); }), HasSubstr("measurement.matrix"));
  const Study ahead = Study::load(folder.write("ahead.toml", replaced(text, "tune = [", "ahead_s = 0.02\ntune = [")));
  EXPECT_THAT(error_message([&] { tune(ahead, "filter", 0); }), HasSubstr("ahead_s"));
}

TEST(Tune, IsTheSameForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const Study study = Study::load(testing::write_study(folder));
  const TunedValues one = tune(study, "tuned", 1, nullptr, 40);
  EXPECT_EQ(tune(study, "tuned", 2, nullptr, 40), one);
  EXPECT_EQ(tune(study, "tuned", 8, nullptr, 40), one);
}

TEST(Tune, AsksNoMoreOftenThanItSays) {
  const TemporaryFolder folder;
  const Study study = Study::load(testing::write_study(folder));
  for (const int limit : {1, 2, 6, 7}) {
    TuneOptions options;
    options.max_evaluations = limit;
    int told = 0;
    options.progress = [&](int done, int most, double) {
      EXPECT_EQ(done, ++told);
      EXPECT_LE(done, most);
      EXPECT_LE(most, std::max(limit, 2) + 1);
    };
    TuneReport report;
    tune_tracker(study, "tuned", options, &report);
    EXPECT_EQ(report.evaluations, told);
  }
}

TEST(Tune, WhatIsNotTunedIsRefused) {
  const TemporaryFolder folder;
  const Study study = Study::load(testing::write_study(folder));
  EXPECT_THAT(error_message([&] { tune(study, "plain", 1); }), HasSubstr("nothing to tune"));
  EXPECT_THAT(error_message([&] { tune(study, "tund", 1); }), HasSubstr("did you mean \"tuned\""));
}

}  // namespace
}  // namespace truebearing::tune_test
