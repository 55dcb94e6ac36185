// SPDX-License-Identifier: Apache-2.0
#include "training/train_correction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/radar_study.hpp"
#include "tests/support/thread_ranks.hpp"
#include "truebearing/correction/model_file.hpp"
#include "truebearing/evaluation/comparison.hpp"

namespace truebearing::train_correction_test {
namespace {

using testing::at_ranks;
using ::testing::Each;
using testing::kStudy;
using testing::replaced;
using testing::TemporaryFolder;
using testing::write_study;

CorrectionModel train(const Study& study, std::uint64_t seed, int threads, TrainReport* report = nullptr) {
  TrainOptions options;
  options.seed = seed;
  options.threads = threads;
  return train_correction(study, "nfnn", options, report);
}

TEST(TrainCorrection, SameSeedIsTheSameModelOnAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const Study study = Study::load(write_study(folder));
  const std::string one = model_text(train(study, 5, 1));
  EXPECT_EQ(model_text(train(study, 5, 2)), one);
  EXPECT_EQ(model_text(train(study, 5, 8)), one);
  EXPECT_NE(model_text(train(study, 6, 1)), one);
}

TEST(TrainCorrection, RanksHaveTheModelOfOneProcess) {
  const TemporaryFolder folder;
  const Study study = Study::load(write_study(folder));
  const std::string one = model_text(train(study, 5, 1));
  for (const std::size_t count : {2u, 3u})
    EXPECT_THAT(at_ranks(count,
                         [&](Ranks& ranks) {
                           TrainOptions options;
                           options.seed = 5;
                           options.threads = 1;
                           options.ranks = &ranks;
                           return model_text(train_correction(study, "nfnn", options));
                         }),
                Each(one));
}

TEST(TrainCorrection, ModelRemembersWhatItWasTrainedFor) {
  const TemporaryFolder folder;
  const Study study = Study::load(write_study(folder));
  TrainReport report;
  const CorrectionModel model = train(study, 5, 0, &report);
  EXPECT_EQ(report.rows, 20 * 40);
  EXPECT_EQ(model.rules().network.rules(), 4);
  EXPECT_EQ(model.design, study.tracker("nfnn").correction->design);
  EXPECT_EQ(model.design.base, "plain");
  EXPECT_EQ(model.design.reference, "tuned");
  EXPECT_EQ(model.design.covariance_of, "wide");
  EXPECT_EQ(model.trackers.size(), 3u);
  EXPECT_EQ(model.trackers.at("tuned"), study.configuration_line("tuned"));
  EXPECT_EQ(model.provenance.at("study"), "small");
  EXPECT_EQ(model.provenance.at("training_runs"), "20");
  EXPECT_EQ(model.provenance.at("training_rows"), "800");
  EXPECT_EQ(model.provenance.at("bounds"), "kappa 3, gate, no referee");
  EXPECT_NO_THROW(model.validate());
  study.check_model("nfnn", model, "here");
}

TEST(TrainCorrection, MirroredBoxIsSymmetricInWhatAMirrorTurns) {
  const TemporaryFolder folder;
  const CorrectionModel model = train(Study::load(write_study(folder)), 5, 0);
  ASSERT_TRUE(model.gate.has_value());
  EXPECT_EQ(model.gate->low[0], 0.0) << "ln step, from the first";
  EXPECT_DOUBLE_EQ(model.gate->high[0], std::log(40.0));
  EXPECT_DOUBLE_EQ(model.gate->low[1], -model.gate->high[1]) << "the companion's difference";
  EXPECT_NE(model.gate->low[2], -model.gate->high[2]) << "the NIS";
}

TEST(TrainCorrection, GateRemembersTheIntervalsThatWereTaught) {
  const TemporaryFolder folder;
  const auto intervals = [&](const std::string& study) {
    return train(Study::load(write_study(folder, study)), 5, 0).gate->intervals;
  };
  const IntervalBox own = intervals(kStudy);
  EXPECT_NEAR(own.low_s, 1.0, 1e-9);
  EXPECT_NEAR(own.high_s, 1.0, 1e-9);
  EXPECT_EQ(own.longest_coast_s, 0.0);

  const std::string mixed = replaced(kStudy, "mirror = true\n",
                                     "mirror = true\nscenario = { looks = { period_factor = { uniform = [0.5, 3.0] }, "
                                     "missed = 0.5, empty_rows = true } }\n");
  const IntervalBox taught = intervals(mixed);
  EXPECT_GE(taught.low_s, 0.5);
  EXPECT_LT(taught.low_s, 0.9);
  EXPECT_GT(taught.high_s, 6.0) << "with half the rows missing";
  EXPECT_GT(taught.longest_coast_s, 3.0);
}

// kappa, gate and referee may change without a new training: nothing in the model but its provenance depends on them.
TEST(TrainCorrection, BoundsOfTheStudyAreNoPartOfTheTraining) {
  const TemporaryFolder folder;
  CorrectionModel bounded = train(Study::load(write_study(folder)), 5, 0);
  CorrectionModel free =
      train(Study::load(write_study(folder, replaced(kStudy, "kappa = 3.0", "kappa = inf\ngate = false"))), 5, 0);
  EXPECT_TRUE(free.gate.has_value());
  EXPECT_EQ(free.provenance.at("bounds"), "kappa inf, no gate, no referee");
  free.provenance["bounds"] = bounded.provenance.at("bounds");
  EXPECT_EQ(model_text(free), model_text(bounded));
  CorrectionModel promised = train(
      Study::load(write_study(folder, replaced(kStudy, "kappa = 3.0", "gate = { longest_interval_s = 0.5 }"))), 5, 0);
  EXPECT_EQ(promised.provenance.at("bounds"), "kappa 3, gate up to 0.5 s, no referee");
  promised.provenance["bounds"] = bounded.provenance.at("bounds");
  EXPECT_EQ(model_text(promised), model_text(bounded));
}

TEST(TrainCorrection, CorrectionTakesMostOfThePlainFiltersError) {
  const TemporaryFolder folder;
  const Study study = Study::load(write_study(folder));
  const CorrectionModels models{{"nfnn", std::make_shared<const CorrectionModel>(train(study, 5, 0))}};
  ComparisonOptions options = study.comparison_options();
  options.runs = 100;
  const Comparison comparison = compare(study.make_tracker_set(models), study.evaluation_scenarios(), options);
  const QuantitySummary& plain = *comparison.tracker("plain")->quantity("velocity_mps");
  const QuantitySummary& corrected = *comparison.tracker("nfnn")->quantity("velocity_mps");
  EXPECT_LT(corrected.rmse + 4.0 * corrected.rmse_se, plain.rmse - 4.0 * plain.rmse_se);
}

TEST(TrainCorrection, ByBackPropagationIsTheSameToTheBitToo) {
  const TemporaryFolder folder;
  const Study study = Study::load(write_study(folder, replaced(kStudy, "rules = 4\nruns = 20\niterations = 10",
                                                               "method = \"back_propagation\"\nruns = 5\nepochs = 2")));
  EXPECT_EQ(model_text(train(study, 5, 1)), model_text(train(study, 5, 4)));
}

}  // namespace
}  // namespace truebearing::train_correction_test
