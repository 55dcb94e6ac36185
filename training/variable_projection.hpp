// SPDX-License-Identifier: Apache-2.0
// The default training of a fuzzy network with scattered rules: k-means centres, widths from the distance to the
// nearest neighbour, consequents by ridge least squares inside the loop (variable projection, Golub and Pereyra 1973),
// centres and log widths by Adam (Kingma and Ba 2015) on the projected cost with a cosine schedule, and a last least
// squares on all rows.
#pragma once

#include <cstdint>

#include "training/fuzzy_training.hpp"

namespace truebearing {

struct VariableProjectionOptions {
  int rules = 16;
  int iterations = 150;
  double learning_rate = 0.05;    ///< of Adam, at the start; in standard deviations and in ln(width)
  double ridge = 1e-3;            ///< lambda: |w|^2 is weighted with lambda n/M on normalised outputs
  double input_clip = 4.0;        ///< standard deviations
  double width_floor = 0.3;       ///< standard deviations, from the first iteration to the last
  Eigen::Index max_rows = 10000;  ///< of one iteration, mirror images included; each draws them afresh
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: one per core; the network is the same to the bit
};

/// A function of data and options alone, to the bit. Throws InputError as validate() does and for options out of range.
TrainedFuzzyNetwork train_variable_projection(const FuzzyTrainingData& data, const VariableProjectionOptions& options,
                                              const TrainingProgress& progress = {});

}  // namespace truebearing
