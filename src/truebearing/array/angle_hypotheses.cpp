// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/angle_hypotheses.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace truebearing {
namespace {

// More children of one interval than these are not looked at.
constexpr int kMostChildren = 48;

}  // namespace

void AngleHypotheses::begin(const Options& options, const JointAngleState& state) {
  options_ = options;
  hypotheses_.resize(static_cast<std::size_t>(options.beam));
  children_.resize(options.beam == 1 ? 1 : kMostChildren);
  order_.reserve(children_.size());
  hypotheses_.front() = {state, state, 0.0};
  count_ = 1;
}

AngleHypothesis& AngleHypotheses::next_child() {
  return children_[static_cast<std::size_t>(child_count_)];
}

// False where that fails, or where the child is the sibling again.
bool AngleHypotheses::score(const AngleHypothesis& parent, const JointAngleState& prior, const RealInterval& interval,
                            double middle_s, const SignalVector& start, const AngleHypothesis* sibling,
                            AngleHypothesis& child) {
  const int N = prior.targets();
  if (!update_.find_mode(prior, interval, middle_s, start, options_.update)) return false;
  if (sibling && !((update_.mode().head(N) - sibling->state.x.head(N)).cwiseAbs().maxCoeff() >= options_.new_rad))
    return false;
  if (!update_.give_posterior(prior, child.state)) return false;
  child.prior = prior;
  child.log_weight = parent.log_weight + update_.log_evidence();
  adapt(options_.motion, prior, child.state);
  return std::isfinite(child.log_weight);
}

bool AngleHypotheses::update(const RealInterval& interval, double dt_s, double middle_s) {
  child_count_ = 0;
  for (int h = 0; h < count_; ++h) {
    const AngleHypothesis& parent = hypothesis(h);
    if (child_count_ == static_cast<int>(children_.size())) break;
    AngleHypothesis& child = next_child();
    JointAngleState prior = parent.state;
    predict(prior, options_.motion, dt_s);
    if (!update_.take_prior(prior) ||
        !score(parent, prior, interval, middle_s, prior.x.head(2 * prior.targets()), nullptr, child))
      continue;
    ++child_count_;
    if (options_.beam > 1) add_children(parent, prior, child, interval, middle_s);
  }
  if (child_count_ == 0) return false;
  keep_best();
  return true;
}

void AngleHypotheses::add_children(const AngleHypothesis& parent, const JointAngleState& prior,
                                   const AngleHypothesis& first, const RealInterval& interval, double middle_s) {
  const int N = prior.targets();
  for (int i = 0; i < N; ++i)
    for (int j = i + 1; j < N; ++j) {
      if (child_count_ == static_cast<int>(children_.size())) return;
      const double distance = std::abs(prior.angle(i) - prior.angle(j));
      const double variance = prior.P(i, i) + prior.P(j, j) - 2.0 * prior.P(i, j);
      const double close = std::max(options_.close_rad, options_.close_sigmas * std::sqrt(std::max(variance, 0.0)));
      if (distance > std::min(close, options_.reach_rad)) continue;
      SignalVector exchanged = first.state.x.head(2 * N);
      std::swap(exchanged[i], exchanged[j]);
      std::swap(exchanged[N + i], exchanged[N + j]);
      AngleHypothesis& child = next_child();
      if (score(parent, prior, interval, middle_s, exchanged, &first, child)) ++child_count_;
    }
}

// Whoever is called which: targets are compared in the order of their angles. Two that agree in this way will go on to
// explain everything equally well, and what has been learnt by then decides between them.
bool AngleHypotheses::is_same(const AngleHypothesis& a, const AngleHypothesis& b) const {
  const int N = a.state.targets(), r = 2 * N;
  std::array<int, kMaxSignals> in_a, in_b;
  order_of_angles(a.state, in_a);
  order_of_angles(b.state, in_b);
  for (int n = 0; n < N; ++n) {
    const int i = in_a[static_cast<std::size_t>(n)], j = in_b[static_cast<std::size_t>(n)];
    const double angle = std::abs(a.state.x[i] - b.state.x[j]), rate = std::abs(a.state.x[r + i] - b.state.x[r + j]);
    if (angle > options_.same_rad || rate > options_.same_radps) return false;
    if (angle > options_.same_sigmas * std::sqrt(a.state.P(i, i)) ||
        rate > options_.same_sigmas * std::sqrt(a.state.P(r + i, r + i)))
      return false;
  }
  return true;
}

// The best children, those that are the same or far below the best left out, become the hypotheses.
void AngleHypotheses::keep_best() {
  order_.clear();
  for (int c = 0; c < child_count_; ++c) order_.push_back(c);
  const auto child = [&](int c) -> AngleHypothesis& { return children_[static_cast<std::size_t>(c)]; };
  std::sort(order_.begin(), order_.end(), [&](int a, int b) {
    return child(a).log_weight != child(b).log_weight ? child(a).log_weight > child(b).log_weight : a < b;
  });
  const double best = child(order_.front()).log_weight;
  count_ = 0;
  for (const int c : order_) {
    if (count_ == options_.beam || child(c).log_weight < best - options_.drop_log_weight) break;
    bool known = false;
    for (int h = 0; h < count_ && !known; ++h) known = is_same(hypothesis(h), child(c));
    if (known) continue;
    AngleHypothesis& kept = hypotheses_[static_cast<std::size_t>(count_++)];
    std::swap(kept, child(c));
    kept.log_weight -= best;
  }
}

}  // namespace truebearing
