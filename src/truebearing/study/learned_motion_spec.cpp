// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/learned_motion_spec.hpp"

namespace truebearing {

LearnedMotionSpec read_learned_motion_spec(TableReader& motion) {
  LearnedMotionSpec spec;
  spec.file = motion.resolve(motion.text("file"));
  TableReader training = motion.table("training");
  spec.rules = static_cast<int>(training.integer_or("rules", spec.rules, 1, 256));
  spec.runs = static_cast<std::size_t>(training.integer_or("runs", 20, 1, 100000));
  spec.iterations = static_cast<int>(training.integer_or("iterations", spec.iterations, 0, 100000));
  spec.learning_rate = training.number_or("learning_rate", spec.learning_rate, kPositive);
  spec.ridge = training.number_or("ridge", spec.ridge, kPositive);
  if (training.has("scenario")) spec.scenario = read_changed_scenario(training, "scenario");
  training.finish();
  return spec;
}

}  // namespace truebearing
