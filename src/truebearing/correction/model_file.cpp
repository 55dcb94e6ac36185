// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/model_file.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/correction/correction_bounds.hpp"
#include "truebearing/io/json_file.hpp"

namespace truebearing {
namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

constexpr const char* kFormat = "truebearing-correction";
constexpr int kVersion = 2;
constexpr const char* kSigma = "sigma";
constexpr const char* kMoments = "moments";

// One object of the file, read key by key; finish() refuses every key that nobody asked for.
class ObjectReader {
 public:
  ObjectReader(const Json& object, std::string file, std::string path)
      : object_(&object), file_(std::move(file)), path_(std::move(path)) {
    if (!object.is_object()) throw InputError(file_ + (path_.empty() ? "" : ": " + path_), "is no object", "{ ... }");
  }

  const Json& at(const std::string& key) {
    asked_.push_back(key);
    const auto found = object_->find(key);
    if (found == object_->end()) throw error(key, "is missing");
    return *found;
  }

  bool has(const std::string& key) const { return object_->contains(key); }

  std::string text(const std::string& key) {
    const Json& value = at(key);
    if (!value.is_string()) throw error(key, "is no text", "text in quotes");
    return value.get<std::string>();
  }

  double number(const std::string& key) { return finite(at(key), key); }
  /// A limit: null stands for none, infinity.
  double number_or_none(const std::string& key) {
    return at(key).is_null() ? std::numeric_limits<double>::infinity() : number(key);
  }

  Eigen::VectorXd vector(const std::string& key, Eigen::Index size) {
    const Json& value = at(key);
    if (!value.is_array() || value.size() != static_cast<std::size_t>(size))
      throw error(key, value.is_array() ? fmt::format("holds {} values", value.size()) : "is no array",
                  fmt::format("an array of {} numbers", size));
    Eigen::VectorXd numbers(size);
    for (Eigen::Index i = 0; i < size; ++i) numbers[i] = finite(value[static_cast<std::size_t>(i)], key);
    return numbers;
  }

  const Json& array(const std::string& key, std::size_t low, std::size_t high) {
    const Json& value = at(key);
    if (!value.is_array() || value.size() < low || value.size() > high)
      throw error(key, value.is_array() ? fmt::format("holds {} values", value.size()) : "is no array",
                  fmt::format("an array of {} to {}", low, high));
    return value;
  }

  ObjectReader object(const std::string& key) { return {at(key), file_, path_.empty() ? key : path_ + "." + key}; }

  void finish() const {
    for (const auto& [key, value] : object_->items())
      if (std::find(asked_.begin(), asked_.end(), key) == asked_.end())
        throw error(key, "is not a known key", suggestion(key, asked_));
  }

  InputError error(const std::string& key, const std::string& found, const std::string& valid = {}) const {
    return {file_ + ": " + (path_.empty() ? key : path_ + "." + key), found, valid};
  }

 private:
  double finite(const Json& value, const std::string& key) const {
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      throw error(key, "holds " + value.dump().substr(0, 40), "finite numbers");
    return value.get<double>();
  }

