// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/model_file.hpp"

#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

#include "truebearing/core/content_hash.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/correction/correction_bounds.hpp"
#include "truebearing/correction/network_file.hpp"
#include "truebearing/io/file.hpp"
#include "truebearing/io/json_file.hpp"
#include "truebearing/io/safetensors.hpp"

namespace truebearing {
namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

constexpr const char* kFormat = "truebearing-correction";
constexpr int kVersion = 2;
constexpr const char* kSigma = "sigma";
constexpr const char* kMoments = "moments";
constexpr const char* kWeightsEnding = ".safetensors";

FeatureSpec read_feature(JsonObject object) {
  FeatureSpec feature;
  const std::string kind = object.text("kind");
  try {
    feature.kind = feature_kind(kind);
  } catch (const InputError& error) {
    throw object.error("kind", error.found(), error.valid());
  }
  const FeatureNeeds needs = needs_of(feature.kind);
  if (needs.component == FeatureNeeds::Component::required ||
      (needs.component == FeatureNeeds::Component::optional && object.has("component")))
    feature.component = object.text("component");
  if (needs.companion == FeatureNeeds::Companion::required ||
      (needs.companion == FeatureNeeds::Companion::optional && object.has("companion")))
    feature.companion = object.text("companion");
  if (needs.alpha) feature.alpha = object.number("alpha");
  if (needs.offset) feature.offset = object.number("offset");
  if (needs.scale && object.at("scale").is_string()) {
    if (object.text("scale") != kSigma) throw object.error("scale", "is no number", "a number, or \"sigma\"");
    feature.scale_is_sigma = true;
  } else if (needs.scale) {
    feature.scale = object.number("scale");
  }
  if (needs.mode) {
    const double mode = object.number("mode");
    if (!(mode >= 1.0 && mode <= kMaxModes && mode == std::floor(mode)))
      throw object.error("mode", fmt::format("is {}", mode), fmt::format("1 to {}", kMaxModes));
    feature.mode = static_cast<int>(mode);
  }
  if (needs.sensor) {
    const double sensor = object.number("sensor");
    if (!(sensor >= 1.0 && sensor <= kMostSensors && sensor == std::floor(sensor)))
      throw object.error("sensor", fmt::format("is {}", sensor), fmt::format("1 to {}", kMostSensors));
    feature.sensor = static_cast<int>(sensor);
  }
  object.finish();
  return feature;
}

OrderedJson feature_json(const FeatureSpec& feature) {
  const FeatureNeeds needs = needs_of(feature.kind);
  OrderedJson json{{"kind", std::string(to_string(feature.kind))}};
  if (!feature.component.empty()) json["component"] = feature.component;
  if (!feature.companion.empty()) json["companion"] = feature.companion;
  if (needs.alpha) json["alpha"] = feature.alpha;
  if (needs.offset) json["offset"] = feature.offset;
  if (needs.scale) json["scale"] = feature.scale_is_sigma ? OrderedJson(kSigma) : OrderedJson(feature.scale);
  if (needs.mode) json["mode"] = feature.mode;
  if (needs.sensor) json["sensor"] = feature.sensor;
  return json;
}

OrderedJson normalisation_json(const auto& parameters) {
  return {{"input_mean", array_json(parameters.input_mean)},
          {"input_scale", array_json(parameters.input_scale)},
          {"input_clip", parameters.input_clip},
          {"output_scale", array_json(parameters.output_scale)}};
}

OrderedJson limit_json(double limit) {
  return std::isfinite(limit) ? OrderedJson(limit) : OrderedJson(nullptr);
}

// Version 1 held the bounds that the model was validated with; now its provenance remembers them.
std::string read_first_bounds(JsonObject& file) {
  CorrectionBounds bounds{file.number_or_none("kappa"), !file.at("gate").is_null(), {}};
  if (file.has("referee")) {
    JsonObject referee = file.object("referee");
    bounds.referee = RefereeOptions{referee.number("alpha"), referee.number("tolerance"), referee.number("edge")};
    referee.finish();
  }
  return describe(bounds);
}

CorrectionModel model_from(const Json& json, const std::string& name, const ReadBeside& read) {
  JsonObject file(json, name, "");
  if (file.text("format") != kFormat) throw file.error("format", "is not " + std::string(kFormat), kFormat);
  const double version = file.number("version");
  if (version != 1 && version != kVersion)
    throw file.error("version", fmt::format("is {}", version),
                     fmt::format("1 or {}, which this program reads", kVersion));

  CorrectionModel model;
  model.space = &state_space_of_components(file.texts("state", kMaxDimension));
  model.design.base = file.text("base");
  model.design.reference = file.text("reference");
  model.design.covariance_of = file.text("covariance_of");
  JsonObject trackers = file.object("trackers");
  for (const auto& [key, value] : json["trackers"].items()) model.trackers[key] = trackers.text(key);

  if (file.has("frame")) {
    const std::string frame = file.text("frame");
    model.design.frame = frame_of(frame);
    if (frame != to_string(model.design.frame))
      throw file.error("frame", "is \"" + frame + "\"", suggestion(frame, frame_names()));
  }
  if (file.has("output_in")) {
    if (file.text("output_in") != kSigma)
      throw file.error("output_in", "is not \"sigma\"", "\"sigma\", or no such key");
    model.design.output_in_sigma = true;
  }
  const Json& features = file.array("features", 1, kMaxFeatures);
  for (std::size_t i = 0; i < features.size(); ++i)
    model.design.features.push_back(read_feature(JsonObject(features[i], name, fmt::format("features[{}]", i))));
  const auto d = static_cast<Eigen::Index>(features.size());
  if (file.has("network")) {
    const std::string kind = file.text("network");
    if (kind != to_string(NetworkKind::recurrent))
      throw file.error("network", "is \"" + kind + "\"", "\"gru\", or no such key");
    model.design.network = NetworkKind::recurrent;
  }
  model.design.covariance_moments = file.has("covariance");
  if (model.design.covariance_moments && file.text("covariance") != kMoments)
    throw file.error("covariance", "is not \"moments\"", "\"moments\", or no such key");
  const Eigen::Index n = model.space->size();
  if (model.design.network == NetworkKind::rules)
    model.network = read_rule_base(file, model.design, n);
  else
    model.network = read_gated_recurrent(file, model.design, n, read);

  if (!file.at("gate").is_null()) {
    JsonObject gate = file.object("gate");
    model.gate = BoxGate{gate.vector("low", d),
                         gate.vector("high", d),
                         gate.number("edge_fraction"),
                         gate.number_or_none("largest_disagreement"),
                         gate.number("disagreement_edge_fraction"),
                         {}};
    if (gate.has("intervals")) {  // not in models of before it was seen
      JsonObject intervals = gate.object("intervals");
      model.gate->intervals = {intervals.number("low_s"), intervals.number_or_none("high_s"),
                               intervals.number_or_none("longest_coast_s")};
      intervals.finish();
    }
    gate.finish();
  }

  JsonObject provenance = file.object("provenance");
  for (const auto& [key, value] : json["provenance"].items()) model.provenance[key] = provenance.text(key);
  if (version == 1) model.provenance["bounds"] = read_first_bounds(file);
  file.finish();
  try {
    model.validate();
  } catch (const InputError& error) {
    throw InputError(name + ": " + error.where(), error.found(), error.valid());
  }
  return model;
}

}  // namespace

