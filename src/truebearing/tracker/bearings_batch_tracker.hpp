// Batch target-motion analysis as a Tracker: bearings are collected in a growing or sliding window, and the estimate is
// made afresh from all of them. Between solutions, and while bearings are missing, the last one is carried on at
// constant velocity (`coasted`). Where the geometry does not determine the range its records say `unobservable`.
#pragma once

#include <limits>
#include <optional>
#include <variant>
#include <vector>

#include "truebearing/tma/bearings_only_batch.hpp"
#include "truebearing/tma/cho_2015.hpp"
#include "truebearing/tma/range_prior.hpp"
#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

struct BearingsBatchOptions {
  std::variant<BearingsOnlyBatchOptions, ChoOptions> method;
  /// Maximum a posteriori instead of maximum likelihood; a range_m of 0: of the velocity only. Without a guess that
  /// it needs nothing is solved.
  std::optional<RangePrior> prior;
  double sigma_rad = 0.0;  ///< where a measurement carries none
  double sigma_factor = 1.0;
  double window_s = std::numeric_limits<double>::infinity();
  /// Solve at the first step at or after each of these; else every so many seconds, 0: at every step.
  std::vector<double> solve_at_s;
  double solve_every_s = 0.0;
  bool warm_start = false;  ///< from the solution before, besides the usual starts
  /// Look for a change of the target's velocity inside the window after each solution (residual_checks.hpp) that knows
  /// the range; where there is one, forget what was before it.
  bool cut_at_manoeuvres = false;
};

class BearingsBatchTracker final : public Tracker {
 public:
  explicit BearingsBatchTracker(BearingsBatchOptions options);

  std::span<const StepRecord> step(const Measurement& measurement) override;
  void reset() override;
  std::unique_ptr<Tracker> clone() const override { return std::make_unique<BearingsBatchTracker>(options_); }
  const StateSpace& space() const override { return plane_space(); }
  TrackerCounts counts() const override { return guard_.counts; }

  /// Times at which a change of velocity was noticed since reset(), where the options ask for it.
  const std::vector<double>& manoeuvres_s() const { return manoeuvres_s_; }

 private:
  void believe(const Measurement& first, double sigma_rad, const SensorState& sensor);
  void add(const Measurement& measurement);
  bool is_due(double time_s);
  BatchEstimate solve();
  void cut_at_manoeuvre();

  BearingsBatchOptions options_;
  BearingsOnlyBatch solver_;
  StreamGuard guard_;
  BearingWindow window_;
  std::optional<TargetGuess> guess_;
  std::optional<BatchPrior> prior_;  // of the track, from its first bearing
  BatchEstimate estimate_;           // the last that was found
  std::vector<double> manoeuvres_s_;
  std::size_t solved_ = 0;  // of solve_at_s
  double due_s_ = -std::numeric_limits<double>::infinity();
  StepRecord record_;
};

}  // namespace truebearing
