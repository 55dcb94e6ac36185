#include "truebearing/correction/fuzzy_network.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

// exp(-700) is the smallest round power that is still a normal number: denormal strengths mean nothing and cost a
// hundred cycles each.
constexpr double kLowestExponent = -700.0;

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
  inverse_widths_ = std::sqrt(0.5) / parameters_.widths.array();
  scaled_centres_ = parameters_.centres.cwiseProduct(inverse_widths_);
  scaled_consequents_ = parameters_.output_scale.asDiagonal() * parameters_.consequents.transpose();
  // Each factor is finite; the products of extreme ones need not be, and 0 * inf is not a strength.
  if (!inverse_widths_.allFinite() || !scaled_centres_.allFinite() || !scaled_consequents_.allFinite()) {
    throw InputError("fuzzy network", "widths or output_scale out of range", "products with finite results");
  }
}

void FuzzyNetwork::strengths(const Inputs& input, Strengths& phi) const {
  phi.setZero(rules());
  for (Eigen::Index i = 0; i < inputs(); ++i) {
    const double standardised = (input[i] - parameters_.input_mean[i]) / parameters_.input_scale[i];
    if (std::isnan(standardised)) {
      phi.setConstant(std::numeric_limits<double>::quiet_NaN());
      return;
    }
    const double u = std::clamp(standardised, -parameters_.input_clip, parameters_.input_clip);
    phi.array() -= (u * inverse_widths_.col(i) - scaled_centres_.col(i)).array().square();
  }
  const double peak = phi.maxCoeff();
  phi = (phi.array() - peak).max(kLowestExponent).exp();
  phi *= 1.0 / phi.sum();
}

FuzzyNetwork::Outputs FuzzyNetwork::output(const Strengths& phi) const {
  return scaled_consequents_.lazyProduct(phi);
}

}  // namespace truebearing