CorrectionModel read_model_file(const std::filesystem::path& path) {
  return model_from(read_json_file(path), path.string(), [&](const std::string& name) {
    return read_text_file(path.parent_path() / name, TensorLimits{}.max_bytes);
  });
}

CorrectionModel parse_model(std::string_view text, const std::string& name) {
  return model_from(parse_json(text, name), name, [&](const std::string& weights) -> std::string {
    throw InputError(name, "names the file " + weights + ", and stands in no folder", "a model file");
  });
}

CorrectionModel parse_model(std::string_view text, const std::string& weights, const std::string& name) {
  return model_from(parse_json(text, name), name, [&](const std::string&) { return weights; });
}

std::string weights_text(const CorrectionModel& model) {
  const auto* network = std::get_if<GatedRecurrent>(&model.network);
  return network ? gated_recurrent_weights(*network) : std::string();
}

std::string weights_name(const CorrectionModel& model) {
  if (!std::holds_alternative<GatedRecurrent>(model.network)) return {};
  ContentHash hash;
  for (const char byte : weights_text(model)) hash.take(static_cast<unsigned char>(byte));
  const auto said = [&](const char* key, const char* otherwise) {
    const auto found = model.provenance.find(key);
    return found == model.provenance.end() ? std::string(otherwise) : found->second;
  };
  return fmt::format("{}.{}.{:08x}{}", said("study", "model"), said("tracker", "gru"), hash.value() >> 32,
                     kWeightsEnding);
}

