// SPDX-License-Identifier: Apache-2.0
#include "training/fuzzy_training.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

// A scale far below the size of the numbers is rounding error, not variation.
double usable_scale(double deviation, double magnitude) {
  return deviation > 1e-12 * magnitude && std::isnormal(deviation) ? deviation : 1.0;
}

double root_mean_square(const Eigen::VectorXd& values) {
  return std::sqrt(values.array().square().mean());
}

}  // namespace

Eigen::VectorXd FuzzyTrainingData::weights() const {
  return output_weights.size() > 0 ? output_weights : Eigen::VectorXd::Ones(labels.cols());
}

Eigen::VectorXd FuzzyTrainingData::output_signs() const {
  if (output_parity.empty()) return Eigen::VectorXd::Constant(labels.cols(), -1.0);
  return Eigen::Map<const Eigen::VectorXi>(output_parity.data(), static_cast<Eigen::Index>(output_parity.size()))
      .cast<double>();
}

void validate(const FuzzyTrainingData& data, int rules) {
  const auto refuse = [](const std::string& found, const std::string& valid) {
    throw InputError("training data", found, valid);
  };
  const Eigen::Index inputs = data.features.cols();
  const Eigen::Index outputs = data.labels.cols();
  if (inputs < 1 || inputs > FuzzyNetwork::kMaxInputs) {
    refuse(std::to_string(inputs) + " features", "1 to " + std::to_string(FuzzyNetwork::kMaxInputs));
  }
  if (outputs < 1 || outputs > FuzzyNetwork::kMaxOutputs) {
    refuse(std::to_string(outputs) + " outputs", "1 to " + std::to_string(FuzzyNetwork::kMaxOutputs));
  }
  if (rules < 1 || rules > FuzzyNetwork::kMaxRules) {
    refuse(std::to_string(rules) + " rules", "1 to " + std::to_string(FuzzyNetwork::kMaxRules));
  }
  if (data.labels.rows() != data.rows()) {
    refuse(std::to_string(data.labels.rows()) + " rows of labels for " + std::to_string(data.rows()) + " of features",
           "as many");
  }
  if (data.rows() < rules) {
    refuse(std::to_string(data.rows()) + " rows for " + std::to_string(rules) + " rules", "at least a row per rule");
  }
  for (Eigen::Index n = 0; n < data.rows(); ++n) {
    if (!data.features.row(n).allFinite() || !data.labels.row(n).allFinite()) {
      refuse("a number that is not finite in row " + std::to_string(n), "finite numbers");
    }
  }
  if (data.mirrored() && static_cast<Eigen::Index>(data.parity.size()) != inputs) {
    refuse(std::to_string(data.parity.size()) + " parities for " + std::to_string(inputs) + " features",
           "one per feature, or none");
  }
  for (const int parity : data.parity) {
    if (parity != 1 && parity != -1) refuse("parity " + std::to_string(parity), "+1 or -1");
  }
  for (const int parity : data.output_parity) {
    if (parity != 1 && parity != -1) refuse("output parity " + std::to_string(parity), "+1 or -1");
  }
  if (!data.output_parity.empty() && static_cast<Eigen::Index>(data.output_parity.size()) != outputs) {
    refuse(std::to_string(data.output_parity.size()) + " output parities", "one per output, or none");
  }
  if (data.paired_rules && (!data.mirrored() || rules % 2 != 0)) {
    refuse("paired rules that are odd in number or have no parities", "an even number, and one parity per feature");
  }
  const Eigen::VectorXd weights = data.weights();
  if (weights.size() != outputs || !weights.allFinite() || !(weights.array() > 0.0).all()) {
    refuse("output weights that are not positive or not one per output", "positive numbers");
  }
}

void require_option(const char* option, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw InputError(option, std::to_string(value), std::to_string(low) + " to " + std::to_string(high));
}

FuzzyNetwork::Parameters normalisation(const FuzzyTrainingData& data, double input_clip) {
  FuzzyNetwork::Parameters parameters;
  parameters.input_clip = input_clip;
  parameters.input_mean.setZero(data.features.cols());
  parameters.input_scale.resize(data.features.cols());
  for (Eigen::Index i = 0; i < data.features.cols(); ++i) {
    const bool odd = data.mirrored() && data.parity[static_cast<std::size_t>(i)] < 0;
    if (!odd) parameters.input_mean[i] = data.features.col(i).mean();
    const Eigen::VectorXd deviations = data.features.col(i).array() - parameters.input_mean[i];
    parameters.input_scale[i] = usable_scale(root_mean_square(deviations), std::abs(parameters.input_mean[i]));
  }
  parameters.output_scale.resize(data.labels.cols());
  for (Eigen::Index o = 0; o < data.labels.cols(); ++o) {
    parameters.output_scale[o] = usable_scale(root_mean_square(data.labels.col(o)), 0.0);
  }
  return parameters;
}

NormalisedRows normalised_rows(const FuzzyTrainingData& data, const FuzzyNetwork::Parameters& normalisation) {
  const Eigen::Index count = data.rows(), total = data.mirrored_rows() ? 2 * count : count;
  const Eigen::VectorXd signs = data.output_signs();
  NormalisedRows normalised{Eigen::MatrixXd(data.features.cols(), total), Eigen::MatrixXd(data.labels.cols(), total)};
  const auto fill = [&](Eigen::Index first, bool mirror) {
    for (Eigen::Index i = 0; i < data.features.cols(); ++i) {
      const double sign = mirror ? data.parity[static_cast<std::size_t>(i)] : 1.0;
      for (Eigen::Index n = 0; n < count; ++n) {
        const double u = (sign * data.features(n, i) - normalisation.input_mean[i]) / normalisation.input_scale[i];
        normalised.inputs(i, first + n) = std::clamp(u, -normalisation.input_clip, normalisation.input_clip);
      }
    }
    for (Eigen::Index o = 0; o < data.labels.cols(); ++o) {
      const double factor = (mirror ? signs[o] : 1.0) / normalisation.output_scale[o];
      for (Eigen::Index n = 0; n < count; ++n) normalised.targets(o, first + n) = factor * data.labels(n, o);
    }
  };
  fill(0, false);
  if (data.mirrored_rows()) fill(count, true);
  return normalised;
}

std::vector<Eigen::Index> stratified_rows(Eigen::Index total, Eigen::Index count, RandomStream& random) {
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(std::min(total, count)));
  if (total <= count) {
    std::iota(rows.begin(), rows.end(), Eigen::Index{0});
    return rows;
  }
  for (Eigen::Index s = 0; s < count; ++s) {
    const Eigen::Index low = s * total / count;
    const Eigen::Index high = (s + 1) * total / count;
    rows[static_cast<std::size_t>(s)] =
        low + static_cast<Eigen::Index>(random.index(static_cast<std::uint64_t>(high - low)));
  }
  return rows;
}

}  // namespace truebearing
