// SPDX-License-Identifier: Apache-2.0
// The Bayes limit of a target that turns at most once, as the filter behind a batch estimate of a passive sonar: when,
// how fast, how far and to which side it turns is drawn from a known family, all else about its motion is certain. Each
// hypothesis is such a turn and, given that, an extended Kalman filter without process noise of [p (2), v (2), f0]. At
// every step the target that has not turned yet begins turns that are spread evenly over the family, and each that turns
// parts into one that ends now and one that goes on; of these the likely ones are kept and the others thinned without
// bias (Fearnhead and Clifford 2003).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/simulation/vessel.hpp"
#include "truebearing/tracker/bearing_frequency_sensor.hpp"
#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/successor.hpp"

namespace truebearing {

struct TurnLimitOptions {
  VesselParameters::Turn turn;  ///< by an angle
  BearingFrequencySensor sensor{};
  int hypotheses = 2000;  ///< that are kept; a step begins a tenth as many turns
  std::uint64_t seed = 1;
};

class TurnLimit final : public Successor {
 public:
  /// Throws std::invalid_argument where the turn is to a course, or there are fewer than ten hypotheses.
  explicit TurnLimit(TurnLimitOptions options);

  std::span<const StepRecord> step(const Measurement& measurement) override;
  void reset() override;
  /// Before any turn of the family may have begun. x [p, v, f0] (5).
  void take_over(double time_s, const BoundedVector& x, const BoundedMatrix& P) override;
  bool is_lost() const override { return hypotheses_.empty(); }
  std::unique_ptr<Tracker> fresh() const override { return std::make_unique<TurnLimit>(options_); }
  const StateSpace& space() const override { return plane_space(); }
  std::optional<Measured> measures() const override { return options_.sensor.measured(); }
  /// Modes: straight, turning.
  RecordBlocks blocks() const override { return {.mode_probabilities = true}; }
  TrackerCounts counts() const override { return guard_.counts; }

 private:
  enum class Phase { before, turning, after };
  struct Hypothesis {
    KalmanFilter<5> filter;
    double weight;  // sums to 1 over all
    Phase phase = Phase::before;
    double rate_radps = 0.0;  // positive to starboard
    double turned_deg = 0.0;  // so far, >= 0
  };

  void move(double time_s);
  void wait(const Hypothesis& waiting, double time_s);
  void turn(Hypothesis turning, double dt_s);
  void carry(Hypothesis hypothesis, double turning_s, double straight_s);
  bool weigh(const Measurement& measurement);
  void thin();
  void publish(StepStatus status, const std::vector<Hypothesis>& of);

  TurnLimitOptions options_;
  StreamGuard guard_;
  RandomStream stream_;
  double time_s_ = 0.0;  // of the last used measurement
  std::vector<Hypothesis> hypotheses_, moved_;
  std::vector<double> weights_;
  StepRecord record_;
};

}  // namespace truebearing
