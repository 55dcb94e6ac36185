// SPDX-License-Identifier: Apache-2.0
// The referee: which of two estimates has lately foretold the measurements better, the corrected one or the reference?
// Both are carried one and more steps ahead at constant velocity and compared with the measured positions. Positions and
// velocities are judged apart, each with the other as it was published, so that neither can hide behind the other:
//
//     position, one step ahead:          |z - x - dt v_published|^2 / s^2
//     velocity, one to kAhead steps:     |z - x_published - dt v|^2 / s^2,    s^2 what the reference claims
//
// These are averaged over the recent past, and the corrected estimate loses the weight of a part where its average is
// the larger one. It needs no truth and sees what the box gate cannot: a network that was taught on the wrong family.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

struct RefereeOptions {
  double alpha = 0.03;      ///< weight of the newest squared error, (0, 1]
  double tolerance = 1.05;  ///< ratio of the averages, corrected over reference, at which half the weight is left, > 0
  double edge = 0.025;      ///< how fast the weight falls there, > 0

  bool operator==(const RefereeOptions&) const = default;
};

class Referee {
 public:
  static constexpr std::size_t kAhead = 4;

  /// g in [0, 1], of the first and of the second half of the state.
  struct Weights {
    double position = 1.0;
    double velocity = 1.0;
  };

  /// Judges the predictions of the last steps by the measured position in the base's record of this one. Call once per
  /// step, before predict(). A step that used no measurement leaves no trace.
  void judge(const StepRecord& base, const RefereeOptions& options) {
    if (base.status != StepStatus::ok || !base.innovation) return;
    const BoundedVector& z = base.innovation->z;
    const Eigen::Index m = base.x.size() / 2;
    if (z.size() != m) return;
    const std::size_t count = std::min(foretold_steps_, kAhead);
    for (std::size_t age = 0; age < count; ++age) {
      const Foretold& foretold = foretold_[(foretold_steps_ - 1 - age) % kAhead];
      const double dt_s = base.time_s - foretold.time_s;
      if (foretold.published.size() != 2 * m || !(dt_s > 0.0)) continue;
      const double claimed = base.innovation->S.trace() + dt_s * dt_s * foretold.velocity_variance;
      const auto squared_error = [&](const BoundedVector& position, const BoundedVector& velocity) {
        double squared = 0.0;
        for (Eigen::Index i = 0; i < m; ++i) {
          const double error = z[i] - position[i] - dt_s * velocity[m + i];
          squared += error * error;
        }
        return squared / claimed;
      };
      const auto take = [&](Averages& averages, double corrected, double reference, double share) {
        averages.corrected += share * options.alpha * (corrected - averages.corrected);
        averages.reference += share * options.alpha * (reference - averages.reference);
        averages.started = true;
      };
      if (age == 0)
        take(position_, squared_error(foretold.corrected, foretold.published),
             squared_error(foretold.reference, foretold.published), 1.0);
      take(velocity_, squared_error(foretold.published, foretold.corrected),
           squared_error(foretold.published, foretold.reference), 1.0 / static_cast<double>(count));
    }
  }

  /// What the next measurements will be held against, of a step that used one: the corrected estimate before any
  /// weight, the reference's record, and what was published.
  void predict(const BoundedVector& corrected, const StepRecord& reference, const BoundedVector& published) {
    const Eigen::Index m = published.size() / 2;
    foretold_[foretold_steps_++ % kAhead] = {reference.time_s, corrected, reference.x, published,
                                             reference.P.diagonal().tail(m).sum()};
  }

  Weights weights(const RefereeOptions& options) const {
    return {weight(position_, options), weight(velocity_, options)};
  }

 private:
  // Of squared errors over their claims: both begin with what is expected.
  struct Averages {
    bool started = false;
    double corrected = 1.0;
    double reference = 1.0;
  };
  struct Foretold {
    double time_s = 0.0;
    BoundedVector corrected;
    BoundedVector reference;
    BoundedVector published;
    double velocity_variance = 0.0;
  };

  static double weight(const Averages& averages, const RefereeOptions& options) {
    if (!averages.started) return 1.0;
    const double ratio = averages.corrected / averages.reference;
    const double weight = 1.0 / (1.0 + std::exp((ratio - options.tolerance) / options.edge));
    return std::isfinite(weight) ? weight : 0.0;
  }

  std::array<Foretold, kAhead> foretold_;  // step k in place k % kAhead
  std::size_t foretold_steps_ = 0;
  Averages position_;
  Averages velocity_;
};

}  // namespace truebearing
