// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/interacting_multiple_model.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/with_count.hpp"

namespace truebearing {
namespace {

// The estimates of all modes in the space of one mode's N states: what another lacks is taken from that mode's own.
template <int N>
class InSpaceOf {
 public:
  using State = Eigen::Matrix<double, N, 1>;
  using Covariance = Eigen::Matrix<double, N, N>;

  InSpaceOf(const TrackedState& own, const InteractingMultipleModel::Modes& modes) {
    for (std::size_t i = 0; i < modes.size(); ++i) {
      seen_[i] = {modes[i]->x_data(), modes[i]->P_data()};
      if (modes[i]->size() != N) fit(own, *modes[i], i);
    }
  }

  Eigen::Map<const State> x(std::size_t i) const { return Eigen::Map<const State>(seen_[i].x); }
  Eigen::Map<const Covariance> P(std::size_t i) const { return Eigen::Map<const Covariance>(seen_[i].P); }

 private:
  struct Seen {
    const double* x;
    const double* P;
  };

  void fit(const TrackedState& own, const TrackedState& other, std::size_t i) {
    const int shared = std::min(N, other.size());
    fitted_x_[i] = Eigen::Map<const State>(own.x_data());
    fitted_x_[i].head(shared) = other.x().head(shared);
    Covariance& P = fitted_P_[i];
    P = Eigen::Map<const Covariance>(own.P_data());
    P.leftCols(shared).setZero();
    P.topRows(shared).setZero();
    P.topLeftCorner(shared, shared) = other.P().topLeftCorner(shared, shared);
    seen_[i] = {fitted_x_[i].data(), P.data()};
  }

  std::array<Seen, kMaxModes> seen_;
  std::array<State, kMaxModes> fitted_x_;
  std::array<Covariance, kMaxModes> fitted_P_;
};

// Equations (11.6.6-8) to (-10): `mixed` begins with the mixture that mode `own` of N states sees.
template <int N>
void mix(const ModeVector& weights, const InteractingMultipleModel::Modes& modes, const TrackedState& own,
         TrackedState& mixed) {
  const InSpaceOf<N> space(own, modes);
  typename InSpaceOf<N>::State mean = InSpaceOf<N>::State::Zero();
  for (std::size_t i = 0; i < modes.size(); ++i) mean += weights[static_cast<Eigen::Index>(i)] * space.x(i);
  typename InSpaceOf<N>::Covariance P = InSpaceOf<N>::Covariance::Zero();
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const double weight = weights[static_cast<Eigen::Index>(i)];
    if (weight == 0.0) continue;
    const typename InSpaceOf<N>::State d = space.x(i) - mean;
    P += weight * (space.P(i) + d * d.transpose());
  }
  mixed.begin(mean.data(), P.data());
}

// In fixed sizes, which take half the time.
double log_density_of(const StateUpdate& update) {
  if (update.nu.size() == 1)
    return log_density(Eigen::Matrix<double, 1, 1>(update.S), Eigen::Matrix<double, 1, 1>(update.nu));
  if (update.nu.size() == 2) return log_density(Eigen::Matrix2d(update.S), Eigen::Vector2d(update.nu));
  return log_density(update.S, update.nu);
}

int longest(const InteractingMultipleModel::Modes& modes) {
  int n = 0;
  for (const auto& mode : modes) n = std::max(n, mode->size());
  return n;
}

}  // namespace

InteractingMultipleModel::InteractingMultipleModel(Modes modes, MarkovChain chain)
    : TrackedState(longest(modes)),
      modes_(std::move(modes)),
      chain_(std::move(chain)),
      probabilities_(chain_.initial),
      predicted_(chain_.initial) {
  if (modes_.empty() || modes_.size() > static_cast<std::size_t>(kMaxModes) ||
      static_cast<std::size_t>(chain_.modes()) != modes_.size())
    throw std::invalid_argument("a multiple model has 1 to 10 modes, and a chain of as many");
  for (const auto& mode : modes_) scratch_.push_back(mode->fresh());
  x_.setZero(size());
  P_.setZero(size(), size());
  estimate_at(x_.data(), P_.data());
  mode_probabilities_at(&probabilities_);
  out_of_date();
}

void InteractingMultipleModel::begin(const double* x, const double* P) {
  const Eigen::Map<const BoundedMatrix> whole(P, size(), size());
  for (const auto& mode : modes_) {
    const BoundedMatrix beginning = whole.topLeftCorner(mode->size(), mode->size());
    mode->begin(x, beginning.data());
  }
  probabilities_ = predicted_ = chain_.initial;
  out_of_date();
}

StepStatus InteractingMultipleModel::predict(double dt_s) {
  const ModeMatrix Pi = chain_.over(dt_s);
  const ModeVector c = Pi.transpose() * probabilities_;
  mix_all(Pi, c);
  for (const auto& mode : scratch_)
    if (mode->predict(dt_s) == StepStatus::failed) return StepStatus::failed;
  modes_.swap(scratch_);
  predicted_ = probabilities_ = c;
  out_of_date();
  return StepStatus::ok;
}

