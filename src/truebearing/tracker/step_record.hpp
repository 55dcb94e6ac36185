// SPDX-License-Identifier: Apache-2.0
// StepRecord, the hub of the house: what one tracker did with one measurement for one target. A core that every tracker
// fills, and optional blocks that say whether they are there. Absent is absent, never faked. No heap.
#pragma once

#include <optional>

#include "truebearing/core/bounded.hpp"
#include "truebearing/core/state_space.hpp"
#include "truebearing/core/status.hpp"
#include "truebearing/measurement/measurement.hpp"

namespace truebearing {

/// The state before the measurement was used: x_{k|k-1} (n), P_{k|k-1} (n x n).
struct Prediction {
  BoundedVector x;
  BoundedMatrix P;
};

/// The measurement z (m), the innovation nu = residual(z, h(x_pred)) (m), its covariance S (m x m), NIS = nu' S^-1 nu.
struct Innovation {
  BoundedVector z;
  BoundedVector nu;
  BoundedMatrix S;
  double nis = 0.0;
};

/// What a correction did: how far the gate was open, whether kappa limited it, how far it moved the reference; and the
/// base estimate that it started from.
struct CorrectionOutcome {
  double gate = 0.0;             ///< g in [0, 1]; the mean over the state where positions and velocities have their own
  bool limited = false;          ///< limit_kappa shortened the correction, or turned a non-finite one into zero
  double distance_sigmas = 0.0;  ///< Mahalanobis distance of the published estimate from what was trusted, its P
  double handed_over = 0.0;      ///< the fallback's share of what was trusted, in [0, 1]: 0 the reference alone
  BoundedVector base_x;          ///< (n); empty where the base gave no estimate, and the reference stands
  BoundedMatrix base_P;          ///< (n x n); likewise
};

/// How a batch estimator came to its estimate (tma/).
struct BatchOutcome {
  double cost = 0.0;   ///< 1/2 sum of squared normalised residuals at the estimate, without a prior's share
  int iterations = 0;  ///< of the start that won
  int starts = 0;
  int non_finite_starts = 0;  ///< of them, those that ended in numbers that are not finite
};

/// The nearest other target that the tracker follows.
struct Neighbour {
  int track = 0;
  BoundedVector difference;  ///< its estimate minus this one (n)
  double closeness =
      0.0;  ///< 1 / (1 + s^2), s the distance in what the sensor can resolve: in (0, 1], 1 at the same place
  bool merged = false;  ///< so close that the measurement cannot tell the two apart
};

struct StepRecord {
  int track = 0;
  double time_s = 0.0;
  StepStatus status = StepStatus::ok;
  const StateSpace* space = nullptr;  ///< components and units of x; lives as long as the program
  BoundedVector x;                    ///< estimate (n)
  BoundedMatrix P;                    ///< its covariance (n x n)

  // Of the tracker that filled the record: one that is corrected predicts, innovates and gains nothing of its own, and
  // what its base did stands in the base's record.
  std::optional<Prediction> prediction;
  std::optional<Innovation> innovation;
  std::optional<BoundedMatrix> gain;             ///< K (n x m)
  std::optional<ModeVector> mode_probabilities;  ///< of a multiple-model tracker
  std::optional<SensorState> sensor;
  int source = 0;                               ///< which sensor took the measurement; see Measurement
  std::optional<Neighbour> neighbour;           ///< of a tracker of several targets, where it follows another
  std::optional<CorrectionOutcome> correction;  ///< of a corrected tracker
  std::optional<BatchOutcome> batch;            ///< of a batch estimator, at steps at which it solved
};

}  // namespace truebearing
