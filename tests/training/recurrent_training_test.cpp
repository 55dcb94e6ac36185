// SPDX-License-Identifier: Apache-2.0
// Skipped where the build has no LibTorch.
#include "training/recurrent_training.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "tests/support/error_message.hpp"
#include "tests/support/radar_study.hpp"
#include "tests/support/recurrent_models.hpp"
#include "tests/support/thread_ranks.hpp"
#include "tests/support/temporary_folder.hpp"
#include "training/recurrent_checkpoint.hpp"
#include "training/train_correction.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/correction/model_file.hpp"

namespace truebearing::recurrent_training_test {
namespace {

class RecurrentTraining : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(TRUEBEARING_TORCH_FOLDER "/truebearing_torch.so")) GTEST_SKIP() << "no LibTorch";
    module_ = recurrent_module(TRUEBEARING_TORCH_FOLDER);
  }

  RecurrentModule module_{};
};

constexpr int kTracks = 60, kSteps = 40;

// The target is the mean so far of the first input; every fourth row is not remembered, and its input is that of a row
// which the target does not count.
RecurrentRows running_means(std::uint64_t seed) {
  RandomStream random({.seed = seed}, StreamId::test);
  RecurrentRows rows;
  rows.inputs.resize(2, kTracks * kSteps);
  rows.targets.resize(1, kTracks * kSteps);
  for (int track = 0, row = 0; track < kTracks; ++track) {
    double sum = 0.0;
    int count = 0;
    for (int k = 0; k < kSteps; ++k, ++row) {
      const bool used = k % 4 != 3;
      const double input = random.normal();
      if (used) sum += input, ++count;
      rows.inputs.col(row) << static_cast<float>(input), used ? 1.0F : 0.0F;
      rows.targets(0, row) = static_cast<float>(sum / count);
      rows.begins.push_back(k == 0);
      rows.taught.push_back(k >= 2);
      rows.used.push_back(used);
    }
  }
  return rows;
}

GatedRecurrent::Parameters scales() {
  GatedRecurrent::Parameters parameters;
  parameters.input_mean = Eigen::Vector2d::Zero();
  parameters.input_scale = Eigen::Vector2d::Ones();
  parameters.input_clip = 10.0;
  parameters.output_scale = Eigen::VectorXd::Ones(1);
  return parameters;
}

RecurrentOptions few_epochs() {
  return {.units = 8, .epochs = 30, .batch = 16, .learning_rate = 0.02, .seed = 3, .two_threads = true};
}

// What the run-time network makes of the rows that are taught.
Eigen::VectorXd errors(const RecurrentRows& rows, GatedRecurrent::Parameters parameters, Eigen::VectorXd* deviation) {
  if (parameters.covariance_weight.size() == 0) {
    parameters.covariance_weight = Eigen::MatrixXf::Zero(1, parameters.weight_hh.cols());
    parameters.covariance_bias = Eigen::VectorXf::Zero(1);
  }
  const GatedRecurrent network(parameters);
  NetworkMemory kept, memory;
  NetworkAnswer answer;
  Eigen::VectorXd errors = Eigen::VectorXd::Zero(rows.inputs.cols());
  if (deviation) *deviation = Eigen::VectorXd::Ones(rows.inputs.cols());
  for (Eigen::Index row = 0; row < errors.size(); ++row) {
    const auto i = static_cast<std::size_t>(row);
    if (rows.begins[i]) kept = NetworkMemory::Zero(network.memory());
    memory = kept;
    network.answer(rows.inputs.col(row).cast<double>(), memory, answer);
    if (rows.used[i]) kept = memory;
    if (!rows.taught[i]) continue;
    errors[row] = static_cast<double>(rows.targets(0, row)) - answer.y[0];
    if (deviation) (*deviation)[row] = std::sqrt(answer.moments(0, 0));
  }
  return errors;
}

