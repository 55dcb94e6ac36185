// SPDX-License-Identifier: Apache-2.0
// SmoothingTracker makes a smoother of a FilterTracker (filter/backward_step.hpp). Told of all measurements of a run
// (foresee), it lets the filter run over them, looks back from their end, and says in step() what it came to: of a fixed
// interval by all of them, of a fixed lag by those up to lag_s after the step, so that whoever follows a target as it
// comes could publish the same records lag_s late. A step stays the filter's own where nothing later belongs to its
// track: at the end, before a track that began anew, where the gate let another take over (of a multiple model also where
// it widened), where the filter failed, and where looking back came to no covariance. Not told of them, it is the filter.
//
// Its records have no prediction, innovation or gain, which are the filter's. Coasted and rejected steps are smoothed
// from the filter's prediction there.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/filter/backward_step.hpp"
#include "truebearing/tracker/filter_tracker.hpp"
#include "truebearing/tracker/smoother.hpp"

namespace truebearing {

class SmoothingTracker final : public Smoother {
 public:
  /// lag_s > 0, infinite for the fixed interval. Throws std::invalid_argument where the filter publishes something other
  /// than its estimate: with output_pull or ahead_s.
  explicit SmoothingTracker(std::unique_ptr<FilterTracker> filter, double lag_s = kInfinity);

  void foresee(std::span<const Measurement> measurements) override;
  void reset() override;
  std::unique_ptr<Tracker> fresh() const override;

  const StateSpace& space() const override { return filter_->space(); }
  std::optional<Measured> measures() const override { return filter_->measures(); }
  RecordBlocks blocks() const override { return {.mode_probabilities = filter_->blocks().mode_probabilities}; }

 private:
  // An estimate after a measurement, or that a track began with. Kept small: a log may be long.
  struct Knot {
    double time_s;
    std::vector<double> filtered;  // x, P of each mode, one after the other
    ModeVector mu;
    bool begins;  // goes on from no knot before
    double widened;
  };

  Tracker& filter() override { return *filter_; }
  const Tracker& filter() const override { return *filter_; }
  void take(const Measurement& measurement);
  void add_knot(double time_s, bool begins, double widened);
  void smooth_interval();
  void smooth_with_lag(Step& step);
  bool goes_on(std::size_t knot) const;
  ModeEstimates filtered(std::size_t knot) const;
  std::optional<ModeEstimates> passed(std::size_t knot, const ModeEstimates& next);
  std::optional<ModeEstimates> at(const Step& step, const ModeEstimates& next);
  void write(const ModeEstimates& smoothed, Step& step) const;

  std::unique_ptr<FilterTracker> filter_;
  double lag_s_;
  BackwardStep backward_;
  std::vector<int> lengths_;  // of the modes' states
  std::vector<Knot> knots_;
};

}  // namespace truebearing
