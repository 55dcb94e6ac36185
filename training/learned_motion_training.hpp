// SPDX-License-Identifier: Apache-2.0
// Teaching a learned motion (correction/learned_motion.hpp). The teacher is the truth of training runs alone: from each
// state to the next, label = x_{k+1} - f_0(x_k, T), input x_k. No filter is run, so that what is learned is how targets
// move and not how a filter errs.
#pragma once

#include <string>

#include "training/train_correction.hpp"
#include "truebearing/correction/learned_motion.hpp"

namespace truebearing {

struct LearnedMotionReport {
  Eigen::Index rows = 0;
  double remaining = 1.0;  ///< root mean square of what a prediction misses with r, over that without, normalised
  double training_seconds = 0.0;
};

/// Teaches the motion of that tracker. T is the median of the times between measurements; other gaps are not taught.
/// The same for the same study and seed, to the bit. Throws InputError where the truth is no state of the motion.
MotionResidual train_learned_motion(const Study& study, const std::string& name, const TrainOptions& options,
                                    LearnedMotionReport* report = nullptr);

}  // namespace truebearing
