// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/late_rows.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

// Of these a window has so many: running again begins at most a quarter of it too early. More of them cost every step.
constexpr double kCheckpoints = 4.0;

bool is_earlier(double time_s, const Measurement& other) {
  return time_s < other.time_s;
}

}  // namespace

LateRows::LateRows(const TrackerSet& trackers, double keep_s) : keep_s_(keep_s) {
  if (!(keep_s > 0.0)) throw InputError("late rows", "are kept for no time", "seconds > 0");
  TrackerSet copy = trackers.fresh();
  if (const std::string name = copy.assign(trackers); !name.empty())
    throw InputError("late rows", "cannot be put in order for the tracker \"" + name + "\", which cannot be run again",
                     "trackers of kind kalman, unscented, imm, modified_gain or log_polar and corrections of them, or "
                     "--sort-window");
}

bool LateRows::step(TrackerSet& trackers, const Measurement& measurement, const Publish& publish) {
  const double time_s = measurement.time_s;
  if (kept_.empty() || !(time_s < kept_.back().time_s)) {
    kept_.push_back(measurement);
    run(trackers, first_ + kept_.size() - 1, publish, false);
    forget(kept_.back().time_s - keep_s_);
    return true;
  }
  const auto is_after = [](double at_s, const Checkpoint& checkpoint) { return at_s < checkpoint.time_s; };
  const auto after = std::upper_bound(checkpoints_.begin(), checkpoints_.end(), time_s, is_after);
  if (time_s < kept_.back().time_s - keep_s_ || after == checkpoints_.begin()) {
    ++too_late_;
    return false;
  }
  const auto from = std::prev(after);
  const std::size_t begin = from->next;
  trackers.assign(from->trackers);
  for (auto stale = after; stale != checkpoints_.end(); ++stale) spare_.push_back(std::move(stale->trackers));
  checkpoints_.erase(after, checkpoints_.end());
  const auto place = kept_.insert(std::upper_bound(kept_.begin(), kept_.end(), time_s, is_earlier), measurement);
  const std::size_t number = first_ + static_cast<std::size_t>(place - kept_.begin());
  ++taken_;
  for (std::size_t k = begin; k < first_ + kept_.size(); ++k) {
    // Before the late one nothing changes.
    if (k < number)
      trackers.step(kept(k));
    else
      run(trackers, k, publish, k != number);
    again_ += k != number;
  }
  return true;
}

// Takes one of those that are kept, after a checkpoint where one is due.
void LateRows::run(TrackerSet& trackers, std::size_t number, const Publish& publish, bool revised) {
  const Measurement& measurement = kept(number);
  if (checkpoints_.empty() || measurement.time_s >= checkpoints_.back().time_s + keep_s_ / kCheckpoints) {
    if (spare_.empty()) spare_.push_back(trackers.fresh());
    // Nothing is before the first of them.
    const bool is_first = checkpoints_.empty() && number == 0;
    checkpoints_.push_back({std::move(spare_.back()), number, is_first ? -kInfinity : measurement.time_s});
    spare_.pop_back();
    checkpoints_.back().trackers.assign(trackers);
  }
  trackers.step(measurement);
  publish(measurement, revised);
}

// What no late one can ask for any more: all before the last checkpoint that stands at or before `before_s`.
void LateRows::forget(double before_s) {
  while (checkpoints_.size() > 1 && checkpoints_[1].time_s <= before_s) {
    spare_.push_back(std::move(checkpoints_.front().trackers));
    checkpoints_.pop_front();
  }
  while (first_ < checkpoints_.front().next) {
    kept_.pop_front();
    ++first_;
  }
}

}  // namespace truebearing
