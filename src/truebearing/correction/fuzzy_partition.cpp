// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/fuzzy_partition.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

// Refuses before anything is multiplied out, so that a large grid cannot overflow the count.
Eigen::Index count_rules(const FuzzyPartition& partition) {
  if (partition.widths.size() != partition.centres.size()) {
    throw InputError("fuzzy partition", "centres and widths for different numbers of inputs");
  }
  Eigen::Index rules = 1;
  for (std::size_t i = 0; i < partition.centres.size(); ++i) {
    const Eigen::Index terms = partition.centres[i].size();
    if (terms < 1 || partition.widths[i].size() != terms) {
      throw InputError("fuzzy partition: input " + std::to_string(i), "unequal or empty lists of centres and widths");
    }
    rules *= terms;
    if (rules > FuzzyNetwork::kMaxRules) {
      throw InputError("fuzzy partition", "too many rules in the full grid",
                       "at most " + std::to_string(FuzzyNetwork::kMaxRules));
    }
  }
  return rules;
}

}  // namespace

FuzzyPartition uniform_partition(const Eigen::VectorXd& low, const Eigen::VectorXd& high, int terms) {
  if (low.size() != high.size() || !(low.array() < high.array()).all()) {
    throw InputError("fuzzy partition", "a range whose low end is not below its high end");
  }
  if (terms < 2) throw InputError("fuzzy partition: terms", std::to_string(terms), "2 or more");
  const double half_crossing = 2.0 * std::sqrt(2.0 * std::numbers::ln2);  // spacing over width
  FuzzyPartition partition;
  for (Eigen::Index i = 0; i < low.size(); ++i) {
    const double spacing = (high[i] - low[i]) / (terms - 1);
    partition.centres.emplace_back(Eigen::VectorXd::LinSpaced(terms, low[i], high[i]));
    partition.widths.emplace_back(Eigen::VectorXd::Constant(terms, spacing / half_crossing));
  }
  return partition;
}

FuzzyNetwork::Parameters expand(const FuzzyPartition& partition, int outputs) {
  const Eigen::Index rules = count_rules(partition);
  const Eigen::Index inputs = partition.inputs();
  FuzzyNetwork::Parameters parameters;
  parameters.input_mean.setZero(inputs);
  parameters.input_scale.setOnes(inputs);
  parameters.centres.resize(rules, inputs);
  parameters.widths.resize(rules, inputs);
  parameters.consequents.setZero(rules, outputs);
  parameters.output_scale.setOnes(outputs);
  Eigen::Index stride = 1;  // rules between two neighbouring terms of input i
  for (Eigen::Index i = inputs - 1; i >= 0; --i) {
    const Eigen::VectorXd& centres = partition.centres[static_cast<std::size_t>(i)];
    const Eigen::VectorXd& widths = partition.widths[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < rules; ++j) {
      const Eigen::Index term = (j / stride) % centres.size();
      parameters.centres(j, i) = centres[term];
      parameters.widths(j, i) = widths[term];
    }
    stride *= centres.size();
  }
  return parameters;
}

}  // namespace truebearing
