// SPDX-License-Identifier: Apache-2.0
// The referee: which of two estimates has lately agreed better with the measurements, the corrected one or the
// reference? Positions and velocities are judged apart, so that neither can hide behind the other. A position is
// carried one step ahead with the velocity that was published, and compared with what is measured there; a velocity is
// compared, some steps later, with the slope at its own time of the parabola through the measurements around it, which
// has no lag:
//
//     position, one step ahead:             |z_k - x - dt v_published|^2 / s^2
//     velocity, of a steps ago, a = 1 2 4:  |slope(z_{k-2a}, z_{k-a}, z_k) - v|^2 / s^2,    s^2 what the reference
// claims
//
// These are averaged over the recent past, and the corrected estimate loses the weight of a part where its average is
// the larger one. It needs no truth and sees what the box gate cannot: a network that was taught on the wrong family.
#pragma once

#include <algorithm>
#include <array>
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
  void judge(const StepRecord& base, const RefereeOptions& options);

  /// What the next measurements will be held against, of a step that used one: the corrected estimate before any
  /// weight, the reference's record, and what was published. Vectors of any type that has a size.
  template <typename Corrected, typename Published>
  void remember(const StepRecord& base, const Corrected& corrected, const StepRecord& reference,
                const Published& published) {
    const Eigen::Index n = published.size(), m = n / 2;
    if (!base.innovation || base.innovation->z.size() != m) return;
    Estimates& now = estimates_[steps_++ % kKept];
    now.time_s = base.time_s;
    now.states = n;
    now.velocity_variance = 0.0;
    for (Eigen::Index i = 0; i < m; ++i) {
      now.z[i] = base.innovation->z[i];
      now.velocity_variance += reference.P(n - m + i, n - m + i);
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      now.corrected[i] = corrected[i];
      now.reference[i] = reference.x[i];
      now.published[i] = published[i];
    }
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
    Eigen::Index states = 0;           // n, of which the first m = n / 2 are positions, the last m velocities
    double z[kMaxDimension / 2] = {};  // measured then
    double corrected[kMaxDimension] = {};
    double reference[kMaxDimension] = {};
    double published[kMaxDimension] = {};
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
  template <int M>
  void judge_position(const StepRecord& base, const RefereeOptions& options);
  template <int M>
  void judge_velocity(const StepRecord& base, const RefereeOptions& options);
  static double weight(const Averages& averages, const RefereeOptions& options);

  std::array<Estimates, kKept> estimates_;  // step k in place k % kKept
  std::size_t steps_ = 0;
  Averages position_;
  Averages velocity_;
};

}  // namespace truebearing
