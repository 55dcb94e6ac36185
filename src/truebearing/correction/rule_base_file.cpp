// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <utility>

#include "truebearing/correction/network_file.hpp"

namespace truebearing {

RuleBase read_rule_base(JsonObject& file, const CorrectionDesign& design, Eigen::Index n) {
  const auto d = static_cast<Eigen::Index>(design.features.size());
  FuzzyNetwork::Parameters parameters;
  read_normalisation(file, d, n, parameters);
  const nlohmann::json& rules = file.array("rules", 1, FuzzyNetwork::kMaxRules);
  const auto M = static_cast<Eigen::Index>(rules.size());
  parameters.centres.resize(M, d);
  parameters.widths.resize(M, d);
  parameters.consequents.resize(M, n);
  const bool moments = design.covariance_moments;
  RuleBase base;
  base.inflation.resize(moments ? 0 : M);
  base.moments.resize(moments ? M : 0, moments ? n * n : 0);
  base.usage.resize(M);
  base.local_mean.resize(M, n);
  for (Eigen::Index j = 0; j < M; ++j) {
    JsonObject rule(rules[static_cast<std::size_t>(j)], file.file(), fmt::format("rules[{}]", j));
    parameters.centres.row(j) = rule.vector("centre", d).transpose();
    parameters.widths.row(j) = rule.vector("width", d).transpose();
    parameters.consequents.row(j) = rule.vector("consequent", n).transpose();
    if (moments)
      base.moments.row(j) = rule.vector("moments", n * n).transpose();
    else
      base.inflation[j] = rule.number("inflation");
    base.usage[j] = rule.number("usage");
    base.local_mean.row(j) = rule.vector("local_mean", n).transpose();
    rule.finish();
  }
  try {
    base.network = FuzzyNetwork(std::move(parameters));
  } catch (const InputError& error) {
    throw InputError(file.file() + ": " + error.where(), error.found(), error.valid());
  }
  return base;
}

void write_rule_base(const RuleBase& base, const CorrectionDesign& design, nlohmann::ordered_json& json) {
  const FuzzyNetwork::Parameters& parameters = base.network.parameters();
  json["rules"] = nlohmann::ordered_json::array();
  for (Eigen::Index j = 0; j < parameters.centres.rows(); ++j) {
    nlohmann::ordered_json rule{{"centre", array_json(parameters.centres.row(j))},
                                {"width", array_json(parameters.widths.row(j))},
                                {"consequent", array_json(parameters.consequents.row(j))}};
    if (design.covariance_moments)
      rule["moments"] = array_json(base.moments.row(j));
    else
      rule["inflation"] = base.inflation[j];
    rule["usage"] = base.usage[j];
    rule["local_mean"] = array_json(base.local_mean.row(j));
    json["rules"].push_back(std::move(rule));
  }
}

}  // namespace truebearing
