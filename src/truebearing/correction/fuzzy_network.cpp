// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/fuzzy_network.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "truebearing/core/error.hpp"
#include "truebearing/correction/rule_strengths_kernel.hpp"

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
  scaled_consequents_ = parameters_.output_scale.asDiagonal() * parameters_.consequents.transpose();
  // Each factor is finite; the products of extreme ones need not be, and 0 * inf is not a strength.
  if (!inverse_widths.allFinite() || !scaled_centres.allFinite() || !scaled_consequents_.allFinite()) {
    throw InputError("fuzzy network", "widths or output_scale out of range", "products with finite results");
  }
  const Eigen::Index blocks = (rules() + kLanes - 1) / kLanes;
  inverse_widths_.setZero(kLanes, blocks * inputs());
  scaled_centres_.setConstant(kLanes, blocks * inputs(), kNeverFires);
  for (Eigen::Index j = 0; j < rules(); ++j)
    for (Eigen::Index i = 0; i < inputs(); ++i) {
      inverse_widths_(j % kLanes, j / kLanes * inputs() + i) = inverse_widths(j, i);
      scaled_centres_(j % kLanes, j / kLanes * inputs() + i) = scaled_centres(j, i);
    }
}

void FuzzyNetwork::strengths(const Inputs& input, Strengths& phi) const {
  const Eigen::Index d = inputs();
  phi.resize(rules());
  Inputs u(d);
  for (Eigen::Index i = 0; i < d; ++i) {
    const double standardised = (input[i] - parameters_.input_mean[i]) / parameters_.input_scale[i];
    if (std::isnan(standardised)) {
      phi.setConstant(std::numeric_limits<double>::quiet_NaN());
      return;
    }
    u[i] = std::clamp(standardised, -parameters_.input_clip, parameters_.input_clip);
  }
  // Of whole blocks: behind the last rule phi has room for the lanes that fill up.
  static_assert(kMaxRules % kLanes == 0);
  kernels::rule_strengths({.blocks = static_cast<int>(inverse_widths_.cols() / d),
                           .inputs = static_cast<int>(d),
                           .centres = scaled_centres_.data(),
                           .inverse_widths = inverse_widths_.data()},
                          u.data(), phi.data());
}

FuzzyNetwork::Outputs FuzzyNetwork::output(const Strengths& phi) const {
  return scaled_consequents_.lazyProduct(phi);
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
      const double* const w = scaled_consequents_.data() + j * slope.rows();
      for (Eigen::Index k = 0; k < slope.rows(); ++k) column[k] += weight * w[k];
    }
    for (Eigen::Index k = 0; k < slope.rows(); ++k) column[k] = (column[k] - total * y[k]) / parameters_.input_scale[i];
  }
  return slope;
}

}  // namespace truebearing
