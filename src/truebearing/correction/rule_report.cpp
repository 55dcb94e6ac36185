// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/rule_report.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <utility>
#include <vector>

namespace truebearing {
namespace {

std::string unit_of(const std::string& component) {
  const std::string unit = component.substr(component.rfind('_') + 1);
  return unit == "mps" ? "m/s" : unit;
}

// Three significant digits, without an exponent.
std::string amount(double value) {
  return std::abs(value) >= 100.0 ? fmt::format("{:+.0f}", value) : fmt::format("{:+.3g}", value);
}

}  // namespace

std::string amounts(const CorrectionModel& model, const Eigen::VectorXd& values) {
  const StateSpace& space = space_in(model.design.frame, *model.space);
  std::string text;
  for (int i = 0; i < space.size(); ++i) {
    const std::string& component = space.components[static_cast<std::size_t>(i)];
    text += fmt::format("{}{} ", i == 0 ? "" : ", ", amount(values[i]));
    if (model.design.output_in_sigma)
      text += fmt::format("sigma of {}", component);
    else if (model.design.frame != Frame::state)
      text += fmt::format("{} {}", unit_of(component), component.substr(0, component.find('_')));
    else
      text += unit_of(component);
  }
  return text;
}

std::string conditions_of(const ReportedRule& rule, const CorrectionModel& model) {
  std::string conditions;
  for (std::size_t i = 0; i < rule.terms.size(); ++i)
    conditions += fmt::format("{}{} is {}", i == 0 ? "" : " AND ", describe(model.design.features[i]), rule.terms[i]);
  return conditions;
}

std::string term_word(double u, int parity) {
  if (parity < 0) {
    const double size = std::abs(u);
    if (size < 0.25) return "NEAR ZERO";
    const std::string sign = u > 0.0 ? "POSITIVE" : "NEGATIVE";
    return size < 0.75 ? "SMALL " + sign : size < 1.75 ? sign : "LARGE " + sign;
  }
  return u < -1.5 ? "VERY SMALL" : u < -0.5 ? "SMALL" : u <= 0.5 ? "MEDIUM" : u <= 1.5 ? "LARGE" : "VERY LARGE";
}

std::vector<ReportedRule> reported_rules(const CorrectionModel& model) {
  const RuleBase& rules = model.rules();
  const FuzzyNetwork::Parameters& parameters = rules.network.parameters();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(rules.network.rules()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return rules.usage[a] > rules.usage[b]; });

  std::vector<ReportedRule> reported;
  FuzzyNetwork::Strengths phi;
  for (const Eigen::Index rule : order) {
    ReportedRule one;
    one.rule = rule;
    for (std::size_t i = 0; i < model.design.features.size(); ++i)
      one.terms.push_back(term_word(parameters.centres(rule, static_cast<Eigen::Index>(i)),
                                    mirror_parity(model.design.features[i], model.design.frame, *model.space)));
    const FuzzyNetwork::Inputs centre =
        (parameters.input_mean.array() +
         parameters.centres.row(rule).transpose().array() * parameters.input_scale.array())
            .matrix();
    rules.network.strengths(centre, phi);
    one.added = rules.network.output(phi);
    one.taught = rules.local_mean.row(rule).transpose();
    one.usage = rules.usage[rule];
    reported.push_back(std::move(one));
  }
  return reported;
}

std::string rule_sentences(const CorrectionModel& model) {
  std::string text;
  int number = 0;
  for (const ReportedRule& rule : reported_rules(model))
    text += fmt::format("{}. IF {} THEN add {}   (usage {:.1f} %, teacher's mean {})\n", ++number,
                        conditions_of(rule, model), amounts(model, rule.added), 100.0 * rule.usage,
                        amounts(model, rule.taught));
  return text;
}

}  // namespace truebearing