TEST_F(RecurrentTraining, LearnsWhatOnlyAMemoryCanTell) {
  const RecurrentRows training = running_means(1), validation = running_means(2), fresh = running_means(7);
  GatedRecurrent::Parameters parameters = scales();
  const double cost = module_.train(training, validation, few_epochs(), {}, {}, {}, parameters);
  const auto mean_square = [](const RecurrentRows& rows, const Eigen::VectorXd& e) {
    return e.squaredNorm() / static_cast<double>(std::count(rows.taught.begin(), rows.taught.end(), true));
  };
  // What the trainer says of the validation's rows is what the run-time network does there.
  EXPECT_NEAR(mean_square(validation, errors(validation, parameters, nullptr)), cost, 1e-4 * cost);
  const double power = fresh.targets.cast<double>().squaredNorm() / static_cast<double>(fresh.targets.size());
  EXPECT_LT(mean_square(fresh, errors(fresh, parameters, nullptr)), 0.2 * power);
}

TEST_F(RecurrentTraining, IsTheSameToTheBitOnOneThreadAndTwo) {
  const RecurrentRows training = running_means(1), validation = running_means(2);
  RecurrentOptions options = few_epochs();
  options.epochs = 3;
  GatedRecurrent::Parameters first = scales(), again = scales(), alone = scales(), other = scales();
  module_.train(training, validation, options, {}, {}, {}, first);
  module_.train(training, validation, options, {}, {}, {}, again);
  EXPECT_EQ(first, again);
  options.two_threads = false;
  module_.train(training, validation, options, {}, {}, {}, alone);
  EXPECT_EQ(first, alone);
  options.seed = 4;
  module_.train(training, validation, options, {}, {}, {}, other);
  EXPECT_FALSE(first == other);
}

// Broken off after each of its epochs, with mirror images, so that nothing of what a training remembers is left out.
TEST_F(RecurrentTraining, GoesOnWhereItWasBrokenOffToTheBit) {
  RecurrentRows training = running_means(1), validation = running_means(2);
  training.parity = Eigen::Vector2f(-1.0F, 1.0F);
  training.out_parity = Eigen::VectorXf::Constant(1, -1.0F);
  RecurrentOptions options = few_epochs();
  options.epochs = 4;
  options.learning_rate = 0.2;  // so high that the last epoch is not the best
  GatedRecurrent::Parameters whole = scales();
  std::vector<RecurrentState> states;
  std::vector<double> costs;
  const double cost = module_.train(
      training, validation, options, {}, [&](const RecurrentState& state) { states.push_back(state); },
      [&](int, int, double after) { costs.push_back(after); }, whole);
  ASSERT_EQ(states.size(), 4u);
  EXPECT_EQ(cost, *std::min_element(costs.begin(), costs.end()));
  for (const RecurrentState& state : states) {
    GatedRecurrent::Parameters parts = scales();
    std::vector<int> epochs;
    EXPECT_EQ(
        module_.train(
            training, validation, options, state, {}, [&](int epoch, int, double) { epochs.push_back(epoch); }, parts),
        cost);
    EXPECT_EQ(parts, whole) << "from epoch " << state.epochs;
    EXPECT_EQ(epochs.front(), state.epochs);
    EXPECT_EQ(epochs.size(), 5u - static_cast<std::size_t>(state.epochs));
  }
}

// Errors whose deviation the input tells: the head has to say which.
TEST_F(RecurrentTraining, CovarianceHeadSaysHowSureTheNetworkIs) {
  RecurrentRows rows = running_means(1);
  GatedRecurrent::Parameters parameters = scales();
  RecurrentOptions options = few_epochs();
  options.epochs = 3;
  module_.train(rows, running_means(2), options, {}, {}, {}, parameters);
  RandomStream random({.seed = 9}, StreamId::test);
  Eigen::MatrixXf sigmas(1, rows.inputs.cols());
  for (Eigen::Index row = 0; row < sigmas.cols(); ++row)
    sigmas(0, row) = static_cast<float>((rows.used[static_cast<std::size_t>(row)] ? 0.5 : 2.0) * random.normal());
  module_.fit_covariance(rows, sigmas, 1, {}, parameters);
  Eigen::VectorXd deviation;
  errors(rows, parameters, &deviation);
  double used = 0.0, lone = 0.0;
  int counts[2] = {};
  for (Eigen::Index row = 0; row < deviation.size(); ++row) {
    const auto i = static_cast<std::size_t>(row);
    if (!rows.taught[i]) continue;
    (rows.used[i] ? used : lone) += deviation[row];
    ++counts[rows.used[i] ? 0 : 1];
  }
  // One number for both would be 1.1.
  EXPECT_NEAR(used / counts[0], 0.5, 0.2);
  EXPECT_NEAR(lone / counts[1], 2.0, 0.7);
}

