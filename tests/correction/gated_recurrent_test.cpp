// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/gated_recurrent.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "tests/support/error_message.hpp"
#include "tests/support/recurrent_models.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/correction/corrected_tracker.hpp"
#include "truebearing/correction/model_file.hpp"
#include "truebearing/correction/network_file.hpp"
#include "truebearing/io/file.hpp"
#include "truebearing/io/safetensors.hpp"

namespace truebearing::gated_recurrent_test {
namespace {

using testing::error_message;
using testing::plane_ensemble;
using testing::plane_log;
using testing::recurrent_parameters;
using testing::recurrent_plane_model;
using testing::shared;
using testing::TemporaryFolder;

Eigen::VectorXd sigma(const Eigen::VectorXd& x) {
  return (1.0 + (-x).array().exp()).inverse();
}

// The equations of the header as they stand there, in double.
class AsWritten {
 public:
  explicit AsWritten(GatedRecurrent::Parameters parameters)
      : p_(std::move(parameters)), h_(Eigen::VectorXd::Zero(p_.weight_hh.cols())) {}

  Eigen::VectorXd step(const Eigen::VectorXd& input) {
    Eigen::VectorXd e =
        ((input - p_.input_mean).cwiseQuotient(p_.input_scale)).cwiseMax(-p_.input_clip).cwiseMin(p_.input_clip);
    if (p_.encoder_weight.size() > 0)
      e = (p_.encoder_weight.cast<double>() * e + p_.encoder_bias.cast<double>()).array().tanh().matrix();
    const Eigen::VectorXd of_input = p_.weight_ih.cast<double>() * e + p_.bias_ih.cast<double>();
    const Eigen::VectorXd of_hidden = p_.weight_hh.cast<double>() * h_ + p_.bias_hh.cast<double>();
    const Eigen::Index H = h_.size();
    const Eigen::VectorXd r = sigma(of_input.head(H) + of_hidden.head(H));
    const Eigen::VectorXd z = sigma(of_input.segment(H, H) + of_hidden.segment(H, H));
    const Eigen::VectorXd n = (of_input.tail(H) + r.cwiseProduct(of_hidden.tail(H))).array().tanh().matrix();
    h_ = (1.0 - z.array()) * n.array() + z.array() * h_.array();
    return p_.output_scale.cwiseProduct(p_.output_weight.cast<double>() * h_ + p_.output_bias.cast<double>());
  }

  Eigen::MatrixXd moments() const {
    const Eigen::VectorXd c = p_.covariance_weight.cast<double>() * h_ + p_.covariance_bias.cast<double>();
    const Eigen::Index n = p_.output_scale.size();
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0, k = 0; i < n; ++i)
      for (Eigen::Index j = 0; j <= i; ++j, ++k) C(i, j) = i == j ? std::exp(c[k]) : c[k];
    return C * C.transpose();
  }

