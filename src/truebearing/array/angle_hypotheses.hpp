// SPDX-License-Identifier: Apache-2.0
// Multiple hypotheses on which target is which after two of them met. The posterior of two targets that cross has two
// modes, one for either way out; a filter that follows the wrong one swaps them. Each hypothesis is a joint filter;
// when two of its targets are predicted to be close it is scored again from its posterior with the pair exchanged, and
// what lands elsewhere is another hypothesis. Weights are the evidences of their intervals (Laplace), so that the
// decision waits until the motion tells. The best is the output.
#pragma once

#include <vector>

#include "truebearing/array/joint_angle_filter.hpp"

namespace truebearing {

struct AngleHypothesis {
  JointAngleState prior;  ///< before the last interval that was used
  JointAngleState state;  ///< after it
  double log_weight = 0.0;
};

class AngleHypotheses {
 public:
  struct Options {
    JointAngleMotion motion;
    JointAngleUpdate::Options update;
    int beam = 8;  ///< at most so many hypotheses; 1: none but the first
    /// A pair is scored the other way round where it is predicted closer than this, or than close_sigmas of the
    /// difference, and in any case closer than reach_rad.
    double close_rad = 0.0349, close_sigmas = 3.0, reach_rad = 0.1396;
    double new_rad = 0.00087;                                          ///< a child that differs by less is none
    double drop_log_weight = 12.0;                                     ///< so far below the best is dropped
    double same_rad = 0.0026, same_radps = 0.0014, same_sigmas = 0.7;  ///< closer in all three is one
  };

  void begin(const Options& options, const JointAngleState& state);

  /// Takes an interval dt_s after the one before. False where no hypothesis gave a finite result: all stay as they
  /// were.
  bool update(const RealInterval& interval, double dt_s, double middle_s);

  const AngleHypothesis& best() const { return hypotheses_.front(); }
  int count() const { return count_; }
  const AngleHypothesis& hypothesis(int h) const { return hypotheses_[static_cast<std::size_t>(h)]; }

  /// Changes the number of targets of all hypotheses in the same way.
  template <typename Change>
  void change(const Change& change) {
    for (int h = 0; h < count_; ++h) change(hypotheses_[static_cast<std::size_t>(h)]);
  }
  void set_noise_power(double noise_power) { options_.update.noise_power = noise_power; }
  JointAngleUpdate& scoring() { return update_; }

 private:
  bool score(const AngleHypothesis& parent, const JointAngleState& prior, const RealInterval& interval, double middle_s,
             const SignalVector& start, const AngleHypothesis* sibling, AngleHypothesis& child);
  void add_children(const AngleHypothesis& parent, const JointAngleState& prior, const AngleHypothesis& first,
                    const RealInterval& interval, double middle_s);
  void keep_best();
  bool is_same(const AngleHypothesis& a, const AngleHypothesis& b) const;
  AngleHypothesis& next_child();

  Options options_;
  JointAngleUpdate update_;
  std::vector<AngleHypothesis> hypotheses_, children_;
  int count_ = 0, child_count_ = 0;
  std::vector<int> order_;
};

}  // namespace truebearing
