// A tracker that ran elsewhere, replayed from its step log, so that it can be corrected and compared without being
// touched.
#pragma once

#include <memory>
#include <vector>

#include "truebearing/tracker/step_log.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

class RecordedTracker final : public Tracker {
 public:
  explicit RecordedTracker(StepLog log);

  /// The log's records of the measurement's time, to a microsecond; none where it has none of that time.
  std::span<const StepRecord> step(const Measurement& measurement) override;
  void reset() override { next_ = 0; }
  std::unique_ptr<Tracker> clone() const override;
  const StateSpace& space() const override { return *log_->space; }
  RecordBlocks blocks() const override { return {.innovation = log_->has_innovation}; }

 private:
  std::shared_ptr<const StepLog> log_;
  std::size_t next_ = 0;
};

}  // namespace truebearing
