// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/onnx_file.hpp"

#include <bit>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace truebearing {
namespace {

// A message of protocol buffers. Numbers of fields are those of onnx.proto3.
class Message {
 public:
  Message& number(int field, std::int64_t value) {
    varint(static_cast<std::uint64_t>(field) << 3);
    varint(static_cast<std::uint64_t>(value));
    return *this;
  }
  Message& bytes(int field, std::string_view value) {
    varint(static_cast<std::uint64_t>(field) << 3 | 2);
    varint(value.size());
    bytes_ += value;
    return *this;
  }
  Message& message(int field, const Message& value) { return bytes(field, value.bytes_); }
  const std::string& text() const { return bytes_; }

 private:
  void varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_ += static_cast<char>((value & 0x7f) | 0x80);
    bytes_ += static_cast<char>(value);
  }

  std::string bytes_;
};

constexpr int kFloat = 1, kInt64 = 7;       // TensorProto.DataType
constexpr int kIntegerAttribute = 2;        // AttributeProto.AttributeType
constexpr int kIrVersion = 7, kOpset = 13;  // of ONNX 1.8

void append_little_endian(std::uint64_t value, int size, std::string& bytes) {
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
}

Message tensor(const std::string& name, const std::vector<std::int64_t>& shape, int type, const std::string& raw) {
  Message made;
  for (const std::int64_t size : shape) made.number(1, size);
  return made.number(2, type).bytes(8, name).bytes(9, raw);
}

// A dimension below zero is "steps", whatever their number.
Message value_info(const std::string& name, const std::vector<std::int64_t>& shape) {
  Message dimensions;
  for (const std::int64_t size : shape)
    dimensions.message(1, size < 0 ? Message().bytes(2, "steps") : Message().number(1, size));
  return Message().bytes(1, name).message(2, Message().message(1, Message().number(1, kFloat).message(2, dimensions)));
}

class Graph {
 public:
  void constant(const std::string& name, const std::vector<std::int64_t>& shape, const Eigen::MatrixXf& by_rows) {
    std::string raw;
    for (Eigen::Index i = 0; i < by_rows.rows(); ++i)
      for (Eigen::Index j = 0; j < by_rows.cols(); ++j)
        append_little_endian(std::bit_cast<std::uint32_t>(by_rows(i, j)), 4, raw);
    graph_.message(5, tensor(name, shape, kFloat, raw));
  }
  void constant(const std::string& name, const std::vector<std::int64_t>& values) {
    std::string raw;
    for (const std::int64_t value : values) append_little_endian(static_cast<std::uint64_t>(value), 8, raw);
    graph_.message(5, tensor(name, {static_cast<std::int64_t>(values.size())}, kInt64, raw));
  }
  void node(const std::string& operation, const std::vector<std::string>& inputs,
            const std::vector<std::string>& outputs,
            const std::vector<std::pair<std::string, std::int64_t>>& attributes = {}) {
    Message made;
    for (const std::string& input : inputs) made.bytes(1, input);
    for (const std::string& output : outputs) made.bytes(2, output);
    made.bytes(3, outputs.front() + "_node").bytes(4, operation);
    for (const auto& [name, value] : attributes)
      made.message(5, Message().bytes(1, name).number(3, value).number(20, kIntegerAttribute));
    graph_.message(1, made);
  }
  void input(const std::string& name, const std::vector<std::int64_t>& shape) {
    graph_.message(11, value_info(name, shape));
  }
  void output(const std::string& name, const std::vector<std::int64_t>& shape) {
    graph_.message(12, value_info(name, shape));
  }
  std::string model(const std::string& name) {
    graph_.bytes(2, name);
    return Message()
        .number(1, kIrVersion)
        .bytes(2, "truebearing")
        .message(7, graph_)
        .message(8, Message().bytes(1, "").number(2, kOpset))
        .text();
  }

 private:
  Message graph_;
};

// From PyTorch's order of gates (r, z, n) to that of ONNX (z, r, n).
Eigen::MatrixXf reordered(const Eigen::MatrixXf& gates) {
  const Eigen::Index H = gates.rows() / 3;
  Eigen::MatrixXf other = gates;
  other.topRows(H) = gates.middleRows(H, H);
  other.middleRows(H, H) = gates.topRows(H);
  return other;
}

}  // namespace

std::string onnx_bytes(const GatedRecurrent::Parameters& p, const std::string& name) {
  const auto d = p.input_mean.size(), n = p.output_scale.size(), H = p.weight_hh.cols(), e = p.weight_ih.cols(),
             entries = p.covariance_bias.size();
  Graph graph;
  graph.input("features", {-1, 1, d});
  graph.input("memory", {1, 1, H});
  graph.output("correction", {-1, n});
  graph.output("factor", {-1, entries});
  graph.output("memory_after", {1, 1, H});

  graph.constant("mean", {d}, p.input_mean.cast<float>());
  graph.constant("scale", {d}, p.input_scale.cast<float>());
  graph.constant("lowest", {}, Eigen::MatrixXf::Constant(1, 1, -static_cast<float>(p.input_clip)));
  graph.constant("highest", {}, Eigen::MatrixXf::Constant(1, 1, static_cast<float>(p.input_clip)));
  graph.node("Sub", {"features", "mean"}, {"centred"});
  graph.node("Div", {"centred", "scale"}, {"scaled"});
  graph.node("Clip", {"scaled", "lowest", "highest"}, {"clipped"});
  std::string encoded = "clipped";
  if (p.encoder_weight.size() > 0) {
    graph.constant("encoder_weight", {d, e}, p.encoder_weight.transpose());
    graph.constant("encoder_bias", {e}, p.encoder_bias);
    graph.node("MatMul", {"clipped", "encoder_weight"}, {"weighted"});
    graph.node("Add", {"weighted", "encoder_bias"}, {"shifted"});
    graph.node("Tanh", {"shifted"}, {"encoded"});
    encoded = "encoded";
  }
  Eigen::MatrixXf biases(6 * H, 1);
  biases << reordered(p.bias_ih), reordered(p.bias_hh);
  graph.constant("gru_input_weight", {1, 3 * H, e}, reordered(p.weight_ih));
  graph.constant("gru_hidden_weight", {1, 3 * H, H}, reordered(p.weight_hh));
  graph.constant("gru_bias", {1, 6 * H}, biases);
  graph.node("GRU", {encoded, "gru_input_weight", "gru_hidden_weight", "gru_bias", "", "memory"},
             {"states", "memory_after"}, {{"hidden_size", H}, {"linear_before_reset", 1}});
  graph.constant("by_steps", {-1, H});
  graph.node("Reshape", {"states", "by_steps"}, {"hidden"});
  graph.constant("output_weight", {H, n}, p.output_weight.transpose());
  graph.constant("output_bias", {n}, p.output_bias);
  graph.constant("output_scale", {n}, p.output_scale.cast<float>());
  graph.node("MatMul", {"hidden", "output_weight"}, {"output_weighted"});
  graph.node("Add", {"output_weighted", "output_bias"}, {"output"});
  graph.node("Mul", {"output", "output_scale"}, {"correction"});
  graph.constant("covariance_weight", {H, entries}, p.covariance_weight.transpose());
  graph.constant("covariance_bias", {entries}, p.covariance_bias);
  graph.node("MatMul", {"hidden", "covariance_weight"}, {"covariance_weighted"});
  graph.node("Add", {"covariance_weighted", "covariance_bias"}, {"factor"});
  return graph.model(name);
}

}  // namespace truebearing
