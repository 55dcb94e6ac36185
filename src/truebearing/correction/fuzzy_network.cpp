// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/fuzzy_network.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

// Scaled centre of a rule that only fills up a block: its exponent is the lowest of all.
constexpr double kNeverFires = 1e154;

std::string size_of(const Eigen::MatrixXd& matrix) {
  return std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols());
}

void require_count(const char* what, Eigen::Index count, int maximum) {
  if (count >= 1 && count <= maximum) return;
  throw InputError("fuzzy network", std::to_string(count) + " " + what, "1 to " + std::to_string(maximum));
}

void require_shape(const char* name, const Eigen::MatrixXd& matrix, Eigen::Index rows, Eigen::Index cols) {
  if (matrix.rows() != rows || matrix.cols() != cols) {
    throw InputError(std::string("fuzzy network: ") + name, size_of(matrix),
                     std::to_string(rows) + " x " + std::to_string(cols));
  }
  if (!matrix.allFinite()) throw InputError(std::string("fuzzy network: ") + name, "a number that is not finite");
}

void require_positive(const char* name, const Eigen::MatrixXd& matrix) {
  if ((matrix.array() > 0.0).all()) return;
  throw InputError(std::string("fuzzy network: ") + name, "a number that is not positive", "numbers above 0");
}

void validate(const FuzzyNetwork::Parameters& p) {
  const Eigen::Index inputs = p.centres.cols();
  const Eigen::Index rules = p.centres.rows();
  const Eigen::Index outputs = p.consequents.cols();
  require_count("inputs", inputs, FuzzyNetwork::kMaxInputs);
  require_count("rules", rules, FuzzyNetwork::kMaxRules);
  require_count("outputs", outputs, FuzzyNetwork::kMaxOutputs);
  require_shape("input_mean", p.input_mean, inputs, 1);
  require_shape("input_scale", p.input_scale, inputs, 1);
  require_shape("centres", p.centres, rules, inputs);
  require_shape("widths", p.widths, rules, inputs);
  require_shape("consequents", p.consequents, rules, outputs);
  require_shape("output_scale", p.output_scale, outputs, 1);
  require_positive("input_scale", p.input_scale);
  require_positive("widths", p.widths);
  require_positive("output_scale", p.output_scale);
  if (!std::isfinite(p.input_clip) || p.input_clip <= 0.0) {
    throw InputError("fuzzy network: input_clip", std::to_string(p.input_clip), "a finite number above 0");
  }
}

}  // namespace

FuzzyNetwork::FuzzyNetwork(Parameters parameters) : parameters_(std::move(parameters)) {
  validate(parameters_);
  const Eigen::ArrayXXd inverse_widths = std::sqrt(0.5) / parameters_.widths.array();
  const Eigen::ArrayXXd scaled_centres = parameters_.centres.array() * inverse_widths;
  scaled_consequents_ = parameters_.consequents * parameters_.output_scale.asDiagonal();
  // Each factor is finite; the products of extreme ones need not be, and 0 * inf is not a strength.
  if (!inverse_widths.allFinite() || !scaled_centres.allFinite() || !scaled_consequents_.allFinite()) {
    throw InputError("fuzzy network", "widths or output_scale out of range", "products with finite results");
  }
  constexpr Eigen::Index kBlock = kernels::kRuleBlock;
  const Eigen::Index blocks = (rules() + kBlock - 1) / kBlock;
  blocks_ = static_cast<int>(blocks);
  inverse_widths_.setZero(kBlock, blocks * inputs());
  scaled_centres_.setConstant(kBlock, blocks * inputs(), kNeverFires);
  for (Eigen::Index j = 0; j < rules(); ++j)
    for (Eigen::Index i = 0; i < inputs(); ++i) {
      inverse_widths_(j % kBlock, j / kBlock * inputs() + i) = inverse_widths(j, i);
      scaled_centres_(j % kBlock, j / kBlock * inputs() + i) = scaled_centres(j, i);
    }
}

// False where an input is not a number.
bool FuzzyNetwork::standardise(const Inputs& input, double* u) const {
  const double *mean = parameters_.input_mean.data(), *scale = parameters_.input_scale.data(), *from = input.data();
  const double clip = parameters_.input_clip;
  double sum = 0.0;
  for (int i = 0; i < inputs(); ++i) {
    u[i] = std::clamp((from[i] - mean[i]) / scale[i], -clip, clip);
    sum += u[i];
  }
  return !std::isnan(sum);
}

kernels::RuleBlocks FuzzyNetwork::blocks() const {
  return {.blocks = blocks_,
          .inputs = inputs(),
          .centres = scaled_centres_.data(),
          .inverse_widths = inverse_widths_.data()};
}

void FuzzyNetwork::strengths(const Inputs& input, Strengths& phi) const {
  // Of whole blocks: behind the last rule phi has room for the lanes that fill up.
  static_assert(kMaxRules % kernels::kRuleBlock == 0);
  phi.resize(rules());
  double u[kMaxInputs];
  if (standardise(input, u))
    kernels::rule_strengths(blocks(), u, phi.data());
  else
    phi.setConstant(kNaN);
}

FuzzyNetwork::Outputs FuzzyNetwork::output(const Strengths& phi) const {
  Outputs y(outputs());
  kernels::rule_means({rules(), outputs(), scaled_consequents_.data(), 0, nullptr}, phi.data(), y.data(), nullptr);
  return y;
}

void FuzzyNetwork::answer(const Inputs& input, Outputs& y, int n, const double* matrices, double* mean) const {
  y.resize(outputs());
  double u[kMaxInputs];
  if (standardise(input, u)) {
    kernels::rule_answer(blocks(), {rules(), outputs(), scaled_consequents_.data(), n, matrices}, u, y.data(), mean);
  } else {
    y.setConstant(kNaN);
    std::fill_n(mean, n * n, kNaN);
  }
}

FuzzyNetwork::Jacobian FuzzyNetwork::jacobian(const Inputs& input, const Strengths& phi) const {
  const Outputs y = output(phi);
  Jacobian slope = Jacobian::Zero(outputs(), inputs());
  for (Eigen::Index i = 0; i < slope.cols(); ++i) {
    const double u = (input[i] - parameters_.input_mean[i]) / parameters_.input_scale[i];
    if (!(std::abs(u) < parameters_.input_clip)) continue;
    // sum phi_j a_j w_j - y sum phi_j a_j.
    double* const column = slope.data() + i * slope.rows();
    double total = 0.0;
    for (Eigen::Index j = 0; j < phi.size(); ++j) {
      const double s = parameters_.widths(j, i);
      const double weight = phi[j] * ((parameters_.centres(j, i) - u) / s) / s;
      total += weight;
      for (Eigen::Index k = 0; k < slope.rows(); ++k) column[k] += weight * scaled_consequents_(j, k);
    }
    for (Eigen::Index k = 0; k < slope.rows(); ++k) column[k] = (column[k] - total * y[k]) / parameters_.input_scale[i];
  }
  return slope;
}

}  // namespace truebearing
