// The referee: which of two estimates has lately foretold the measurements better, the corrected one or the reference?
// Both are carried one step ahead at constant velocity and compared with the measured position; the squared errors are
// averaged over the recent past, and the corrected estimate loses its weight where its average is the larger one. It
// needs no truth and sees what the box gate cannot: a network that was taught on the wrong family of targets.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

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
  /// Judges the last step's two predictions by the measured position in the base's record of this one. Call once per
  /// step, before predict().
  void judge(const StepRecord& base, const RefereeOptions& options) {
    if (base.status != StepStatus::ok || !base.innovation) return;
    const BoundedVector& z = base.innovation->z;
    const Eigen::Index m = base.x.size() / 2;
    const double dt_s = base.time_s - time_s_;
    if (z.size() != m || !(dt_s > 0.0)) return;
    if (!started_)  // both begin with what the filter expects of an innovation
      corrected_average_ = reference_average_ = base.innovation->S.diagonal().sum();
    started_ = true;
    if (corrected_x_.size() != 2 * m) return;
    const auto squared_error = [&](const BoundedVector& x) { return (z - x.head(m) - dt_s * x.tail(m)).squaredNorm(); };
    corrected_average_ += options.alpha * (squared_error(corrected_x_) - corrected_average_);
    reference_average_ += options.alpha * (squared_error(reference_x_) - reference_average_);
  }

  /// What the next measurement will be held against: the corrected estimate, before any weight, and the reference's.
  void predict(double time_s, const BoundedVector& corrected_x, const BoundedVector& reference_x) {
    time_s_ = time_s;
    corrected_x_ = corrected_x;
    reference_x_ = reference_x;
  }

  /// g in [0, 1].
  double weight(const RefereeOptions& options) const {
    if (!started_) return 1.0;
    const double ratio = corrected_average_ / reference_average_;
    const double weight = 1.0 / (1.0 + std::exp((ratio - options.tolerance) / options.edge));
    return std::isfinite(weight) ? weight : 0.0;
  }

 private:
  bool started_ = false;
  double time_s_ = std::numeric_limits<double>::quiet_NaN();
  BoundedVector corrected_x_;
  BoundedVector reference_x_;
  double corrected_average_ = 0.0;
  double reference_average_ = 0.0;
};

}  // namespace truebearing
