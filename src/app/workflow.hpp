// Tuning and training a whole study: what `tune`, `train` and `compare --retrain` share.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "truebearing/study/study.hpp"

namespace truebearing {

struct WorkflowOptions {
  std::uint64_t seed = 1;
  int threads = 0;
  bool quiet = false;
};

/// Fits every tracker of the study that has something to tune. Says on standard error what it found, unless quiet.
ParametersFile tune_study(const Study& study, const WorkflowOptions& options);

/// Trains the corrected trackers of those names; all of them where there are none. Scores each on validation runs,
/// which the model file remembers.
CorrectionModels train_study(const Study& study, const std::vector<std::string>& names, const WorkflowOptions& options);

}  // namespace truebearing
