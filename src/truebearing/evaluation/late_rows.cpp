// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/late_rows.hpp"

#include <iterator>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

// Measurements between checkpoints, of which a window has at most so many. More of them cost every step, fewer every late
// measurement.
constexpr std::size_t kBetweenCheckpoints = 6;
constexpr double kCheckpoints = 32.0;

constexpr std::size_t kFirstRing = 16;

}  // namespace

LateRows::LateRows(const TrackerSet& trackers, double keep_s) : keep_s_(keep_s), ring_(kFirstRing) {
  if (!(keep_s > 0.0)) throw InputError("late rows", "are kept for no time", "seconds > 0");
  TrackerSet copy = trackers.fresh();
  if (const std::string name = copy.assign(trackers); !name.empty())
    throw InputError("late rows", "cannot be put in order for the tracker \"" + name + "\", which cannot be run again",
                     "trackers of kind kalman, unscented, imm, modified_gain or log_polar and corrections of them, or "
                     "--sort-window");
}

bool LateRows::step(TrackerSet& trackers, const Measurement& measurement, const Publish& publish) {
  const double time_s = measurement.time_s;
  const double newest_s = first_ == end_ ? -kInfinity : kept(end_ - 1).time_s;
  if (!(time_s < newest_s)) {
    insert(end_, measurement);
    run(trackers, end_ - 1, publish, false);
    forget(time_s - keep_s_);
    return true;
  }
  auto after = checkpoints_.end();
  while (after != checkpoints_.begin() && time_s < std::prev(after)->time_s) --after;
  if (time_s < newest_s - keep_s_ || after == checkpoints_.begin()) {
    ++too_late_;
    return false;
  }
  const Checkpoint& from = *std::prev(after);
  const std::size_t begin = from.next;
  trackers.assign(from.trackers);
  spare_.splice(spare_.end(), checkpoints_, after, checkpoints_.end());
  std::size_t number = end_;
  while (number > begin && time_s < kept(number - 1).time_s) --number;
  insert(number, measurement);
  ++taken_;
  for (std::size_t k = begin; k < end_; ++k) {
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
  if (checkpoints_.empty() || (number >= checkpoints_.back().next + kBetweenCheckpoints &&
                               measurement.time_s >= checkpoints_.back().time_s + keep_s_ / kCheckpoints)) {
    if (spare_.empty()) spare_.push_back({trackers.fresh(), 0, 0.0});
    // Nothing is before the first of them.
    const bool is_first = checkpoints_.empty() && number == 0;
    checkpoints_.splice(checkpoints_.end(), spare_, std::prev(spare_.end()));
    Checkpoint& checkpoint = checkpoints_.back();
    checkpoint.next = number;
    checkpoint.time_s = is_first ? -kInfinity : measurement.time_s;
    checkpoint.trackers.assign(trackers);
  }
  trackers.step(measurement);
  publish(measurement, revised);
}

// What no late one can ask for any more: all before the last checkpoint that stands at or before `before_s`.
void LateRows::forget(double before_s) {
  while (checkpoints_.size() > 1 && std::next(checkpoints_.begin())->time_s <= before_s)
    spare_.splice(spare_.end(), checkpoints_, checkpoints_.begin());
  first_ = checkpoints_.front().next;
}

// Those from that number on move up.
void LateRows::insert(std::size_t number, const Measurement& measurement) {
  if (end_ - first_ == ring_.size()) {
    std::vector<Measurement> larger(2 * ring_.size());
    for (std::size_t k = first_; k < end_; ++k) larger[k & (larger.size() - 1)] = std::move(kept(k));
    ring_.swap(larger);
  }
  for (std::size_t k = end_++; k > number; --k) kept(k) = std::move(kept(k - 1));
  kept(number) = measurement;
}

}  // namespace truebearing
