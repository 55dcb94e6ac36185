#include "truebearing/study/correction_spec.hpp"

#include <algorithm>

namespace truebearing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

FeatureSpec read_feature(TableReader& table) {
  FeatureSpec feature;
  feature.kind = feature_kind(table.choice("kind", feature_kind_names()));
  const FeatureNeeds needs = needs_of(feature.kind);
  if (needs.component) feature.component = table.text("component");
  if (needs.companion == FeatureNeeds::Companion::required) feature.companion = table.text("companion");
  if (needs.companion == FeatureNeeds::Companion::optional) feature.companion = table.text_or("companion", "");
  if (needs.alpha) feature.alpha = table.number("alpha", {0.0, 1.0, true});
  if (needs.offset) feature.offset = table.number("offset", kPositive);
  if (needs.scale) feature.scale = table.number("scale", kPositive);
  table.finish();
  return feature;
}

TrainingSpec read_training(TableReader& table) {
  TrainingSpec training;
  const std::string method =
      table.choice_or("method", {"variable_projection", "back_propagation"}, "variable_projection");
  training.runs = static_cast<std::size_t>(table.integer("runs", 1, 1000000));
  training.from_step = static_cast<int>(table.integer_or("from_step", 1, 1, 1000000));
  training.mirror = table.boolean_or("mirror", false);
  training.learning_rate = table.number_or("learning_rate", 0.05, {0.0, 1.0, true});
  if (method == "variable_projection") {
    training.rules = static_cast<int>(table.integer("rules", 1, 256));
    training.iterations = static_cast<int>(table.integer_or("iterations", training.iterations, 0, 100000));
    training.ridge = table.number_or("ridge", training.ridge, kPositive);
  } else {
    training.method = TrainingSpec::Method::back_propagation;
    training.terms_per_input = static_cast<int>(table.integer_or("terms_per_input", training.terms_per_input, 2, 9));
    training.epochs = static_cast<int>(table.integer_or("epochs", training.epochs, 1, 1000000));
    training.momentum = table.number_or("momentum", 0.0, {0.0, 0.999});
  }
  table.finish();
  return training;
}

// gate = true, false, or { quantile, edge_fraction, disagreement_quantile, disagreement_edge_fraction }.
std::optional<GateSpec> read_gate(TableReader& table) {
  GateSpec gate;
  const toml::node* node = table.node("gate");
  if (!node || node->is_boolean()) return table.boolean_or("gate", true) ? std::optional<GateSpec>(gate) : std::nullopt;
  TableReader sub = table.table("gate");
  gate.quantile = sub.number_or("quantile", gate.quantile, {0.0, 0.25});
  gate.edge_fraction = sub.number_or("edge_fraction", gate.edge_fraction, {0.0, 10.0, true});
  gate.disagreement_quantile = sub.number_or("disagreement_quantile", gate.disagreement_quantile, {0.0, 0.5});
  gate.disagreement_edge_fraction =
      sub.number_or("disagreement_edge_fraction", gate.disagreement_edge_fraction, {0.0, 10.0, true});
  sub.finish();
  return gate;
}

}  // namespace

std::vector<std::string> CorrectionSpec::members() const {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  add(base);
  add(reference);
  add(covariance_of);
  for (const FeatureSpec& feature : features) add(feature.companion);
  return names;
}

CorrectionSpec read_correction_spec(TableReader& table) {
  CorrectionSpec spec;
  spec.base = table.text("base");
  spec.reference = table.text_or("reference", spec.base);
  spec.covariance_of = table.text_or("covariance_of", spec.base);
  spec.kappa = table.number_or("kappa", kInfinity, kPositive);
  spec.gate = read_gate(table);
  spec.model = table.resolve(table.text("model"));
  for (TableReader& feature : table.tables("features")) spec.features.push_back(read_feature(feature));
  if (spec.features.empty())
    throw table.error("features", "is missing or empty", "an array of tables with a `kind` each");
  TableReader training = table.table("training");
  spec.training = read_training(training);
  return spec;
}

}  // namespace truebearing
