// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/smoothing_tracker.hpp"

#include <stdexcept>
#include <utility>

#include "truebearing/core/covariance.hpp"

namespace truebearing {

SmoothingTracker::SmoothingTracker(std::unique_ptr<FilterTracker> filter, double lag_s)
    : Smoother(filter->space()), filter_(std::move(filter)), lag_s_(lag_s), backward_(filter_->state()) {
  if (filter_->options().output_pull > 0.0 || filter_->options().ahead_s > 0.0)
    throw std::invalid_argument("a smoother is of what a filter estimates, without output_pull or ahead_s");
  if (!(lag_s_ > 0.0)) throw std::invalid_argument("a lag is above 0");
  for (const ModeEstimate& mode : estimates_of(filter_->state()).modes)
    lengths_.push_back(static_cast<int>(mode.x.size()));
}

std::unique_ptr<Tracker> SmoothingTracker::fresh() const {
  std::unique_ptr<Tracker> filter = filter_->fresh();
  return std::make_unique<SmoothingTracker>(
      std::unique_ptr<FilterTracker>(static_cast<FilterTracker*>(filter.release())), lag_s_);
}

void SmoothingTracker::reset() {
  filter_->reset();
  forget();
  knots_.clear();
}

void SmoothingTracker::foresee(std::span<const Measurement> measurements) {
  reset();
  for (const Measurement& measurement : measurements) take(measurement);
  if (lag_s_ == kInfinity) {
    smooth_interval();
  } else {
    for (std::optional<Step>& step : steps_)
      if (step && step->can_look_back) smooth_with_lag(*step);
  }
  begin_replay();
}

void SmoothingTracker::add_knot(double time_s, bool begins, double widened) {
  const ModeEstimates filtered = estimates_of(filter_->state());
  const bool broken = widened != 1.0 && filtered.modes.size() > 1;
  Knot& knot = knots_.emplace_back(Knot{time_s, {}, filtered.mu, begins || broken, widened});
  for (const ModeEstimate& mode : filtered.modes) {
    knot.filtered.insert(knot.filtered.end(), mode.x.begin(), mode.x.end());
    knot.filtered.insert(knot.filtered.end(), mode.P.data(), mode.P.data() + mode.P.size());
  }
}

ModeEstimates SmoothingTracker::filtered(std::size_t knot) const {
  ModeEstimates estimates{{}, knots_[knot].mu};
  const double* next = knots_[knot].filtered.data();
  for (const int n : lengths_) {
    estimates.modes.push_back(
        {Eigen::Map<const BoundedVector>(next, n), Eigen::Map<const BoundedMatrix>(next + n, n, n)});
    next += n + n * n;
  }
  return estimates;
}

void SmoothingTracker::take(const Measurement& measurement) {
  // A track that begins with a prior has a state before its first measurement.
  if (knots_.empty() && !filter_->is_lost()) add_knot(filter_->used_time_s(), true, 1.0);
  const std::span<const StepRecord> records = filter_->step(measurement);
  const FilterTracker::Passage& passage = filter_->passage();
  if (passage.used)
    add_knot(filter_->used_time_s(), passage.begins, passage.widened);
  else if (passage.begins && !filter_->is_lost())  // and then did not use the measurement
    add_knot(filter_->used_time_s(), true, 1.0);
  Step* const step = add_step(records);
  if (!step) return;
  const StepRecord& record = records.front();
  if (record.innovation) {
    step->account.nis = record.innovation->nis;
    step->account.measured = static_cast<int>(record.innovation->nu.size());
  }
  step->is_at_knot = passage.used;
  step->is_as_before = record.status == StepStatus::rejected && !record.prediction;
  step->can_look_back = !knots_.empty() && !step->is_as_before && record.status != StepStatus::failed;
  if (!knots_.empty()) step->knot = knots_.size() - 1;
}

// Whether a later knot belongs to the same track.
bool SmoothingTracker::goes_on(std::size_t knot) const {
  return knot + 1 < knots_.size() && !knots_[knot + 1].begins;
}

// The smoothed estimate at a knot, from that at the next.
std::optional<ModeEstimates> SmoothingTracker::passed(std::size_t knot, const ModeEstimates& next) {
  const Knot& to = knots_[knot + 1];
  return backward_.smoothed(filtered(knot), to.time_s - knots_[knot].time_s, next, to.widened);
}

// The same at a step behind its knot, from the filter's prediction there.
std::optional<ModeEstimates> SmoothingTracker::at(const Step& step, const ModeEstimates& next) {
  if (step.is_at_knot) return passed(step.knot, next);
  const Knot &from = knots_[step.knot], &to = knots_[step.knot + 1];
  const std::optional<ModeEstimates> there = backward_.predicted(filtered(step.knot), step.time_s - from.time_s);
  return there ? backward_.smoothed(*there, to.time_s - step.time_s, next, to.widened) : std::nullopt;
}

void SmoothingTracker::smooth_interval() {
  ModeEstimates next;  // smoothed, at knot `done`; the filter's own where that came to nothing
  bool is_smoothed = false;
  std::size_t done = knots_.size();
  const auto reach = [&](std::size_t knot) {
    while (done > knot) {
      --done;
      std::optional<ModeEstimates> smoothed;
      if (goes_on(done)) smoothed = passed(done, next);
      is_smoothed = smoothed.has_value();
      next = smoothed ? std::move(*smoothed) : filtered(done);
    }
  };
  for (std::size_t i = steps_.size(); i-- > 0;) {
    std::optional<Step>& step = steps_[i];
    if (!step || !step->can_look_back || !goes_on(step->knot)) continue;
    if (step->is_at_knot) {
      reach(step->knot);
      if (is_smoothed) write(next, *step);
      continue;
    }
    reach(step->knot + 1);
    if (const std::optional<ModeEstimates> smoothed = at(*step, next)) write(*smoothed, *step);
  }
}

void SmoothingTracker::smooth_with_lag(Step& step) {
  std::size_t last = step.knot;
  while (goes_on(last) && knots_[last + 1].time_s <= step.time_s + lag_s_) ++last;
  if (last == step.knot) return;
  ModeEstimates next = filtered(last);
  for (std::size_t knot = last; --knot > step.knot;) {
    std::optional<ModeEstimates> smoothed = passed(knot, next);
    next = smoothed ? std::move(*smoothed) : filtered(knot);
  }
  if (const std::optional<ModeEstimates> smoothed = at(step, next)) write(*smoothed, step);
}

void SmoothingTracker::write(const ModeEstimates& smoothed, Step& step) const {
  const ModeEstimate all = mixture_of(smoothed);
  const int n = space().size();
  if (!all.x.allFinite() || !is_covariance(all.P)) return;
  step.x = all.x.head(n);
  step.P = all.P.topLeftCorner(n, n);
  if (step.mu.size() > 0) step.mu = smoothed.mu;
  step.account.looked_back = true;
}

}  // namespace truebearing