void InteractingMultipleModel::mix_all(const ModeMatrix& Pi, const ModeVector& c) {
  for (Eigen::Index j = 0; j < mode_count(); ++j) {
    ModeVector weights = Pi.col(j).cwiseProduct(probabilities_);
    if (c[j] > 0.0)
      weights /= c[j];
    else
      weights = ModeVector::Unit(mode_count(), j);  // a mode that cannot be entered keeps to itself
    const TrackedState& own = *modes_[static_cast<std::size_t>(j)];
    with_count(own.size(), [&]<int N>(std::integral_constant<int, N>) {
      if constexpr (N > 0) mix<N>(weights, modes_, own, *scratch_[static_cast<std::size_t>(j)]);
    });
  }
}

StepStatus InteractingMultipleModel::update(const AnyMeasurement& measurement, const StateUpdateTarget& combined) {
  ModeVector log_weight(mode_count());
  for (std::size_t j = 0; j < modes_.size(); ++j) {
    scratch_[j]->assign(*modes_[j]);
    const StepStatus status = scratch_[j]->update(measurement, updates_[j]);
    const double likelihood = log_density_of(updates_[j]);
    const bool valid = status == StepStatus::ok && std::isfinite(likelihood);
    const auto place = static_cast<Eigen::Index>(j);
    log_weight[place] = valid ? std::log(predicted_[place]) + likelihood : -kInfinity;
  }
  mixture_of_innovations(log_weight, combined);
  const double largest = log_weight.maxCoeff();
  if (!(largest > -kInfinity) || !std::isfinite(combined.nis)) return StepStatus::failed;
  modes_.swap(scratch_);
  probabilities_ = (log_weight.array() - largest).exp();
  probabilities_ /= probabilities_.sum();
  predicted_ = probabilities_;
  for (std::size_t j = 0; j < modes_.size(); ++j)
    if (probabilities_[static_cast<Eigen::Index>(j)] > 0.0)
      combined.K.topRows(modes_[j]->size()) += probabilities_[static_cast<Eigen::Index>(j)] * updates_[j].K;
  out_of_date();
  return StepStatus::ok;
}

// nu, S and NIS of the mixture of the predictions of the modes that have not failed.
void InteractingMultipleModel::mixture_of_innovations(const ModeVector& log_weight,
                                                      const StateUpdateTarget& combined) const {
  const Eigen::Index m = updates_.front().nu.size();
  combined.nu.setZero(m);
  combined.S.setZero(m, m);
  combined.K.setZero(size(), m);
  double total = 0.0;
  for (Eigen::Index j = 0; j < mode_count(); ++j) {
    if (!std::isfinite(log_weight[j])) continue;
    total += predicted_[j];
    combined.nu += predicted_[j] * updates_[static_cast<std::size_t>(j)].nu;
  }
  combined.nu /= total;
  for (Eigen::Index j = 0; j < mode_count(); ++j) {
    if (!std::isfinite(log_weight[j])) continue;
    const StateUpdate& update = updates_[static_cast<std::size_t>(j)];
    const BoundedVector d = update.nu - combined.nu;
    const double weight = predicted_[j] / total;
    for (Eigen::Index col = 0; col < m; ++col)
      for (Eigen::Index row = 0; row < m; ++row)
        combined.S(row, col) += weight * (update.S(row, col) + d[row] * d[col]);
  }
  combined.nis = mahalanobis_squared(combined.S, combined.nu);
}

void InteractingMultipleModel::refresh() const {
  up_to_date();
  const int n = size();
  double* x = x_.data();
  double* P = P_.data();
  std::fill_n(x, n, 0.0);
  std::fill_n(P, n * n, 0.0);
  for (std::size_t j = 0; j < modes_.size(); ++j) {
    const double weight = probabilities_[static_cast<Eigen::Index>(j)];
    for (int i = 0; i < modes_[j]->size(); ++i) x[i] += weight * modes_[j]->x_data()[i];
  }
  for (std::size_t j = 0; j < modes_.size(); ++j) {
    const double weight = probabilities_[static_cast<Eigen::Index>(j)];
    const int length = modes_[j]->size();
    const double* mode_x = modes_[j]->x_data();
    const double* mode_P = modes_[j]->P_data();
    double d[kMaxDimension];
    for (int i = 0; i < n; ++i) d[i] = (i < length ? mode_x[i] : 0.0) - x[i];
    for (int col = 0; col < n; ++col) {
      const double across = d[col];
      double* column = P + col * n;
      for (int row = 0; row < n; ++row) column[row] += weight * d[row] * across;
      if (col < length)
        for (int row = 0; row < length; ++row) column[row] += weight * mode_P[col * length + row];
    }
  }
}

void InteractingMultipleModel::assign(const TrackedState& other) {
  const auto& same = static_cast<const InteractingMultipleModel&>(other);
  for (std::size_t j = 0; j < modes_.size(); ++j) modes_[j]->assign(*same.modes_[j]);
  probabilities_ = same.probabilities_;
  predicted_ = same.predicted_;
  out_of_date();
}

std::unique_ptr<TrackedState> InteractingMultipleModel::fresh() const {
  Modes modes;
  for (const auto& mode : modes_) modes.push_back(mode->fresh());
  return std::make_unique<InteractingMultipleModel>(std::move(modes), chain_);
}

}  // namespace truebearing
