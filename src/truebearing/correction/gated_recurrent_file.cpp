// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <utility>
#include <vector>

#include "truebearing/correction/network_file.hpp"
#include "truebearing/io/safetensors.hpp"

namespace truebearing {
namespace {

constexpr int kExamples = 4;
constexpr double kTolerance = 1e-4;  // of the outputs' scale

// The arrays of the file by their names there. `visit(name, array)`; `array` is a vector or a matrix.
void for_each_array(auto& parameters, const auto& visit) {
  if (parameters.encoder_weight.size() > 0) {
    visit("encoder.weight", parameters.encoder_weight);
    visit("encoder.bias", parameters.encoder_bias);
  }
  visit("gru.weight_ih_l0", parameters.weight_ih);
  visit("gru.weight_hh_l0", parameters.weight_hh);
  visit("gru.bias_ih_l0", parameters.bias_ih);
  visit("gru.bias_hh_l0", parameters.bias_hh);
  visit("output.weight", parameters.output_weight);
  visit("output.bias", parameters.output_bias);
  visit("covariance.weight", parameters.covariance_weight);
  visit("covariance.bias", parameters.covariance_bias);
}

// What the network answers to these rows of inputs (d) of one track.
std::vector<BoundedVector> outputs(const GatedRecurrent& network, const std::vector<NetworkInputs>& inputs) {
  NetworkMemory h = NetworkMemory::Zero(network.memory());
  NetworkAnswer answer;
  std::vector<BoundedVector> outputs;
  for (const NetworkInputs& row : inputs) {
    network.answer(row, h, answer);
    outputs.push_back(answer.y);
  }
  return outputs;
}

// Weights that are another network's than the file's are found out by what they answer.
void check_examples(JsonObject& file, const GatedRecurrent& network) {
  JsonObject examples = file.object("examples");
  const nlohmann::json& rows = examples.array("inputs", 1, 1000);
  const nlohmann::json& answers = examples.array("outputs", rows.size(), rows.size());
  std::vector<NetworkInputs> inputs;
  std::vector<BoundedVector> wanted;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const nlohmann::json row{{"inputs", rows[k]}, {"outputs", answers[k]}};
    JsonObject example(row, file.file(), fmt::format("examples[{}]", k));
    inputs.emplace_back(example.vector("inputs", network.inputs()));
    wanted.emplace_back(example.vector("outputs", network.outputs()));
  }
  examples.finish();
  const std::vector<BoundedVector> found = outputs(network, inputs);
  for (std::size_t k = 0; k < found.size(); ++k)
    for (Eigen::Index i = 0; i < found[k].size(); ++i)
      if (!(std::abs(found[k][i] - wanted[k][i]) <= kTolerance * network.parameters().output_scale[i]))
        throw file.error(fmt::format("examples[{}]", k),
                         fmt::format("says {:.6g}, the weights answer {:.6g}", wanted[k][i], found[k][i]),
                         "the weights that belong to this file");
}

}  // namespace

GatedRecurrent read_gated_recurrent(JsonObject& file, const CorrectionDesign& design, Eigen::Index n,
                                    const ReadBeside& read) {
  const auto d = static_cast<Eigen::Index>(design.features.size());
  GatedRecurrent::Parameters parameters;
  read_normalisation(file, d, n, parameters);
  const std::string weights = file.text("weights");
  if (weights.empty() || weights.front() == '.' || weights.find_first_of("/\\") != std::string::npos)
    throw file.error("weights", "is \"" + weights + "\"", "the name of a file in the same folder");
  const std::string where = file.file() + ": " + weights;
  Tensors tensors = parse_safetensors(read(weights), where);
  if (tensors.contains("encoder.weight")) parameters.encoder_weight.resize(1, 1);  // so that it is asked for
  std::size_t used = 0;
  for_each_array(parameters, [&](const char* name, auto& array) {
    const auto found = tensors.find(name);
    if (found == tensors.end()) throw InputError(where, fmt::format("holds no {}", name));
    if (found->second.vector != (std::decay_t<decltype(array)>::ColsAtCompileTime == 1))
      throw InputError(where + ": " + name, "has another number of dimensions");
    array = std::move(found->second.values);
    ++used;
  });
  if (used != tensors.size())
    for (const auto& tensor : tensors) {
      bool known = false;
      for_each_array(parameters, [&](const char* key, const auto&) { known = known || tensor.first == key; });
      if (!known) throw InputError(where, fmt::format("holds {}, which this network has not", tensor.first));
    }
  try {
    GatedRecurrent network(std::move(parameters));
    check_examples(file, network);
    return network;
  } catch (const InputError& error) {
    if (error.where().starts_with(file.file())) throw;
    throw InputError(where + ": " + error.where(), error.found(), error.valid());
  }
}

void write_gated_recurrent(const GatedRecurrent& network, const std::string& weights, nlohmann::ordered_json& json) {
  const GatedRecurrent::Parameters& parameters = network.parameters();
  json["weights"] = weights;
  std::vector<NetworkInputs> inputs;
  for (int k = 0; k < kExamples; ++k) {
    NetworkInputs row(network.inputs());
    for (int i = 0; i < network.inputs(); ++i)
      row[i] = parameters.input_mean[i] + 0.5 * ((7 * i + 3 * k) % 5 - 2) * parameters.input_scale[i];
    inputs.push_back(row);
  }
  nlohmann::ordered_json rows = nlohmann::ordered_json::array(), answers = nlohmann::ordered_json::array();
  for (const NetworkInputs& row : inputs) rows.push_back(array_json(row));
  for (const BoundedVector& y : outputs(network, inputs)) answers.push_back(array_json(y));
  json["examples"] = {{"inputs", rows}, {"outputs", answers}};
}

std::string gated_recurrent_weights(const GatedRecurrent& network) {
  Tensors tensors;
  for_each_array(network.parameters(), [&](const char* name, const auto& array) {
    tensors[name] = {array, std::decay_t<decltype(array)>::ColsAtCompileTime == 1};
  });
  return safetensors_bytes(tensors);
}

}  // namespace truebearing
