// SPDX-License-Identifier: Apache-2.0
// The validation gate: a measurement whose NIS passes the threshold is not used. Every rejection in a row widens the
// gate; what only the wider one lets through is believed with a covariance as wide, and the gate narrows again step by
// step: a filter that took such a measurement with the covariance that had ruled it out would hardly move.
#pragma once

#include <algorithm>
#include <limits>

namespace truebearing {

class Gate {
 public:
  enum class Verdict { passes, passes_widened, rejected };

  /// threshold: largest NIS that passes at once; infinity leaves the gate open.
  explicit Gate(double threshold = std::numeric_limits<double>::infinity()) : threshold_(threshold) {}

  /// Call once per measurement.
  Verdict judge(double nis) {
    const double widening = (1.0 + streak_) * (1.0 + streak_);  // standard deviations grow by the gate's width a miss
    if (nis <= threshold_) {
      streak_ = 0.0;
      return Verdict::passes;
    }
    if (nis <= threshold_ * widening) {
      streak_ = std::max(streak_ - 1.0, 0.0);
      return Verdict::passes_widened;
    }
    streak_ += 1.0;
    return Verdict::rejected;
  }

  double threshold() const { return threshold_; }

 private:
  double threshold_;
  double streak_ = 0.0;
};

}  // namespace truebearing
