// SPDX-License-Identifier: Apache-2.0
#include "training/grid_network.hpp"

#include <cmath>

namespace truebearing {

void GridParameters::set_zero_like(const GridParameters& other) {
  centres.setZero(other.centres.size());
  log_widths.setZero(other.log_widths.size());
  consequents.setZero(other.consequents.rows(), other.consequents.cols());
}

GridNetwork::GridNetwork(const FuzzyPartition& partition, int outputs) : first_term_{0} {
  const Eigen::Index rules = expand(partition, outputs).centres.rows();
  for (int i = 0; i < partition.inputs(); ++i) first_term_.push_back(first_term_.back() + partition.terms(i));
  parameters.centres.resize(first_term_.back());
  parameters.log_widths.resize(first_term_.back());
  parameters.consequents.setZero(outputs, rules);
  for (std::size_t i = 0; i < partition.centres.size(); ++i) {
    parameters.centres.segment(first_term_[i], partition.centres[i].size()) = partition.centres[i];
    parameters.log_widths.segment(first_term_[i], partition.widths[i].size()) = partition.widths[i].array().log();
  }
  memberships_.resize(first_term_.back());
  phi_.resize(rules);
  by_exponent_.resize(rules);
}

FuzzyPartition GridNetwork::partition() const {
  FuzzyPartition partition;
  for (std::size_t i = 0; i + 1 < first_term_.size(); ++i) {
    const Eigen::Index terms = first_term_[i + 1] - first_term_[i];
    partition.centres.emplace_back(parameters.centres.segment(first_term_[i], terms));
    partition.widths.emplace_back(parameters.log_widths.segment(first_term_[i], terms).array().exp());
  }
  return partition;
}

void GridNetwork::spread(const Eigen::VectorXd& u) {
  Eigen::Index rules = 1;
  phi_[0] = 1.0;
  for (std::size_t i = 0; i + 1 < first_term_.size(); ++i) {
    const Eigen::Index terms = first_term_[i + 1] - first_term_[i];
    auto memberships = memberships_.segment(first_term_[i], terms).array();
    const auto centres = parameters.centres.segment(first_term_[i], terms).array();
    const auto log_widths = parameters.log_widths.segment(first_term_[i], terms).array();
    memberships = -0.5 * (u[static_cast<Eigen::Index>(i)] - centres).square() * (-2.0 * log_widths).exp();
    memberships = (memberships - memberships.maxCoeff()).exp();
    memberships /= memberships.sum();
    // Backwards, for rule j is still to be read when its successors j K .. j K + K - 1 are written.
    for (Eigen::Index j = rules - 1; j >= 0; --j) phi_.segment(j * terms, terms) = phi_[j] * memberships.matrix();
    rules *= terms;
  }
}

double GridNetwork::add_gradient(const Eigen::VectorXd& u, const Eigen::VectorXd& t, const Eigen::VectorXd& weights,
                                 GridParameters& gradient) {
  spread(u);
  output_.noalias() = parameters.consequents * phi_;
  residual_ = t - output_;
  const double cost = 0.5 * residual_.cwiseAbs2().dot(weights);
  residual_ = residual_.cwiseProduct(weights);
  gradient.consequents.noalias() -= residual_ * phi_.transpose();

  by_exponent_.noalias() = -parameters.consequents.transpose() * residual_;
  by_exponent_.array() += residual_.dot(output_);
  by_exponent_.array() *= phi_.array();
  // Input by input from the last: the gradient by a term is the sum over the rules that use it; then that input is
  // summed out.
  Eigen::Index rules = phi_.size();
  for (std::size_t i = first_term_.size() - 1; i-- > 0;) {
    const Eigen::Index terms = first_term_[i + 1] - first_term_[i];
    rules /= terms;
    Eigen::Map<Eigen::MatrixXd> by_rule(by_exponent_.data(), terms, rules);
    for (Eigen::Index k = 0; k < terms; ++k) {
      const Eigen::Index term = first_term_[i] + k;
      const double by_term = by_rule.row(k).sum();
      const double inverse_width = std::exp(-parameters.log_widths[term]);
      const double distance = (u[static_cast<Eigen::Index>(i)] - parameters.centres[term]) * inverse_width;
      gradient.centres[term] += by_term * distance * inverse_width;
      gradient.log_widths[term] += by_term * distance * distance;
    }
    for (Eigen::Index j = 0; j < rules; ++j) by_exponent_[j] = by_rule.col(j).sum();
  }
  return cost;
}

}  // namespace truebearing
