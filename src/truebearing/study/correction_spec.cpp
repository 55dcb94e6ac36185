// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/correction_spec.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <toml++/toml.h>

#include "truebearing/core/constants.hpp"
#include "truebearing/correction/gated_recurrent.hpp"

namespace truebearing {
namespace {

FeatureSpec read_feature(TableReader& table) {
  FeatureSpec feature;
  feature.kind = feature_kind(table.choice("kind", feature_kind_names()));
  const FeatureNeeds needs = needs_of(feature.kind);
  if (needs.component == FeatureNeeds::Component::required) feature.component = table.text("component");
  if (needs.component == FeatureNeeds::Component::optional) feature.component = table.text_or("component", "");
  if (needs.companion == FeatureNeeds::Companion::required) feature.companion = table.text("companion");
  if (needs.companion == FeatureNeeds::Companion::optional) feature.companion = table.text_or("companion", "");
  if (needs.alpha) feature.alpha = table.number("alpha", {0.0, 1.0, true});
  if (needs.offset) feature.offset = table.number("offset", kPositive);
  if (const toml::node* scale = needs.scale ? table.node("scale") : nullptr; scale && scale->is_string())
    feature.scale_is_sigma = table.choice("scale", {"sigma"}) == "sigma";
  else if (needs.scale)
    feature.scale = table.number("scale", kPositive);
  if (needs.mode) feature.mode = static_cast<int>(table.integer("mode", 1, kMaxModes));
  if (needs.sensor) feature.sensor = static_cast<int>(table.integer("sensor", 1, kMostSensors));
  table.finish();
  return feature;
}

// mirror = true (images), false, or "pairs".
TrainingSpec::Mirror read_mirror(TableReader& table) {
  const toml::node* node = table.node("mirror");
  if (node && node->is_string()) {
    table.choice("mirror", {"pairs"});
    return TrainingSpec::Mirror::pairs;
  }
  return table.boolean_or("mirror", false) ? TrainingSpec::Mirror::images : TrainingSpec::Mirror::none;
}

// kappa = a number, or inf for no limit.
double read_kappa(TableReader& table) {
  const toml::node* node = table.node("kappa");
  if (node && node->value<double>() == kInfinity) return kInfinity;
  return table.number_or("kappa", CorrectionBounds{}.kappa, kPositive);
}

// referee = true, false, or { alpha, tolerance, edge }.
std::optional<RefereeOptions> read_referee(TableReader& table) {
  RefereeOptions referee;
  const toml::node* node = table.node("referee");
  if (!node || node->is_boolean())
    return table.boolean_or("referee", false) ? std::optional<RefereeOptions>(referee) : std::nullopt;
  TableReader sub = table.table("referee");
  referee.alpha = sub.number_or("alpha", referee.alpha, {0.0, 1.0, true});
  referee.tolerance = sub.number_or("tolerance", referee.tolerance, kPositive);
  referee.edge = sub.number_or("edge", referee.edge, kPositive);
  sub.finish();
  return referee;
}

TrainingSpec read_training(TableReader& table, NetworkKind network) {
  TrainingSpec training;
  const bool recurrent = network == NetworkKind::recurrent;
  const std::string method =
      recurrent ? "" : table.choice_or("method", {"variable_projection", "back_propagation"}, "variable_projection");
  training.runs = static_cast<std::size_t>(table.integer("runs", 1, 1000000));
  training.teacher = table.text_or("teacher", "");
  training.from_step = static_cast<int>(table.integer_or("from_step", 1, 1, 1000000));
  training.every_s = table.number_or("every_s", 0.0, kNonNegative);
  if (auto limits = table.table_if_present("leave_out_beyond")) {
    for (const std::string& quantity : limits->keys())
      training.leave_out_beyond.emplace_back(quantity, limits->number(quantity, kPositive));
    limits->finish();
    if (!training.teacher.empty())
      throw table.error("leave_out_beyond", "is of errors against the truth, which `teacher` stands for",
                        "one of the two");
  }
  training.mirror = read_mirror(table);
  if (table.has("scenario")) training.scenario = read_changed_scenario(table, "scenario");
  if (table.has("covariance_scenario"))
    training.covariance_scenario = read_changed_scenario(table, "covariance_scenario");
  training.learning_rate = table.number_or("learning_rate", recurrent ? 0.004 : 0.05, {0.0, 1.0, true});
  if (recurrent) {
    training.method = TrainingSpec::Method::recurrent;
    if (training.mirror == TrainingSpec::Mirror::pairs)
      throw table.error("mirror", "is \"pairs\"", "true or false for a recurrent network");
    training.units = static_cast<int>(table.integer_or("units", training.units, 1, GatedRecurrent::kMaxUnits));
    training.epochs = static_cast<int>(table.integer_or("epochs", 40, 1, 10000));
    training.batch = static_cast<int>(table.integer_or("batch", training.batch, 2, 100000));
  } else if (method == "variable_projection") {
    training.rules = static_cast<int>(table.integer("rules", 1, 256));
    if (training.mirror == TrainingSpec::Mirror::pairs && training.rules % 2 != 0)
      throw table.error("rules", "is odd", "an even number, for rules in mirror pairs");
    training.iterations = static_cast<int>(table.integer_or("iterations", training.iterations, 0, 100000));
    training.ridge = table.number_or("ridge", training.ridge, kPositive);
  } else {
    training.method = TrainingSpec::Method::back_propagation;
    if (training.mirror == TrainingSpec::Mirror::pairs)
      throw table.error("mirror", "is \"pairs\"", "true or false with method = \"back_propagation\"");
    training.terms_per_input = static_cast<int>(table.integer_or("terms_per_input", training.terms_per_input, 2, 9));
    training.epochs = static_cast<int>(table.integer_or("epochs", training.epochs, 1, 1000000));
    training.momentum = table.number_or("momentum", 0.0, {0.0, 0.999});
  }
  table.finish();
  return training;
}

// gate = true, false, or { quantile, edge_fraction, disagreement_quantile, disagreement_edge_fraction }, by which its box
// is fitted, and { longest_interval_s }, which asks for no new training.
void read_gate(TableReader& table, CorrectionSpec& spec) {
  const toml::node* node = table.node("gate");
  if (!node || node->is_boolean()) {
    spec.bounds.gate = table.boolean_or("gate", true);
    return;
  }
  TableReader sub = table.table("gate");
  BoxSpec& box = spec.box;
  box.quantile = sub.number_or("quantile", box.quantile, {0.0, 0.25});
  box.edge_fraction = sub.number_or("edge_fraction", box.edge_fraction, {0.0, 10.0, true});
  box.disagreement_quantile = sub.number_or("disagreement_quantile", box.disagreement_quantile, {0.0, 0.5});
  box.disagreement_edge_fraction =
      sub.number_or("disagreement_edge_fraction", box.disagreement_edge_fraction, {0.0, 10.0, true});
  if (sub.has("longest_interval_s")) spec.bounds.longest_interval_s = sub.number("longest_interval_s", kPositive);
  sub.finish();
}

}  // namespace

ChangedScenario read_changed_scenario(TableReader& table, const std::string& key) {
  const toml::node* node = table.node(key);
  if (!node || !node->is_table()) return {table.resolve(table.text(key)), std::make_shared<const toml::table>()};
  TableReader reader = table.table(key);
  ChangedScenario changed;
  if (reader.has("scenario")) changed.file = reader.resolve(reader.text("scenario"));
  toml::table changes = *reader.raw();
  changes.erase("scenario");
  if (changed.is_recorded() && !changes.empty()) {
    std::vector<std::string> beside = reader.keys();
    std::erase(beside, "scenario");
    throw reader.error(
        beside.front(), "stands beside a recorded track, which is taken as it is",
        fmt::format("\"{}\" alone, without {}", changed.file.filename().string(), fmt::join(beside, ", ")));
  }
  changed.changes = std::make_shared<const toml::table>(std::move(changes));
  return changed;
}

std::vector<std::string> CorrectionSpec::members() const {
  std::vector<std::string> names = design.members();
  const std::string& fallback = bounds.fallback;
  if (!fallback.empty() && std::find(names.begin(), names.end(), fallback) == names.end()) names.push_back(fallback);
  return names;
}

CorrectionSpec read_correction_spec(TableReader& table) {
  CorrectionSpec spec;
  CorrectionDesign& design = spec.design;
  design.base = table.text("base");
  design.reference = table.text_or("reference", design.base);
  design.covariance_of = table.text_or("covariance_of", design.base);
  spec.bounds.kappa = read_kappa(table);
  spec.bounds.referee = read_referee(table);
  spec.bounds.fallback = table.text_or("fallback", "");
  if (!spec.bounds.fallback.empty() && !spec.bounds.referee)
    throw table.error("fallback", "stands without a referee that says when it is better", "referee = true");
  read_gate(table, spec);
  design.frame = frame_of(table.choice_or("frame", frame_names(), "state"));
  design.output_in_sigma = table.choice_or("output_in", {"units", "sigma"}, "units") == "sigma";
  design.network = network_kind(table.choice_or("network", network_names(), "nfnn"));
  const bool recurrent = design.network == NetworkKind::recurrent;
  design.covariance_moments =
      table.choice_or("covariance", {"inflation", "moments"}, recurrent ? "moments" : "inflation") == "moments";
  if (recurrent && !design.covariance_moments)
    throw table.error("covariance", "is \"inflation\"", "\"moments\" for a recurrent network");
  spec.model = table.resolve(table.text("model"));
  for (TableReader& feature : table.tables("features")) design.features.push_back(read_feature(feature));
  if (design.features.empty())
    throw table.error("features", "is missing or empty", "an array of tables with a `kind` each");
  TableReader training = table.table("training");
  spec.training = read_training(training, design.network);
  return spec;
}

}  // namespace truebearing
