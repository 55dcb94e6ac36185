// SPDX-License-Identifier: Apache-2.0
// From a study to a trained correction: teacher set -> network -> gate and covariance -> model.
#pragma once

#include <filesystem>
#include <string>

#include "training/fuzzy_training.hpp"
#include "training/teacher.hpp"
#include "truebearing/correction/correction_model.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing {

struct TrainOptions {
  std::uint64_t seed = 1;
  int threads = 0;                     ///< for the teacher's runs; the network itself is trained on one thread
  Progress teacher_progress;           ///< runs done
  TrainingProgress training_progress;  ///< iterations done
  std::filesystem::path torch_folder =
      {};  ///< of the module that teaches recurrent networks; empty: recurrent_module()
  /// A file that the training of a recurrent network keeps after each epoch and goes on from; it stays, for the caller
  /// to remove once the model is safe. Empty: none.
  std::filesystem::path checkpoint = {};
  Ranks* ranks = nullptr;  ///< share the teacher's runs; the first trains, and gives the model to the others
};

struct TrainReport {
  Eigen::Index rows = 0;
  double cost = 0.0;              ///< of the network on the teacher set, normalised
  double training_seconds = 0.0;  ///< of the network alone
};

/// Trains the corrected tracker of that name. The same for the same study and seed, to the bit. The report is of the
/// process that trains.
CorrectionModel train_correction(const Study& study, const std::string& name, const TrainOptions& options,
                                 TrainReport* report = nullptr);

}  // namespace truebearing
