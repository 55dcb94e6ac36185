// The validation gate: a measurement whose NIS passes the threshold is not used. Every rejection in a row widens the
// gate, so that a filter that has lost its target finds back instead of locking itself out.
#pragma once

#include <limits>

namespace truebearing {

class Gate {
 public:
  /// threshold: largest NIS that passes at once; infinity leaves the gate open.
  explicit Gate(double threshold = std::numeric_limits<double>::infinity()) : threshold_(threshold) {}

  /// True where the measurement may be used. Call once per measurement.
  bool passes(double nis) {
    const double widening = (1.0 + streak_) * (1.0 + streak_);  // standard deviations grow by the gate's width a miss
    if (nis <= threshold_ * widening) {
      streak_ = 0.0;
      return true;
    }
    streak_ += 1.0;
    return false;
  }

 private:
  double threshold_;
  double streak_ = 0.0;
};

}  // namespace truebearing