 private:
  GatedRecurrent::Parameters p_;
  Eigen::VectorXd h_;
};

// A network that forgets: errors of rounding die out in it as they do in one that was taught. Weights drawn at random
// make a chaotic one, where floats and doubles part.
GatedRecurrent::Parameters that_forgets(GatedRecurrent::Parameters parameters) {
  parameters.weight_hh *= 0.5F / parameters.weight_hh.norm();
  return parameters;
}

TEST(GatedRecurrent, IsWhatItsEquationsSayOverAThousandSteps) {
  constexpr double kClose = 2e-5;  // floats, and sums of up to 128 of them
  for (const auto& [e, H, n] : {std::array{0, 1, 1}, {0, 32, 2}, {7, 13, 4}, {48, 48, 4}, {128, 128, 8}}) {
    const GatedRecurrent::Parameters parameters = that_forgets(recurrent_parameters(1, 6, e, H, n));
    const GatedRecurrent network(parameters);
    AsWritten written(parameters);
    RandomStream random({}, StreamId::test);
    NetworkMemory h = NetworkMemory::Zero(network.memory());
    NetworkAnswer answer;
    for (int k = 0; k < 1000; ++k) {
      const NetworkInputs input = NetworkInputs::NullaryExpr(6, [&] { return 2.0 * random.normal(); });
      network.answer(input, h, answer);
      const Eigen::VectorXd y = written.step(input);
      ASSERT_LT((answer.y - y).cwiseQuotient(parameters.output_scale).lpNorm<Eigen::Infinity>(), kClose)
          << e << " " << H << " step " << k;
      const Eigen::MatrixXd moments = written.moments();
      ASSERT_LT((answer.moments - moments).norm(), kClose * moments.norm()) << e << " " << H << " step " << k;
    }
  }
}

// Made by torch.nn.Linear and torch.nn.GRU of LibTorch 1.13 from these weights: see the folder's README.
TEST(GatedRecurrent, AnswersAsPyTorchDoes) {
  const std::string folder = TRUEBEARING_SOURCE_DIR "/tests/correction/pytorch/";
  const auto sequence = nlohmann::json::parse(read_text_file(folder + "sequence.json", 1 << 22));
  const CorrectionModel model = read_model_file(folder + "model.gru.json");
  const auto& network = std::get<GatedRecurrent>(model.network);
  NetworkMemory h = NetworkMemory::Zero(network.memory());
  NetworkAnswer answer;
  ASSERT_EQ(sequence["inputs"].size(), 1000u);
  double worst = 0.0;
  for (std::size_t k = 0; k < 1000; ++k) {
    const auto values = sequence["inputs"][k].get<std::vector<double>>();
    network.answer(NetworkInputs(Eigen::Map<const Eigen::VectorXd>(values.data(), network.inputs())), h, answer);
    for (Eigen::Index i = 0; i < network.outputs(); ++i)
      worst =
          std::max(worst, std::abs(answer.y[i] - sequence["outputs"][k][static_cast<std::size_t>(i)].get<double>()) /
                              network.parameters().output_scale[i]);
  }
  EXPECT_LT(worst, 1e-5);
}

TEST(GatedRecurrent, InputsThatAreNoNumbersGiveNoneAndLeaveItsMemory) {
  const GatedRecurrent network(recurrent_parameters(1, 2, 0, 4, 2));
  NetworkMemory h = NetworkMemory::Constant(4, 0.5F);
  NetworkAnswer answer;
  network.answer(NetworkInputs(Eigen::Vector2d(0.0, kNaN)), h, answer);
  EXPECT_TRUE(answer.y.array().isNaN().all());
  EXPECT_EQ(h, NetworkMemory::Constant(4, 0.5F));
}

TEST(GatedRecurrent, PartsThatDoNotFitAreRefusedByName) {
  const auto refusal = [](const auto& change) {
    GatedRecurrent::Parameters parameters = recurrent_parameters(1, 3, 4, 5, 2);
    change(parameters);
    return error_message([&] { GatedRecurrent{parameters}; });
  };
  using P = GatedRecurrent::Parameters;
  EXPECT_EQ(refusal([](P&) {}), "no error");
  EXPECT_NE(refusal([](P& p) { p.weight_ih.conservativeResize(14, 4); }).find("gru.weight_ih_l0: is 14 x 4"),
            std::string::npos);
  EXPECT_NE(refusal([](P& p) { p.bias_hh[3] = std::nanf(""); }).find("gru.bias_hh_l0"), std::string::npos);
  EXPECT_NE(refusal([](P& p) { p.encoder_bias.resize(3); }).find("encoder.bias"), std::string::npos);
  EXPECT_NE(refusal([](P& p) { p.covariance_weight.resize(2, 5); }).find("covariance.weight"), std::string::npos);
  EXPECT_NE(refusal([](P& p) { p.output_scale[0] = 0.0; }).find("output_scale"), std::string::npos);
  EXPECT_NE(refusal([](P& p) { p.weight_hh = Eigen::MatrixXf::Zero(3 * 129, 129); }).find("units: are 129"),
            std::string::npos);
}

CorrectedTracker tracker(std::uint64_t seed) {
  return {plane_ensemble(), shared(recurrent_plane_model(seed)), CorrectionBounds{3.0, true, RefereeOptions{}}};
}

// A row without a measurement leaves no trace: the bits that follow are those of the log without it.
TEST(GatedRecurrent, AnEmptyRowLeavesNoTrace) {
  CorrectedTracker with = tracker(2), without = tracker(2);
  const std::vector<Measurement> log = plane_log(1, 80);
  for (std::size_t k = 0; k < log.size(); ++k) {
    if (k % 5 == 4) {
      Measurement empty;
      empty.time_s = log[k].time_s - 0.5;
      with.step(empty);
    }
    const auto a = with.step(log[k]), b = without.step(log[k]);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i].x, b[i].x) << "step " << k;
      ASSERT_EQ(a[i].P, b[i].P) << "step " << k;
    }
  }
}

