// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/recorded_tracker.hpp"

#include <utility>

namespace truebearing {
namespace {

constexpr double kTimeTolerance_s = 1e-6;

}  // namespace

RecordedTracker::RecordedTracker(StepLog log)
    : space_(log.space), innovation_(log.has_innovation), log_(std::make_shared<const StepLog>(std::move(log))) {}

std::span<const StepRecord> RecordedTracker::step(const Measurement& measurement) {
  if (!log_) {
    if (!measurement.recorded || measurement.recorded->space != space_) return {};
    return {measurement.recorded, 1};
  }
  const std::vector<StepRecord>& records = log_->records;
  while (next_ < records.size() && records[next_].time_s < measurement.time_s - kTimeTolerance_s) ++next_;
  const std::size_t first = next_;
  while (next_ < records.size() && records[next_].time_s <= measurement.time_s + kTimeTolerance_s) ++next_;
  return {records.data() + first, next_ - first};
}

std::unique_ptr<Tracker> RecordedTracker::fresh() const {
  auto copy = std::make_unique<RecordedTracker>(*this);
  copy->reset();
  return copy;
}

}  // namespace truebearing
