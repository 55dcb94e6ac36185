// SPDX-License-Identifier: Apache-2.0
// What each kind of network reads and writes of a model file, beside the keys that all have (model_file.cpp).
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "truebearing/correction/network.hpp"
#include "truebearing/io/json_object.hpp"

namespace truebearing {

/// The bytes of a file that stands beside the model file, by its name.
using ReadBeside = std::function<std::string(const std::string& name)>;

/// `n`: components of the state. Throws InputError that names file and key.
RuleBase read_rule_base(JsonObject& file, const CorrectionDesign& design, Eigen::Index n);
void write_rule_base(const RuleBase& network, const CorrectionDesign& design, nlohmann::ordered_json& json);

GatedRecurrent read_gated_recurrent(JsonObject& file, const CorrectionDesign& design, Eigen::Index n,
                                    const ReadBeside& read);
/// `weights`: the name of the file with gated_recurrent_weights().
void write_gated_recurrent(const GatedRecurrent& network, const std::string& weights, nlohmann::ordered_json& json);
/// Its bytes, safetensors: encoder, gru, output and covariance with the names that PyTorch gives to the parameters of
/// nn.Linear and nn.GRU.
std::string gated_recurrent_weights(const GatedRecurrent& network);

/// Of inputs (d) and outputs (n), which both kinds have.
void read_normalisation(JsonObject& file, Eigen::Index d, Eigen::Index n, auto& parameters) {
  JsonObject normalisation = file.object("normalisation");
  parameters.input_mean = normalisation.vector("input_mean", d);
  parameters.input_scale = normalisation.vector("input_scale", d);
  parameters.input_clip = normalisation.number("input_clip");
  parameters.output_scale = normalisation.vector("output_scale", n);
  normalisation.finish();
}

}  // namespace truebearing