TEST(GatedRecurrent, RemembersATrackUntilItIsReset) {
  CorrectedTracker once = tracker(3), twice = tracker(3);
  const std::vector<Measurement> log = plane_log(1, 60), other = plane_log(2, 60);
  for (const Measurement& measurement : other) twice.step(measurement);
  twice.reset();
  bool moved = false;
  for (const Measurement& measurement : log) {
    const auto a = once.step(measurement), b = twice.step(measurement);
    ASSERT_EQ(a.size(), b.size());
    if (a.empty()) continue;
    ASSERT_EQ(a[0].x, b[0].x);
    moved = moved || (a[0].correction && a[0].x != a[0].correction->base_x);
  }
  EXPECT_TRUE(moved);
}

TEST(GatedRecurrentFile, IsTwoFilesThatBelongTogether) {
  const TemporaryFolder folder;
  const CorrectionModel model = recurrent_plane_model(4), other = recurrent_plane_model(5);
  const std::filesystem::path path = folder.path() / "m.gru.json";
  write_model_file(path, model);
  const CorrectionModel read = read_model_file(path);
  EXPECT_EQ(model_text(read), model_text(model));
  EXPECT_EQ(std::get<GatedRecurrent>(read.network).parameters(), std::get<GatedRecurrent>(model.network).parameters());

  write_model_file(path, other);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / weights_name(model))) << "weights that nobody names";
  EXPECT_EQ(model_text(read_model_file(path)), model_text(other));

  // Weights of another network of the same shape.
  write_file_atomically(folder.path() / weights_name(other),
                        gated_recurrent_weights(std::get<GatedRecurrent>(model.network)));
  EXPECT_NE(error_message([&] { read_model_file(path); }).find("the weights that belong to this file"),
            std::string::npos);
  std::filesystem::remove(folder.path() / weights_name(other));
  EXPECT_NE(error_message([&] { read_model_file(path); }).find(weights_name(other)), std::string::npos);
}

TEST(GatedRecurrentFile, TensorsThatAreMissingUnknownOrMisshapedAreRefusedByName) {
  const TemporaryFolder folder;
  const CorrectionModel model = recurrent_plane_model(4);
  const std::filesystem::path path = folder.path() / "m.gru.json";
  write_model_file(path, model);
  const std::filesystem::path weights = folder.path() / weights_name(model);
  const Tensors good = parse_safetensors(read_text_file(weights, 1 << 22), "w");
  const auto refusal = [&](const auto& change) {
    Tensors tensors = good;
    change(tensors);
    write_file_atomically(weights, safetensors_bytes(tensors));
    return error_message([&] { read_model_file(path); });
  };
  EXPECT_EQ(refusal([](Tensors&) {}), "no error");
  EXPECT_NE(refusal([](Tensors& t) { t.erase("gru.bias_hh_l0"); }).find("holds no gru.bias_hh_l0"), std::string::npos);
  EXPECT_NE(refusal([](Tensors& t) { t["gru.weight_hr_l0"] = t["output.weight"]; }).find("gru.weight_hr_l0"),
            std::string::npos);
  EXPECT_NE(refusal([](Tensors& t) { t["output.bias"].vector = false; }).find("number of dimensions"),
            std::string::npos);
  EXPECT_NE(refusal([](Tensors& t) {
              t["output.weight"].values.conservativeResize(3, Eigen::NoChange);
            }).find("output.weight: is 3 x 11"),
            std::string::npos);
  EXPECT_NE(refusal([](Tensors& t) { t["output.bias"].values(0, 0) += 0.1F; }).find("examples[0]"), std::string::npos);
}

TEST(GatedRecurrentFile, WeightsInAnotherFolderAreRefused) {
  nlohmann::json json = nlohmann::json::parse(model_text(recurrent_plane_model(4)));
  for (const char* name : {"../w.safetensors", "/etc/passwd", "", ".hidden"}) {
    json["weights"] = name;
    EXPECT_NE(error_message([&] { parse_model(json.dump(), "m.json"); }).find("in the same folder"), std::string::npos);
  }
}

}  // namespace
}  // namespace truebearing::gated_recurrent_test