  const Json* object_;
  std::string file_;
  std::string path_;
  std::vector<std::string> asked_;
};

FeatureSpec read_feature(ObjectReader object) {
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
  return json;
}

template <typename Derived>
OrderedJson array_json(const Eigen::MatrixBase<Derived>& values) {
  OrderedJson array = OrderedJson::array();
  for (Eigen::Index i = 0; i < values.size(); ++i) array.push_back(values.derived().coeff(i));
  return array;
}

OrderedJson limit_json(double limit) {
  return std::isfinite(limit) ? OrderedJson(limit) : OrderedJson(nullptr);
}

std::vector<std::string> read_texts(ObjectReader& object, const std::string& key, std::size_t high) {
  std::vector<std::string> texts;
  for (const Json& value : object.array(key, 1, high)) {
    if (!value.is_string()) throw object.error(key, "holds " + value.dump().substr(0, 40), "texts");
    texts.push_back(value.get<std::string>());
  }
  return texts;
}

// Version 1 held the bounds that the model was validated with; now its provenance remembers them.
std::string read_first_bounds(ObjectReader& file) {
  CorrectionBounds bounds{file.number_or_none("kappa"), !file.at("gate").is_null(), {}};
  if (file.has("referee")) {
    ObjectReader referee = file.object("referee");
    bounds.referee = RefereeOptions{referee.number("alpha"), referee.number("tolerance"), referee.number("edge")};
    referee.finish();
  }
  return describe(bounds);
}

CorrectionModel model_from(const Json& json, const std::string& name) {
  ObjectReader file(json, name, "");
  if (file.text("format") != kFormat) throw file.error("format", "is not " + std::string(kFormat), kFormat);
  const double version = file.number("version");
  if (version != 1 && version != kVersion)
    throw file.error("version", fmt::format("is {}", version),
                     fmt::format("1 or {}, which this program reads", kVersion));

  CorrectionModel model;
  model.space = &state_space_of_components(read_texts(file, "state", kMaxDimension));
  model.design.base = file.text("base");
  model.design.reference = file.text("reference");
  model.design.covariance_of = file.text("covariance_of");
  ObjectReader trackers = file.object("trackers");
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
  const Json& features = file.array("features", 1, FuzzyNetwork::kMaxInputs);
  for (std::size_t i = 0; i < features.size(); ++i)
    model.design.features.push_back(read_feature(ObjectReader(features[i], name, fmt::format("features[{}]", i))));
  const auto d = static_cast<Eigen::Index>(features.size());
  const auto n = static_cast<Eigen::Index>(model.space->size());

  FuzzyNetwork::Parameters parameters;
  ObjectReader normalisation = file.object("normalisation");
  parameters.input_mean = normalisation.vector("input_mean", d);
  parameters.input_scale = normalisation.vector("input_scale", d);
  parameters.input_clip = normalisation.number("input_clip");
  parameters.output_scale = normalisation.vector("output_scale", n);
  normalisation.finish();

  if (!file.at("gate").is_null()) {
    ObjectReader gate = file.object("gate");
    model.gate = BoxGate{gate.vector("low", d),
                         gate.vector("high", d),
                         gate.number("edge_fraction"),
                         gate.number_or_none("largest_disagreement"),
                         gate.number("disagreement_edge_fraction"),
                         {}};
    if (gate.has("intervals")) {  // not in models of before it was seen
      ObjectReader intervals = gate.object("intervals");
      model.gate->intervals = {intervals.number("low_s"), intervals.number_or_none("high_s"),
                               intervals.number_or_none("longest_coast_s")};
      intervals.finish();
    }
    gate.finish();
  }

  const Json& rules = file.array("rules", 1, FuzzyNetwork::kMaxRules);
  const auto M = static_cast<Eigen::Index>(rules.size());
  parameters.centres.resize(M, d);
  parameters.widths.resize(M, d);
  parameters.consequents.resize(M, n);
  const bool moments = model.design.covariance_moments = file.has("covariance");
  if (moments && file.text("covariance") != kMoments)
    throw file.error("covariance", "is not \"moments\"", "\"moments\", or no such key");
  model.inflation.resize(moments ? 0 : M);
  model.moments.resize(moments ? M : 0, moments ? n * n : 0);
  model.usage.resize(M);
  model.local_mean.resize(M, n);
  for (Eigen::Index j = 0; j < M; ++j) {
    ObjectReader rule(rules[static_cast<std::size_t>(j)], name, fmt::format("rules[{}]", j));
    parameters.centres.row(j) = rule.vector("centre", d).transpose();
    parameters.widths.row(j) = rule.vector("width", d).transpose();
    parameters.consequents.row(j) = rule.vector("consequent", n).transpose();
    if (moments)
      model.moments.row(j) = rule.vector("moments", n * n).transpose();
    else
      model.inflation[j] = rule.number("inflation");
    model.usage[j] = rule.number("usage");
    model.local_mean.row(j) = rule.vector("local_mean", n).transpose();
    rule.finish();
  }

  ObjectReader provenance = file.object("provenance");
  for (const auto& [key, value] : json["provenance"].items()) model.provenance[key] = provenance.text(key);
  if (version == 1) model.provenance["bounds"] = read_first_bounds(file);
  file.finish();
  try {
    model.network = FuzzyNetwork(std::move(parameters));
    model.validate();
  } catch (const InputError& error) {
    throw InputError(name + ": " + error.where(), error.found(), error.valid());
  }
  return model;
}

}  // namespace

CorrectionModel read_model_file(const std::filesystem::path& path) {
  return model_from(read_json_file(path), path.string());
}

CorrectionModel parse_model(std::string_view text, const std::string& name) {
  return model_from(parse_json(text, name), name);
}

std::string model_text(const CorrectionModel& model) {
  const FuzzyNetwork::Parameters& parameters = model.network.parameters();
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
  json["normalisation"] = {{"input_mean", array_json(parameters.input_mean)},
                           {"input_scale", array_json(parameters.input_scale)},
                           {"input_clip", parameters.input_clip},
                           {"output_scale", array_json(parameters.output_scale)}};
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
  json["rules"] = OrderedJson::array();
  for (Eigen::Index j = 0; j < parameters.centres.rows(); ++j) {
    OrderedJson rule{{"centre", array_json(parameters.centres.row(j))},
                     {"width", array_json(parameters.widths.row(j))},
                     {"consequent", array_json(parameters.consequents.row(j))}};
    if (model.design.covariance_moments)
      rule["moments"] = array_json(model.moments.row(j));
    else
      rule["inflation"] = model.inflation[j];
    rule["usage"] = model.usage[j];
    rule["local_mean"] = array_json(model.local_mean.row(j));
    json["rules"].push_back(std::move(rule));
  }
  json["provenance"] = OrderedJson::object();
  for (const auto& [key, value] : model.provenance) json["provenance"][key] = value;
  return json_text(json);
}

}  // namespace truebearing
