// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/smoothing_bank.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "truebearing/core/covariance.hpp"

namespace truebearing {

SmoothingBank::SmoothingBank(std::unique_ptr<FilterBank> bank, double lag_s)
    : Smoother(bank->space()), bank_(std::move(bank)), lag_s_(lag_s) {
  if (!(lag_s_ > 0.0)) throw std::invalid_argument("a lag is above 0");
  for (std::size_t i = 0; i < bank_->filters().size(); ++i) backward_.emplace_back(*bank_->filters().state_of(i));
}

std::unique_ptr<Tracker> SmoothingBank::fresh() const {
  std::unique_ptr<Tracker> bank = bank_->fresh();
  return std::make_unique<SmoothingBank>(std::unique_ptr<FilterBank>(static_cast<FilterBank*>(bank.release())), lag_s_);
}

void SmoothingBank::reset() {
  bank_->reset();
  forget();
  knots_.clear();
}

void SmoothingBank::foresee(std::span<const Measurement> measurements) {
  reset();
  if (bank_->has_begun()) add_knot();
  for (const Measurement& measurement : measurements) take(measurement);
  std::vector<Sums> sums(steps_.size());
  // Steps that look back from the same knot do so together: of the fixed interval all of them.
  for (std::size_t begin = 0; begin < steps_.size();) {
    const std::optional<Step>& first = steps_[begin];
    std::size_t end = begin + 1;
    if (first && first->can_look_back) {
      const std::size_t last = last_knot_of(*first);
      while (end < steps_.size() && (!steps_[end] || !steps_[end]->can_look_back || last_knot_of(*steps_[end]) == last))
        ++end;
      for (std::size_t i = 0; i < backward_.size(); ++i) look_back(i, begin, end, last, sums);
    }
    begin = end;
  }
  for (std::size_t k = 0; k < steps_.size(); ++k)
    if (sums[k].weight > 0.0) write(sums[k], *steps_[k]);
  begin_replay();
}

void SmoothingBank::add_knot() {
  const FilterGroup& filters = bank_->filters();
  const std::span<const double> logs = bank_->log_weights();
  Knot& knot = knots_.emplace_back(Knot{bank_->used_time_s(), {}, {}});
  const double largest = *std::max_element(logs.begin(), logs.end());
  double total = 0.0;
  BoundedVector x;
  BoundedMatrix P;
  for (std::size_t i = 0; i < filters.size(); ++i) {
    filters.estimate(i, x, P);
    knot.filtered.insert(knot.filtered.end(), x.begin(), x.end());
    knot.filtered.insert(knot.filtered.end(), P.data(), P.data() + P.size());
    knot.weights.push_back(std::exp(logs[i] - largest));
    total += knot.weights.back();
  }
  for (double& weight : knot.weights) weight /= total;
}

void SmoothingBank::take(const Measurement& measurement) {
  const std::span<const StepRecord> records = bank_->step(measurement);
  if (bank_->has_used()) add_knot();
  Step* const step = add_step(records);
  if (!step) return;
  const StepRecord& record = records.front();
  step->is_at_knot = bank_->has_used();
  step->is_as_before = record.status == StepStatus::rejected;
  step->can_look_back = !knots_.empty() && !step->is_as_before && record.status != StepStatus::failed;
  if (!knots_.empty()) step->knot = knots_.size() - 1;
}

std::size_t SmoothingBank::last_knot_of(const Step& step) const {
  if (lag_s_ == kInfinity) return knots_.size() - 1;
  std::size_t last = step.knot;
  while (last + 1 < knots_.size() && knots_[last + 1].time_s <= step.time_s + lag_s_) ++last;
  return last;
}

ModeEstimates SmoothingBank::filtered(std::size_t knot, std::size_t member) const {
  const int n = bank_->filters().states();
  const double* x = knots_[knot].filtered.data() + member * static_cast<std::size_t>(n + n * n);
  return {{{Eigen::Map<const BoundedVector>(x, n), Eigen::Map<const BoundedMatrix>(x + n, n, n)}}, ModeVector::Ones(1)};
}

// One member's smoothed estimates at the steps of [first_step, end_step), from that knot backwards, into their sums.
void SmoothingBank::look_back(std::size_t member, std::size_t first_step, std::size_t end_step, std::size_t last,
                              std::vector<Sums>& sums) {
  const double weight = knots_[last].weights[member];
  if (!(weight > 0.0)) return;
  BackwardStep& backward = backward_[member];
  std::size_t done = last;
  ModeEstimates next = filtered(last, member);  // at knot `done`, smoothed
  for (std::size_t k = end_step; k-- > first_step;) {
    if (!steps_[k] || !steps_[k]->can_look_back || steps_[k]->knot >= last) continue;
    const Step& step = *steps_[k];
    for (const std::size_t target = step.is_at_knot ? step.knot : step.knot + 1; done > target;) {
      --done;
      ModeEstimates here = filtered(done, member);
      const double dt_s = knots_[done + 1].time_s - knots_[done].time_s;
      std::optional<ModeEstimates> smoothed = backward.smoothed(here, dt_s, next);
      next = smoothed ? std::move(*smoothed) : std::move(here);
    }
    if (step.is_at_knot) {
      add(next.modes[0], weight, step, sums[k]);
      continue;
    }
    // Behind its knot, from the filter's prediction there.
    const auto there = backward.predicted(filtered(step.knot, member), step.time_s - knots_[step.knot].time_s);
    if (!there) continue;
    const auto smoothed = backward.smoothed(*there, knots_[step.knot + 1].time_s - step.time_s, next);
    add(smoothed ? smoothed->modes[0] : there->modes[0], weight, step, sums[k]);
  }
}

void SmoothingBank::add(const ModeEstimate& member, double weight, const Step& step, Sums& sums) const {
  const Eigen::Index n = space().size();
  const BoundedVector d = member.x.head(n) - step.x;
  if (sums.weight == 0.0) {
    sums.first.setZero(n);
    sums.second.setZero(n, n);
  }
  sums.weight += weight;
  sums.first += weight * d;
  sums.second += weight * (member.P.topLeftCorner(n, n) + d * d.transpose());
}

void SmoothingBank::write(const Sums& sums, Step& step) const {
  const BoundedVector d = sums.first / sums.weight;
  const BoundedVector x = step.x + d;
  const BoundedMatrix P = sums.second / sums.weight - d * d.transpose();
  if (!x.allFinite() || !is_covariance(P)) return;
  step.x = x;
  step.P = P;
  step.account.looked_back = true;
}

}  // namespace truebearing
