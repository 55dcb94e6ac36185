// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/interacting_multiple_model.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing {
namespace {

int longest(const InteractingMultipleModel::Modes& modes) {
  int n = 0;
  for (const auto& mode : modes) n = std::max(n, mode->size());
  return n;
}

}  // namespace

InteractingMultipleModel::InteractingMultipleModel(Modes modes, MarkovChain chain)
    : TrackedState(longest(modes)),
      chain_(std::move(chain)),
      probabilities_(chain_.initial),
      predicted_(chain_.initial) {
  if (modes.empty() || modes.size() > static_cast<std::size_t>(kMaxModes) ||
      static_cast<std::size_t>(chain_.modes()) != modes.size())
    throw std::invalid_argument("a multiple model has 1 to 10 modes, and a chain of as many");
  modes_ = bank_of(std::move(modes));
  set_up();
}

InteractingMultipleModel::InteractingMultipleModel(int size, std::unique_ptr<ModeBank> modes, const MarkovChain& chain)
    : TrackedState(size),
      modes_(std::move(modes)),
      chain_(chain),
      probabilities_(chain_.initial),
      predicted_(chain_.initial) {
  set_up();
}

void InteractingMultipleModel::set_up() {
  x_.setZero(size());
  P_.setZero(size(), size());
  estimate_at(x_.data(), P_.data());
  mode_probabilities_at(&probabilities_);
  out_of_date();
}

void InteractingMultipleModel::begin(const double* x, const double* P) {
  modes_->begin(x, P, size());
  probabilities_ = predicted_ = chain_.initial;
  out_of_date();
}

void InteractingMultipleModel::believe(const ModeVector& mu) {
  probabilities_ = predicted_ = mu;
  out_of_date();
}

// Equations (11.6.6-7) to (-10).
StepStatus InteractingMultipleModel::predict(double dt_s) {
  if (dt_s != chain_.period_s) over_dt_ = chain_.over(dt_s);
  const ModeMatrix& Pi = dt_s == chain_.period_s ? chain_.transition : over_dt_;
  const Eigen::Index r = Pi.rows();
  ModeVector c = ModeVector::Zero(r);
  ModeMatrix mixing(r, r);
  for (Eigen::Index j = 0; j < r; ++j) {
    for (Eigen::Index i = 0; i < r; ++i) c[j] += mixing(i, j) = Pi(i, j) * probabilities_[i];
    if (c[j] > 0.0)
      for (Eigen::Index i = 0; i < r; ++i) mixing(i, j) /= c[j];
    else
      mixing.col(j) = ModeVector::Unit(r, j);  // a mode that cannot be entered keeps to itself
  }
  if (!modes_->mix_and_predict(mixing, dt_s)) return StepStatus::failed;
  predicted_ = probabilities_ = c;
  out_of_date();
  return StepStatus::ok;
}

// Equations (11.6.6-13) to (-15).
StepStatus InteractingMultipleModel::update(const AnyMeasurement& measurement, const StateUpdateTarget& combined) {
  ModeVector log_likelihood;
  modes_->update(measurement, log_likelihood);
  ModeVector share = ModeVector::Zero(log_likelihood.size());
  double largest = -kInfinity, total = 0.0;
  for (Eigen::Index j = 0; j < share.size(); ++j) {
    const bool counts = std::isfinite(log_likelihood[j]) && predicted_[j] > 0.0;
    if (!counts) continue;
    total += share[j] = predicted_[j];
    largest = std::max(largest, log_likelihood[j]);
  }
  modes_->mix_innovations(share / total, combined.nu, combined.S);
  combined.nis = mahalanobis_squared(combined.S, combined.nu);
  combined.K.setZero(size(), combined.nu.size());
  if (!(largest > -kInfinity) || !std::isfinite(combined.nis)) return StepStatus::failed;
  modes_->keep();
  total = 0.0;
  for (Eigen::Index j = 0; j < share.size(); ++j)
    total += probabilities_[j] = share[j] > 0.0 ? share[j] * std::exp(log_likelihood[j] - largest) : 0.0;
  probabilities_ /= total;
  predicted_ = probabilities_;
  modes_->mix_gains(probabilities_, combined.K);
  out_of_date();
  return StepStatus::ok;
}

void InteractingMultipleModel::refresh() const {
  up_to_date();
  modes_->mix(probabilities_, x_.data(), P_.data());
}

void InteractingMultipleModel::assign(const TrackedState& other) {
  const auto& same = static_cast<const InteractingMultipleModel&>(other);
  modes_->assign(*same.modes_);
  probabilities_ = same.probabilities_;
  predicted_ = same.predicted_;
  out_of_date();
}

std::unique_ptr<TrackedState> InteractingMultipleModel::fresh() const {
  return std::unique_ptr<TrackedState>(new InteractingMultipleModel(size(), modes_->fresh(), chain_));
}

}  // namespace truebearing
