// SPDX-License-Identifier: Apache-2.0
// What a FilterTracker says of its state: as much of it as the space of its records has, where it is a track at all;
// ahead of time, or pulled to the measurement, where that is asked for.
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "truebearing/core/with_count.hpp"
#include "truebearing/tracker/filter_tracker.hpp"
#include "truebearing/tracker/publishable.hpp"

namespace truebearing {
namespace {

// Whether x (N), P (N x N) are a track at a place that a target can have, known better than not at all; the first
// `positions` components are its place. Written for few instructions: every step asks twice.
template <int N>
EIGEN_ALWAYS_INLINE bool is_sensible(const Eigen::Matrix<double, N, 1>& x, const Eigen::Matrix<double, N, N>& P,
                                     int positions) {
  Eigen::Matrix<double, N, 1> sums = x;  // not finite where a number is not; several, for none to wait
  for (int j = 0; j < N; ++j) sums += P.col(j);
  double least_variance = P(0, 0);
  for (int i = 1; i < N; ++i) least_variance = std::min(least_variance, P(i, i));
  bool sensible = std::isfinite(sums.sum()) & (least_variance >= 0.0);
  for (int i = 0; i < positions; ++i)
    sensible &= (std::abs(x(i)) <= kFarthest_m) & (P(i, i) <= kFarthest_m * kFarthest_m);
  return sensible;
}

// The first n of N components into x (n), P (n x n). False where it is no track (is_sensible()).
template <int N>
bool copy_first(const double* from_x, const double* from_P, int n, BoundedVector& x, BoundedMatrix& P) {
  const Eigen::Map<const Eigen::Matrix<double, N, 1>> whole_x(from_x);
  const Eigen::Map<const Eigen::Matrix<double, N, N>> whole_P(from_P);
  x = whole_x.head(n);
  P = whole_P.topLeftCorner(n, n);
  return is_sensible<N>(whole_x, whole_P, n / 2);
}

// All of them. They are read once: after that the compiler could not know that x and P are elsewhere.
template <int N>
bool copy_whole(const double* from_x, const double* from_P, int, BoundedVector& x, BoundedMatrix& P) {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;
  const Vector whole_x = Eigen::Map<const Vector>(from_x);
  const Matrix whole_P = Eigen::Map<const Matrix>(from_P);
  x.resize(N);
  P.resize(N, N);
  Eigen::Map<Vector>(x.data()) = whole_x;
  Eigen::Map<Matrix>(P.data()) = whole_P;
  return is_sensible<N>(whole_x, whole_P, N / 2);
}

}  // namespace

// False where the state is no track; what it is stands in the record all the same. Where it cannot be carried so far
// ahead, the record says `failed`, and the filter goes on.
bool FilterTracker::publish() {
  const bool sensible = copy_published(*state_, record_.x, record_.P);
  if (ahead_)
    publish_ahead();
  else if (options_.output_pull > 0.0)
    publish_pulled();
  if (const ModeVector* probabilities = state_->mode_probabilities()) record_.mode_probabilities = *probabilities;
  return sensible;
}

void FilterTracker::publish_ahead() {
  ahead_->assign(*state_);
  const bool crossed = ahead_->predict(options_.ahead_s) == StepStatus::ok;
  if (!copy_published(*ahead_, record_.x, record_.P) || !crossed) record_.status = StepStatus::failed;
}

void FilterTracker::publish_pulled() {
  if (!record_.gain) return;
  record_.x.head(moved_.size()) += moved_;
  record_.P.topLeftCorner(moved_.size(), moved_.size()) += spread_;
}

FilterTracker::Copy FilterTracker::copy_of(int states, int published) {
  Copy copy = nullptr;
  with_count(states,
             [&]<int N>(std::integral_constant<int, N>) { copy = published == N ? copy_whole<N> : copy_first<N>; });
  return copy;
}

// Without the components that the space does not have. False where the state is no track (is_sensible()).
bool FilterTracker::copy_published(const TrackedState& state, BoundedVector& x, BoundedMatrix& P) const {
  return copy_(state.x_data(), state.P_data(), published_, x, P);
}

// The same of a lane of a pack, which has said that it is a track (StatePack::within()).
void FilterTracker::copy_published(const StatePack& pack, int lane, BoundedVector& x, BoundedMatrix& P) const {
  const int n = published_, all = state_->size();
  x.resize(all);
  P.resize(all, all);
  pack.estimate(lane, x.data(), P.data());
  if (n == all) return;
  x.conservativeResize(n);
  P.conservativeResize(n, n);
}

// With the gain K' = K + beta G (I - H K), G = [I; 0], in place of K: the covariance grows by (K' - K) S (K' - K)'.
// H = [I, 0].
void FilterTracker::pull(const AnyMeasurement& taken) {
  with_length(taken, [&]<int M>(const SizedMeasurement<M>& measurement) {
    using Vector = Eigen::Matrix<double, M, 1>;
    using Square = Eigen::Matrix<double, M, M>;
    const Vector position = state_->x().template head<M>();
    const Square S = record_.innovation->S;
    const Square left = Square::Identity() - Square(record_.gain->template topRows<M>());
    moved_ = options_.output_pull * (measurement.z - position);
    spread_ = options_.output_pull * options_.output_pull * left * S * left.transpose();
  });
}

}  // namespace truebearing
