// SPDX-License-Identifier: Apache-2.0
// The paper's own training (Lee et al., section 3): a grid partition of the normalised inputs, and all parameters -
// term centres, term widths, consequents - by back-propagation of the teacher signal, eq. (13), at a fixed rate. A
// labelled variant: scattered rules by variable projection come to the same error with far fewer rules.
//
// What the paper leaves open: inputs are normalised as everywhere here, consequents start at 0, widths move in
// their logarithm and stay above a floor, rows come in an order drawn afresh for each epoch.
#pragma once

#include <cstdint>

#include "training/fuzzy_training.hpp"
#include "truebearing/correction/fuzzy_partition.hpp"

namespace truebearing {

struct BackPropagationOptions {
  int terms_per_input = 3;
  int epochs = 200;
  int batch_rows = 1;           ///< rows per step; 1 is on-line
  double learning_rate = 0.02;  ///< on the mean gradient of the batch
  double momentum = 0.0;        ///< 0 <= m < 1; makes the steps 1 / (1 - m) times as long
  double input_clip = 4.0;      ///< standard deviations
  double width_floor = 0.1;     ///< standard deviations
  std::uint64_t seed = 1;
};

struct TrainedFuzzyGrid {
  TrainedFuzzyNetwork network;
  FuzzyPartition partition;
};

/// A function of data and options alone, to the bit. Throws InputError as validate() does, for an option out of range
/// and for a grid of more than FuzzyNetwork::kMaxRules rules.
TrainedFuzzyGrid train_back_propagation(const FuzzyTrainingData& data, const BackPropagationOptions& options,
                                        const TrainingProgress& progress = {});

}  // namespace truebearing
