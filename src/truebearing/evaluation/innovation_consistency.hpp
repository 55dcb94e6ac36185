// SPDX-License-Identifier: Apache-2.0
// What can be said of a tracker without truth: whether its innovations are as large as it claims, and white.
// (Bar-Shalom, Li and Kirubarajan 2001, sec. 5.4.2.)
#pragma once

#include <map>
#include <optional>

#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

class InnovationConsistency {
 public:
  /// Records of several tracks may alternate: whiteness is that of each track, StepRecord::track telling them apart.
  void add(const StepRecord& record);

  int steps() const { return steps_; }
  /// Mean NIS over its degrees of freedom: 1 for a consistent tracker.
  double nis_ratio() const;
  /// The interval that holds the mean NIS ratio of a consistent tracker with 95 %.
  double nis_ratio_low() const;
  double nis_ratio_high() const;
  /// Correlation of successive normalised innovations (first component); within +-correlation_limit() with 95 % where
  /// they are white.
  double correlation() const;
  double correlation_limit() const;
  /// True where the NIS of the tracks' first steps, used or gated, is so large that a wrong unit or a wrong column is
  /// likelier than chance.
  bool is_far_too_large_at_start() const;
  /// True where it is so small there, or anywhere in as many steps on end, that measurements that do not move, or are
  /// far better than the tracker believes, are likelier than chance.
  bool is_far_too_small() const;

 private:
  static constexpr int kFirstSteps = 10;  // of each track

  struct Track {
    int first_steps = 0;
    int still_steps = 0;  // on end
    std::optional<double> last_e;
  };
  std::map<int, Track> tracks_;
  int steps_ = 0;
  double freedom_ = 0.0;
  double nis_sum_ = 0.0;
  int first_steps_ = 0;
  double first_freedom_ = 0.0;
  double first_nis_sum_ = 0.0;
  bool stood_still_ = false;
  double product_sum_ = 0.0;
  double square_sum_ = 0.0;
};

}  // namespace truebearing
