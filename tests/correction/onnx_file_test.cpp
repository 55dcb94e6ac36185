// SPDX-License-Identifier: Apache-2.0
// An ONNX file is read back by what its format says, and its graph evaluated by what its operators mean.
#include "truebearing/correction/onnx_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/recurrent_models.hpp"

namespace truebearing::onnx_file_test {
namespace {

using testing::recurrent_parameters;

// One field of a message: a number, or bytes.
struct Field {
  int number;
  std::uint64_t value = 0;
  std::string bytes;
};

std::vector<Field> fields(std::string_view text) {
  std::vector<Field> found;
  const auto varint = [&] {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      if (text.empty() || shift > 63) throw std::runtime_error("a number that does not end");
      const auto byte = static_cast<unsigned char>(text.front());
      text.remove_prefix(1);
      value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
      if (byte < 0x80) return value;
    }
  };
  while (!text.empty()) {
    const std::uint64_t tag = varint();
    Field field{static_cast<int>(tag >> 3)};
    if ((tag & 7) == 0) {
      field.value = varint();
    } else if ((tag & 7) == 2) {
      const std::uint64_t size = varint();
      if (size > text.size()) throw std::runtime_error("bytes beyond the end");
      field.bytes = text.substr(0, size);
      text.remove_prefix(size);
    } else {
      throw std::runtime_error("another wire type");
    }
    found.push_back(field);
  }
  return found;
}

std::vector<std::string> all(const std::string& message, int number) {
  std::vector<std::string> found;
  for (const Field& field : fields(message))
    if (field.number == number) found.push_back(field.bytes);
  return found;
}

std::string one(const std::string& message, int number) {
  const std::vector<std::string> found = all(message, number);
  if (found.size() != 1) throw std::runtime_error("is not there once");
  return found[0];
}

std::vector<std::int64_t> numbers(const std::string& message, int number) {
  std::vector<std::int64_t> found;
  for (const Field& field : fields(message))
    if (field.number == number) found.push_back(static_cast<std::int64_t>(field.value));
  return found;
}

struct Tensor {
  std::vector<std::int64_t> shape;
  Eigen::MatrixXf values;  // the last dimension along the row

  static Tensor of(const std::string& message) {
    Tensor tensor{numbers(message, 1), {}};
    std::int64_t size = 1;
    for (const std::int64_t length : tensor.shape) size *= length;
    const std::string raw = one(message, 9);
    const std::int64_t columns = tensor.shape.empty() ? 1 : tensor.shape.back();
    const bool is_float = numbers(message, 2).at(0) == 1;
    if (raw.size() != static_cast<std::size_t>(size) * (is_float ? 4 : 8)) throw std::runtime_error("another size");
    tensor.values.resize(size / columns, columns);
    for (std::int64_t i = 0; i < size; ++i) {
      float value = 0.0F;
      std::int64_t integer = 0;
      if (is_float)
        std::memcpy(&value, raw.data() + 4 * i, 4);
      else
        std::memcpy(&integer, raw.data() + 8 * i, 8);
      tensor.values(i / columns, i % columns) = is_float ? value : static_cast<float>(integer);
    }
    return tensor;
  }
};

// Gates z, r, n; linear_before_reset. X (T x e), h (H).
Eigen::MatrixXf gru(const Eigen::MatrixXf& X, const Eigen::MatrixXf& W, const Eigen::MatrixXf& R,
                    const Eigen::VectorXf& B, Eigen::VectorXf& h) {
  const Eigen::Index H = h.size();
  const auto sigma = [](const Eigen::VectorXf& x) { return (1.0F / (1.0F + (-x.array()).exp())).matrix().eval(); };
  Eigen::MatrixXf Y(X.rows(), H);
  for (Eigen::Index t = 0; t < X.rows(); ++t) {
    const Eigen::VectorXf in = W * X.row(t).transpose() + B.head(3 * H), back = R * h + B.tail(3 * H);
    const Eigen::VectorXf z = sigma(in.head(H) + back.head(H)), r = sigma(in.segment(H, H) + back.segment(H, H));
    const Eigen::VectorXf n = (in.tail(H) + r.cwiseProduct(back.tail(H))).array().tanh();
    h = (1.0F - z.array()) * n.array() + z.array() * h.array();
    Y.row(t) = h.transpose();
  }
  return Y;
}

struct Model {
  std::string graph;
  std::map<std::string, Tensor> constants;

  explicit Model(const std::string& bytes) : graph(one(bytes, 7)) {
    EXPECT_EQ(numbers(bytes, 1), std::vector<std::int64_t>{7}) << "the version of the format";
    EXPECT_EQ(numbers(one(bytes, 8), 2), std::vector<std::int64_t>{13}) << "the set of operators";
    for (const std::string& tensor : all(graph, 5))
      EXPECT_TRUE(constants.emplace(one(tensor, 8), Tensor::of(tensor)).second) << "one name, two tensors";
  }