TEST_F(RecurrentTraining, RunTimeNetworkAnswersAsLibTorchOverAThousandSteps) {
  for (const int encoder : {0, 12}) {
    GatedRecurrent::Parameters parameters = testing::recurrent_parameters(5, 8, encoder, 32, 4);
    parameters.weight_hh *= 0.3F;  // one that forgets: a chaotic one is told apart by its last digits
    parameters.input_mean.setZero();
    parameters.input_scale.setOnes();
    parameters.output_scale.setOnes();
    RandomStream random({}, StreamId::test);
    const Eigen::MatrixXf inputs =
        Eigen::MatrixXf::NullaryExpr(8, 1000, [&] { return static_cast<float>(random.normal()); });
    const Eigen::MatrixXf wanted = module_.answers(parameters, inputs);
    const GatedRecurrent network(parameters);
    NetworkMemory h = NetworkMemory::Zero(32);
    NetworkAnswer answer;
    double worst = 0.0;
    for (Eigen::Index k = 0; k < inputs.cols(); ++k) {
      network.answer(inputs.col(k).cast<double>(), h, answer);
      worst = std::max(worst, (answer.y - wanted.col(k).cast<double>()).lpNorm<Eigen::Infinity>());
    }
    EXPECT_LT(worst, 2e-5) << encoder;
  }
}

// Only the first of them needs what trains it.
TEST_F(RecurrentTraining, OfAStudyGivesAllRanksTheModelOfOneProcess) {
  const testing::TemporaryFolder folder;
  const Study study = Study::load(testing::write_study(folder, testing::kRecurrentStudy));
  TrainOptions options;
  options.torch_folder = TRUEBEARING_TORCH_FOLDER;
  const CorrectionModel one = train_correction(study, "gru", options);
  const auto texts = testing::at_ranks(2, [&](Ranks& ranks) {
    TrainOptions shared = options;
    shared.ranks = &ranks;
    if (!is_first(&ranks)) shared.torch_folder = "/nowhere";
    const CorrectionModel model = train_correction(study, "gru", shared);
    return std::pair(model_text(model), weights_text(model));
  });
  for (const auto& [text, weights] : texts) {
    EXPECT_EQ(text, model_text(one));
    EXPECT_EQ(weights, weights_text(one));
  }
}

TEST_F(RecurrentTraining, OfAStudyGoesOnFromItsCheckpointAndNoOthers) {
  const testing::TemporaryFolder folder;
  const Study study = Study::load(testing::write_study(folder, testing::kRecurrentStudy));
  TrainOptions options;
  options.torch_folder = TRUEBEARING_TORCH_FOLDER;
  const std::string whole = model_text(train_correction(study, "gru", options));
  options.checkpoint = folder.path() / "small.checkpoint";
  options.training_progress = [](int epoch, int, double) {
    if (epoch == 2) throw std::runtime_error("killed");
  };
  EXPECT_THROW(train_correction(study, "gru", options), std::runtime_error);
  ASSERT_TRUE(std::filesystem::exists(options.checkpoint));
  options.training_progress = {};
  options.seed = 2;
  EXPECT_NE(testing::error_message([&] { train_correction(study, "gru", options); }).find("with another seed"),
            std::string::npos);
  options.seed = 1;
  int first = 0;
  options.training_progress = [&](int epoch, int, double) {
    if (first == 0) first = epoch;
  };
  EXPECT_EQ(model_text(train_correction(study, "gru", options)), whole);
  EXPECT_EQ(first, 2);
}

RecurrentState some_state(int epochs) {
  RecurrentState state{.epochs = epochs, .weights = {}, .mean = {}, .square = {}, .best = {}};
  float next = 0.1F;
  for (auto* part : {&state.weights, &state.mean, &state.square, &state.best})
    for (const auto& [rows, columns] : {std::pair{8, 2}, {8, 1}, {24, 8}, {24, 8}, {24, 1}, {24, 1}, {1, 8}, {1, 1}})
      part->push_back(Eigen::MatrixXf::NullaryExpr(rows, columns, [&] { return next += 0.01F; }));
  return state;
}