void write_model_file(const std::filesystem::path& path, const CorrectionModel& model) {
  const std::string weights = weights_name(model);
  const std::filesystem::path folder = path.parent_path();
  std::string before;
  try {
    before = parse_json(read_text_file(path, JsonLimits{}.max_bytes), path.string()).value("weights", "");
  } catch (const std::exception&) {  // whatever it was, it is replaced
  }
  if (!weights.empty()) write_file_atomically(folder / weights, weights_text(model));
  write_file_atomically(path, model_text(model));
  std::error_code ignored;
  const bool ours = before.ends_with(kWeightsEnding) && before.find('/') == std::string::npos;
  if (ours && before != weights) std::filesystem::remove(folder / before, ignored);
}

std::string model_text(const CorrectionModel& model) {
  OrderedJson json;
  json["format"] = kFormat;
  json["version"] = kVersion;
  json["state"] = model.space->components;
  json["base"] = model.design.base;
  json["reference"] = model.design.reference;
  json["covariance_of"] = model.design.covariance_of;
  json["trackers"] = OrderedJson::object();
  for (const auto& [name, configuration] : model.trackers) json["trackers"][name] = configuration;
  if (model.design.frame != Frame::state) json["frame"] = std::string(to_string(model.design.frame));
  if (model.design.output_in_sigma) json["output_in"] = kSigma;
  json["features"] = OrderedJson::array();
  for (const FeatureSpec& feature : model.design.features) json["features"].push_back(feature_json(feature));
  std::visit([&](const auto& kind) { json["normalisation"] = normalisation_json(kind.parameters()); }, model.network);
  json["gate"] = nullptr;
  if (model.gate)
    json["gate"] = {{"low", array_json(model.gate->low)},
                    {"high", array_json(model.gate->high)},
                    {"edge_fraction", model.gate->edge_fraction},
                    {"largest_disagreement", limit_json(model.gate->largest_disagreement)},
                    {"disagreement_edge_fraction", model.gate->disagreement_edge_fraction}};
  if (model.gate && model.gate->intervals != IntervalBox{})
    json["gate"]["intervals"] = {{"low_s", model.gate->intervals.low_s},
                                 {"high_s", limit_json(model.gate->intervals.high_s)},
                                 {"longest_coast_s", limit_json(model.gate->intervals.longest_coast_s)}};
  if (model.design.covariance_moments) json["covariance"] = kMoments;
  if (const auto* rules = std::get_if<RuleBase>(&model.network)) {
    write_rule_base(*rules, model.design, json);
  } else {
    json["network"] = std::string(to_string(model.design.network));
    write_gated_recurrent(std::get<GatedRecurrent>(model.network), weights_name(model), json);
  }
  json["provenance"] = OrderedJson::object();
  for (const auto& [key, value] : model.provenance) json["provenance"][key] = value;
  return json_text(json);
}

}  // namespace truebearing
