// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/learned_motion_file.hpp"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <utility>

#include "truebearing/core/error.hpp"
#include "truebearing/correction/network_file.hpp"
#include "truebearing/io/json_file.hpp"

namespace truebearing {
namespace {

constexpr const char* kMotionFormat = "truebearing-motion";
constexpr int kMotionVersion = 1;

MotionResidual residual_from(const nlohmann::json& json, const std::string& name) {
  JsonObject file(json, name, "");
  if (file.text("format") != kMotionFormat)
    throw file.error("format", "is not " + std::string(kMotionFormat), kMotionFormat);
  if (const double version = file.number("version"); version != kMotionVersion)
    throw file.error("version", fmt::format("is {}", version),
                     fmt::format("{}, which this program reads", kMotionVersion));
  MotionResidual residual;
  residual.period_s = file.number("period_s");
  if (!(residual.period_s > 0.0)) throw file.error("period_s", fmt::format("is {}", residual.period_s), "a number > 0");
  const double states = file.number("states");
  if (!(states >= 1.0 && states <= kMaxDimension && states == std::floor(states)))
    throw file.error("states", fmt::format("is {}", states), fmt::format("1 to {}", kMaxDimension));
  const auto n = static_cast<Eigen::Index>(states);
  FuzzyNetwork::Parameters parameters;
  read_normalisation(file, n, n, parameters);
  const nlohmann::json& rules = file.array("rules", 1, FuzzyNetwork::kMaxRules);
  const auto M = static_cast<Eigen::Index>(rules.size());
  parameters.centres.resize(M, n);
  parameters.widths.resize(M, n);
  parameters.consequents.resize(M, n);
  for (Eigen::Index j = 0; j < M; ++j) {
    JsonObject rule(rules[static_cast<std::size_t>(j)], file.file(), fmt::format("rules[{}]", j));
    parameters.centres.row(j) = rule.vector("centre", n).transpose();
    parameters.widths.row(j) = rule.vector("width", n).transpose();
    parameters.consequents.row(j) = rule.vector("consequent", n).transpose();
    rule.finish();
  }
  JsonObject provenance = file.object("provenance");
  for (const auto& [key, value] : json["provenance"].items()) residual.provenance[key] = provenance.text(key);
  file.finish();
  try {
    residual.network = FuzzyNetwork(std::move(parameters));
  } catch (const InputError& error) {
    throw InputError(name + ": " + error.where(), error.found(), error.valid());
  }
  return residual;
}

}  // namespace

MotionResidual read_learned_motion_file(const std::filesystem::path& path) {
  return residual_from(read_json_file(path), path.string());
}

MotionResidual parse_learned_motion(std::string_view text, const std::string& name) {
  return residual_from(parse_json(text, name), name);
}

std::string learned_motion_text(const MotionResidual& residual) {
  const FuzzyNetwork::Parameters& parameters = residual.network.parameters();
  nlohmann::ordered_json json;
  json["format"] = kMotionFormat;
  json["version"] = kMotionVersion;
  json["states"] = residual.network.inputs();
  json["period_s"] = residual.period_s;
  json["normalisation"] = {{"input_mean", array_json(parameters.input_mean)},
                           {"input_scale", array_json(parameters.input_scale)},
                           {"input_clip", parameters.input_clip},
                           {"output_scale", array_json(parameters.output_scale)}};
  json["rules"] = nlohmann::ordered_json::array();
  for (Eigen::Index j = 0; j < parameters.centres.rows(); ++j)
    json["rules"].push_back({{"centre", array_json(parameters.centres.row(j))},
                             {"width", array_json(parameters.widths.row(j))},
                             {"consequent", array_json(parameters.consequents.row(j))}});
  json["provenance"] = nlohmann::ordered_json::object();
  for (const auto& [key, value] : residual.provenance) json["provenance"][key] = value;
  return json_text(json);
}

}  // namespace truebearing