TEST(RecurrentCheckpoint, ReadsWhatItWrote) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "m.checkpoint";
  RecurrentOptions options = few_epochs();
  const RecurrentRows training = running_means(1), validation = running_means(2);
  const RecurrentCheckpoint checkpoint(path, training, validation, options);
  EXPECT_EQ(checkpoint.read().epochs, 0) << "there is none";
  const RecurrentState state = some_state(30);
  checkpoint.write(state);
  options.two_threads = false;  // which changes nothing
  const RecurrentState read = RecurrentCheckpoint(path, training, validation, options).read();
  EXPECT_EQ(read.epochs, 30);
  EXPECT_EQ(read.weights, state.weights);
  EXPECT_EQ(read.mean, state.mean);
  EXPECT_EQ(read.square, state.square);
  EXPECT_EQ(read.best, state.best);
  EXPECT_EQ(RecurrentCheckpoint({}, training, validation, options).read().epochs, 0) << "none is kept";
}

TEST(RecurrentCheckpoint, OfAnotherTrainingIsRefused) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "m.checkpoint";
  const RecurrentOptions options = few_epochs();
  const RecurrentRows training = running_means(1), validation = running_means(2);
  RecurrentCheckpoint(path, training, validation, options).write(some_state(2));
  const auto refusal = [&](const RecurrentRows& rows, const RecurrentRows& validated, const RecurrentOptions& changed) {
    return testing::error_message([&] { RecurrentCheckpoint(path, rows, validated, changed).read(); });
  };
  const std::string another = path.string() +
                              ": was begun by another study, with other keys or with another seed; valid: the same "
                              "again; remove it to begin afresh";
  const auto with = [&](auto RecurrentOptions::*option, auto value) {
    RecurrentOptions changed = options;
    changed.*option = value;
    return changed;
  };
  EXPECT_EQ(refusal(training, validation, with(&RecurrentOptions::seed, 4u)), another);
  EXPECT_EQ(refusal(training, validation, with(&RecurrentOptions::epochs, 31)), another);
  EXPECT_EQ(refusal(training, validation, with(&RecurrentOptions::batch, 17)), another);
  EXPECT_EQ(refusal(training, validation, with(&RecurrentOptions::learning_rate, 0.021)), another);
  EXPECT_EQ(refusal(training, running_means(3), options), another);
  RecurrentRows changed = training;
  changed.inputs(1, 1234) += 1e-3F;
  EXPECT_EQ(refusal(changed, validation, options), another);
  changed = training;
  changed.taught[1234] = !changed.taught[1234];
  EXPECT_EQ(refusal(changed, validation, options), another);
  changed = training;
  changed.parity = Eigen::Vector2f(-1.0F, 1.0F);
  EXPECT_EQ(refusal(changed, validation, options), another);
}

TEST(RecurrentCheckpoint, ThatIsDamagedIsRefused) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "m.checkpoint";
  const RecurrentRows rows = running_means(1);
  const RecurrentCheckpoint checkpoint(path, rows, rows, few_epochs());
  const auto refusal = [&] { return testing::error_message([&] { checkpoint.read(); }); };
  checkpoint.write(some_state(3));
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 4);
  EXPECT_EQ(refusal().find(path.string() + ": "), 0u) << refusal();
  checkpoint.write(some_state(31));
  EXPECT_EQ(refusal(), path.string() + ": has done 31 epochs; valid: 1 to 30");
  RecurrentState wider = some_state(3);
  wider.mean[2] = Eigen::MatrixXf::Ones(24, 9);
  checkpoint.write(wider);
  EXPECT_EQ(refusal(), path.string() +
                           ": holds no mean.gru.weight_ih_l0 of 24 x 8; valid: what `truebearing train` wrote; remove "
                           "it to begin afresh");
}

TEST(RecurrentModule, ThatIsMissingIsSaid) {
  EXPECT_NE(testing::error_message([] { recurrent_module("/nowhere"); }).find("which this build has not"),
            std::string::npos);
}

}  // namespace
}  // namespace truebearing::recurrent_training_test
