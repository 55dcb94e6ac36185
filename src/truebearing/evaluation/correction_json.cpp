// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/correction_json.hpp"

#include "truebearing/correction/rule_report.hpp"
#include "truebearing/evaluation/six_digits.hpp"

namespace truebearing {
namespace {

using Json = nlohmann::ordered_json;

Json feature_json(const CorrectionModel& model, Eigen::Index i, const CorrectionDetails::Feature& seen) {
  const InputScale standard = input_scale(model.network, i);
  return {{"name", describe(model.design.features[static_cast<std::size_t>(i)])},
          {"mean", six_digits(standard.mean)},
          {"scale", six_digits(standard.scale)},
          {"clip", six_digits(standard.clip)},
          {"low", six_digits(model.gate ? model.gate->low[i] : kNaN)},
          {"high", six_digits(model.gate ? model.gate->high[i] : kNaN)},
          {"seen",
           {{"mean", six_digits(seen.mean)},
            {"deviation", six_digits(seen.deviation)},
            {"least", six_digits(seen.least)},
            {"greatest", six_digits(seen.greatest)},
            {"outside", six_digits(seen.outside)},
            {"counted", seen.counted}}}};
}

// Terms in the units of the features.
Json rule_json(const CorrectionModel& model, const ReportedRule& rule, const CorrectionDetails::Rule& seen) {
  const FuzzyNetwork::Parameters& p = model.rules().network.parameters();
  std::vector<double> centre, width;
  for (Eigen::Index i = 0; i < p.centres.cols(); ++i) {
    centre.push_back(p.input_mean[i] + p.input_scale[i] * p.centres(rule.rule, i));
    width.push_back(p.input_scale[i] * p.widths(rule.rule, i));
  }
  return {{"if", conditions_of(rule, model)},      {"add", amounts(model, rule.added)},
          {"taught", amounts(model, rule.taught)}, {"usage", six_digits(rule.usage)},
          {"fired", six_digits(seen.fired)},       {"strongest", six_digits(seen.strongest)},
          {"centre", six_digits(centre)},          {"width", six_digits(width)}};
}

}  // namespace

Json correction_steps_json(const CorrectionDetails& details) {
  return {{"steps", details.steps},
          {"asked", details.asked},
          {"outside_intervals", six_digits(details.outside_intervals)},
          {"outside_disagreement", six_digits(details.outside_disagreement)},
          {"by_step",
           {{"gate", six_digits(details.gate)},
            {"box", six_digits(details.box)},
            {"referee", six_digits(details.referee)},
            {"limited", six_digits(details.limited)},
            {"handed_over", six_digits(details.handed_over)},
            {"wanted_sigmas", six_digits(details.wanted_sigmas)},
            {"moved_sigmas", six_digits(details.moved_sigmas)}}}};
}

Json correction_json(const CorrectionDetails& details) {
  const CorrectionModel& model = *details.model;
  Json json{{"network", to_string(model.design.network)},
            {"size", describe(model.network)},
            {"base", model.design.base},
            {"reference", model.design.reference},
            {"bounds", details.bounds},
            {"kappa", six_digits(details.kappa)}};
  json.update(correction_steps_json(details));
  json["features"] = Json::array();
  for (std::size_t i = 0; i < details.features.size(); ++i)
    json["features"].push_back(feature_json(model, static_cast<Eigen::Index>(i), details.features[i]));
  if (details.rules.empty()) return json;
  json["rules"] = Json::array();
  for (const ReportedRule& rule : reported_rules(model))
    json["rules"].push_back(rule_json(model, rule, details.rules[static_cast<std::size_t>(rule.rule)]));
  return json;
}

}  // namespace truebearing
