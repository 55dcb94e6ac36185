// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/separate_modes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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

  InSpaceOf(const TrackedState& own, const ModeBank::Modes& modes) {
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
void mix_into(const ModeVector& weights, const ModeBank::Modes& modes, const TrackedState& own, TrackedState& mixed) {
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

}  // namespace

SeparateModes::SeparateModes(Modes modes) : modes_(std::move(modes)), updates_(modes_.size()) {
  for (const auto& mode : modes_) {
    scratch_.push_back(mode->fresh());
    states_ = std::max(states_, mode->size());
  }
}

void SeparateModes::begin(const double* x, const double* P, int n) {
  const Eigen::Map<const BoundedMatrix> whole(P, n, n);
  for (const auto& mode : modes_) {
    const BoundedMatrix beginning = whole.topLeftCorner(mode->size(), mode->size());
    mode->begin(x, beginning.data());
  }
}

bool SeparateModes::mix_and_predict(const ModeMatrix& weights, double dt_s) {
  for (std::size_t j = 0; j < modes_.size(); ++j)
    with_count(modes_[j]->size(), [&]<int N>(std::integral_constant<int, N>) {
      if constexpr (N > 0) mix_into<N>(weights.col(static_cast<Eigen::Index>(j)), modes_, *modes_[j], *scratch_[j]);
    });
  for (const auto& mode : scratch_)
    if (mode->predict(dt_s) == StepStatus::failed) return false;
  modes_.swap(scratch_);
  return true;
}

void SeparateModes::update(const AnyMeasurement& measurement, ModeVector& log_likelihood) {
  log_likelihood.resize(static_cast<Eigen::Index>(modes_.size()));
  for (std::size_t j = 0; j < modes_.size(); ++j) {
    scratch_[j]->assign(*modes_[j]);
    const StepStatus status = scratch_[j]->update(measurement, updates_[j]);
    const double likelihood = log_density_of(updates_[j]);
    log_likelihood[static_cast<Eigen::Index>(j)] =
        status == StepStatus::ok && std::isfinite(likelihood) ? likelihood : -kInfinity;
  }
}

void SeparateModes::keep() {
  modes_.swap(scratch_);
}

void SeparateModes::mix_innovations(const ModeVector& weights, BoundedVector& nu, BoundedMatrix& S) const {
  const Eigen::Index m = updates_.front().nu.size();
  nu.setZero(m);
  S.setZero(m, m);
  for (std::size_t j = 0; j < updates_.size(); ++j)
    if (const double weight = weights[static_cast<Eigen::Index>(j)]; weight > 0.0) nu += weight * updates_[j].nu;
  for (std::size_t j = 0; j < updates_.size(); ++j) {
    const double weight = weights[static_cast<Eigen::Index>(j)];
    if (!(weight > 0.0)) continue;
    const BoundedVector d = updates_[j].nu - nu;
    for (Eigen::Index col = 0; col < m; ++col)
      for (Eigen::Index row = 0; row < m; ++row) S(row, col) += weight * (updates_[j].S(row, col) + d[row] * d[col]);
  }
}

void SeparateModes::mix_gains(const ModeVector& weights, BoundedMatrix& K) const {
  K.setZero(states_, updates_.front().nu.size());
  for (std::size_t j = 0; j < modes_.size(); ++j)
    if (const double weight = weights[static_cast<Eigen::Index>(j)]; weight > 0.0)
      K.topRows(modes_[j]->size()) += weight * updates_[j].K;
}

void SeparateModes::mix(const ModeVector& weights, double* x, double* P) const {
  const int n = states_;
  std::fill_n(x, n, 0.0);
  std::fill_n(P, n * n, 0.0);
  for (std::size_t j = 0; j < modes_.size(); ++j) {
    const double weight = weights[static_cast<Eigen::Index>(j)];
    for (int i = 0; i < modes_[j]->size(); ++i) x[i] += weight * modes_[j]->x_data()[i];
  }
  for (std::size_t j = 0; j < modes_.size(); ++j) {
    const double weight = weights[static_cast<Eigen::Index>(j)];
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

void SeparateModes::assign(const ModeBank& other) {
  const auto& same = static_cast<const SeparateModes&>(other);
  for (std::size_t j = 0; j < modes_.size(); ++j) modes_[j]->assign(*same.modes_[j]);
}

std::unique_ptr<ModeBank> SeparateModes::fresh() const {
  Modes modes;
  for (const auto& mode : modes_) modes.push_back(mode->fresh());
  return std::make_unique<SeparateModes>(std::move(modes));
}

}  // namespace truebearing
