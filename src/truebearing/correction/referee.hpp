// SPDX-License-Identifier: Apache-2.0
// The referee: which of two estimates has lately agreed better with the measurements, the corrected one or the reference?
// Positions and velocities are judged apart, so that neither can hide behind the other. A position is carried one step
// ahead with the velocity that was published, and compared with what is measured there; a velocity is compared, some
// steps later, with the slope at its own time of the parabola through the measurements around it, which has no lag:
//
//     position, one step ahead:             |z_k - x - dt v_published|^2 / s^2
//     velocity, of a steps ago, a = 1 2 4:  |slope(z_{k-2a}, z_{k-a}, z_k) - v|^2 / s^2,    s^2 what the reference claims
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
  static constexpr std::array<std::size_t, 3> kHalfWidths{1, 2, 4};  ///< of the parabolas, in steps

  /// g in [0, 1], of the first and of the second half of the state.
  struct Weights {
    double position = 1.0;
    double velocity = 1.0;
  };

  /// Judges the estimates of the last steps by the measured position in the base's record of this one. Call once per
  /// step, before remember(). A step that used no measurement leaves no trace.
  void judge(const StepRecord& base, const RefereeOptions& options) {
    if (base.status != StepStatus::ok || !base.innovation) return;
    const BoundedVector& z = base.innovation->z;
    const Eigen::Index m = base.x.size() / 2;
    if (z.size() != m) return;
    judge_position(base, z, options);
    judge_velocity(base, z, options);
  }

  /// What the next measurements will be held against, of a step that used one: the corrected estimate before any
  /// weight, the reference's record, and what was published.
  void remember(const StepRecord& base, const BoundedVector& corrected, const StepRecord& reference,
                const BoundedVector& published) {
    const Eigen::Index m = published.size() / 2;
    if (!base.innovation || base.innovation->z.size() != m) return;
    estimates_[steps_++ % kKept] = {base.time_s, base.innovation->z, corrected,
                                    reference.x, published,          reference.P.diagonal().tail(m).sum()};
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
  struct Estimates {
    double time_s = 0.0;
    BoundedVector z;  // measured then
    BoundedVector corrected;
    BoundedVector reference;
    BoundedVector published;
    double velocity_variance = 0.0;
  };

  static constexpr std::size_t kKept = 2 * kHalfWidths.back();

  // Of `age` steps that used a measurement ago, from 1; nullptr where there was none.
  const Estimates* ago(std::size_t age) const {
    return age <= std::min(steps_, kKept) ? &estimates_[(steps_ - age) % kKept] : nullptr;
  }

  static void take(Averages& averages, double corrected, double reference, double weight) {
    averages.corrected += weight * (corrected - averages.corrected);
    averages.reference += weight * (reference - averages.reference);
    averages.started = true;
  }

  void judge_position(const StepRecord& base, const BoundedVector& z, const RefereeOptions& options) {
    const Estimates* last = ago(1);
    const Eigen::Index m = z.size();
    if (!last || last->published.size() != 2 * m || !(base.time_s > last->time_s)) return;
    const double dt_s = base.time_s - last->time_s;
    const double claimed = base.innovation->S.trace() + dt_s * dt_s * last->velocity_variance;
    const auto squared_error = [&](const BoundedVector& x) {
      return (z - x.head(m) - dt_s * last->published.tail(m)).squaredNorm() / claimed;
    };
    take(position_, squared_error(last->corrected), squared_error(last->reference), options.alpha);
  }

  void judge_velocity(const StepRecord& base, const BoundedVector& z, const RefereeOptions& options) {
    const Eigen::Index m = z.size();
    // Each parabola counts by how much of what differs there is the estimate's own error, as far as is claimed.
    std::array<double, kHalfWidths.size()> told{}, corrected{}, reference{};
    double all_told = 0.0;
    for (std::size_t i = 0; i < kHalfWidths.size(); ++i) {
      const Estimates* then = ago(kHalfWidths[i]);
      const Estimates* before = ago(2 * kHalfWidths[i]);
      if (!before || before->z.size() != m || then->z.size() != m) break;
      const double h1 = then->time_s - before->time_s, h2 = base.time_s - then->time_s;
      if (!(h1 > 0.0) || !(h2 > 0.0)) break;
      // The derivative of Lagrange's parabola at its middle point.
      const double w1 = -h2 / (h1 * (h1 + h2)), w2 = h1 / (h2 * (h1 + h2)), w0 = -w1 - w2;
      const BoundedVector slope = w1 * before->z + w0 * then->z + w2 * z;
      const double claimed = then->velocity_variance + (w1 * w1 + w0 * w0 + w2 * w2) * base.innovation->S.trace();
      told[i] = then->velocity_variance / claimed;
      corrected[i] = (slope - then->corrected.tail(m)).squaredNorm() / claimed;
      reference[i] = (slope - then->reference.tail(m)).squaredNorm() / claimed;
      all_told += told[i];
    }
    if (!(all_told > 0.0)) return;
    for (std::size_t i = 0; i < kHalfWidths.size() && told[i] > 0.0; ++i)
      take(velocity_, corrected[i], reference[i], options.alpha * told[i] / all_told);
  }

  static double weight(const Averages& averages, const RefereeOptions& options) {
    if (!averages.started) return 1.0;
    const double ratio = averages.corrected / averages.reference;
    const double weight = 1.0 / (1.0 + std::exp((ratio - options.tolerance) / options.edge));
    return std::isfinite(weight) ? weight : 0.0;
  }

  std::array<Estimates, kKept> estimates_;  // step k in place k % kKept
  std::size_t steps_ = 0;
  Averages position_;
  Averages velocity_;
};

}  // namespace truebearing