  /// All that the graph comes to, by name. A node whose input nobody has made yet throws.
  std::map<std::string, Eigen::MatrixXf> run(const Eigen::MatrixXf& features, const Eigen::VectorXf& memory) const {
    std::map<std::string, Eigen::MatrixXf> values;
    for (const auto& [name, tensor] : constants) values[name] = tensor.values;
    values["features"] = features;
    values["memory"] = memory.transpose();
    for (const std::string& node : all(graph, 1)) {
      const std::vector<std::string> in = all(node, 1), out = all(node, 2);
      const std::string operation = one(node, 4);
      const auto x = [&](std::size_t i) -> const Eigen::MatrixXf& { return values.at(in.at(i)); };
      const auto by_row = [&] { return x(1).replicate(x(0).rows(), 1).eval(); };
      Eigen::MatrixXf y;
      if (operation == "Sub")
        y = x(0) - by_row();
      else if (operation == "Add")
        y = x(0) + by_row();
      else if (operation == "Mul")
        y = x(0).cwiseProduct(by_row());
      else if (operation == "Div")
        y = x(0).cwiseQuotient(by_row());
      else if (operation == "MatMul")
        y = x(0) * x(1);
      else if (operation == "Tanh")
        y = x(0).array().tanh();
      else if (operation == "Clip")
        y = x(0).cwiseMax(x(1)(0, 0)).cwiseMin(x(2)(0, 0));
      else if (operation == "Reshape")
        y = x(0);
      else if (operation == "GRU") {
        std::map<std::string, std::int64_t> attributes;
        for (const std::string& attribute : all(node, 5)) {
          EXPECT_EQ(numbers(attribute, 20), std::vector<std::int64_t>{2}) << "an integer";
          attributes[one(attribute, 1)] = numbers(attribute, 3).at(0);
        }
        EXPECT_EQ(attributes,
                  (std::map<std::string, std::int64_t>{{"hidden_size", memory.size()}, {"linear_before_reset", 1}}));
        EXPECT_EQ(in.at(4), "") << "all sequences are as long as they come";
        Eigen::VectorXf h = x(5).transpose();
        y = gru(x(0), x(1), x(2), x(3).transpose(), h);
        values[out.at(1)] = h.transpose();
      } else {
        throw std::runtime_error("another operator: " + operation);
      }
      values[out.at(0)] = y;
    }
    return values;
  }
};

void expect_the_networks_answers(int d, int e, int H, int n) {
  const GatedRecurrent::Parameters parameters = recurrent_parameters(3, d, e, H, n);
  const GatedRecurrent network(parameters);
  const Model model(onnx_bytes(parameters, "small"));
  EXPECT_EQ(one(model.graph, 2), "small");
  constexpr int kSteps = 12;
  RandomStream random({.seed = 4}, StreamId::test);
  const Eigen::MatrixXd features =
      Eigen::MatrixXd::NullaryExpr(kSteps, d, [&] { return 6.0 * random.normal(); });  // some are clipped
  const auto values = model.run(features.cast<float>(), Eigen::VectorXf::Zero(H));
  NetworkMemory memory = NetworkMemory::Zero(H);
  NetworkAnswer answer;
  for (int t = 0; t < kSteps; ++t) {
    network.answer(NetworkInputs(features.row(t).transpose()), memory, answer);
    const Eigen::VectorXd said = values.at("correction").row(t).transpose().cast<double>();
    EXPECT_LT((answer.y - said).norm(), 1e-4 * parameters.output_scale.norm()) << t;
    const Eigen::MatrixXf c = parameters.covariance_weight * memory + parameters.covariance_bias;
    EXPECT_LT((c - values.at("factor").row(t).transpose()).norm(), 1e-4) << t;
  }
  EXPECT_LT((memory - values.at("memory_after").transpose()).norm(), 1e-4);
}

TEST(OnnxFile, ItsGraphAnswersAsTheNetworkDoes) {
  expect_the_networks_answers(6, 5, 11, 4);
}

TEST(OnnxFile, AnEncoderMayBeLeftOut) {
  expect_the_networks_answers(3, 0, 4, 2);
}

TEST(OnnxFile, SaysWhatGoesInAndWhatComesOut) {
  const Model model(onnx_bytes(recurrent_parameters(3, 6, 5, 200, 4), "small"));
  const auto described = [&](int number) {
    std::map<std::string, std::vector<std::int64_t>> found;
    for (const std::string& info : all(model.graph, number)) {
      const std::string tensor = one(one(info, 2), 1);
      EXPECT_EQ(numbers(tensor, 1), std::vector<std::int64_t>{1}) << "float";
      for (const std::string& dimension : all(one(tensor, 2), 1)) {
        const std::vector<std::int64_t> size = numbers(dimension, 1);
        found[one(info, 1)].push_back(size.empty() ? -1 : size[0]);
        EXPECT_EQ(all(dimension, 2), size.empty() ? std::vector<std::string>{"steps"} : std::vector<std::string>{});
      }
    }
    return found;
  };
  using Shapes = std::map<std::string, std::vector<std::int64_t>>;
  EXPECT_EQ(described(11), (Shapes{{"features", {-1, 1, 6}}, {"memory", {1, 1, 200}}}));
  EXPECT_EQ(described(12), (Shapes{{"correction", {-1, 4}}, {"factor", {-1, 10}}, {"memory_after", {1, 1, 200}}}));
  EXPECT_EQ(model.constants.at("gru_input_weight").shape, (std::vector<std::int64_t>{1, 600, 5}));
  EXPECT_EQ(model.constants.at("gru_hidden_weight").shape, (std::vector<std::int64_t>{1, 600, 200}));
  EXPECT_EQ(model.constants.at("gru_bias").shape, (std::vector<std::int64_t>{1, 1200}));
  EXPECT_EQ(model.constants.at("lowest").shape, std::vector<std::int64_t>()) << "Clip wants a number";
}

}  // namespace
}  // namespace truebearing::onnx_file_test
