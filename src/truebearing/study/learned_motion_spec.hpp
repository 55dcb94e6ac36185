// SPDX-License-Identifier: Apache-2.0
// What a study says of a learned motion (correction/learned_motion.hpp): motion = { model = "learned", file, around =
// { a motion }, training = { rules, runs, ... } }. Plain data.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/study/correction_spec.hpp"

namespace truebearing {

struct LearnedMotionSpec {
  std::filesystem::path file;  ///< that `truebearing train` writes
  int rules = 100;
  std::size_t runs = 20;
  int iterations = 150;
  double learning_rate = 0.05;
  double ridge = 1e-6;
  std::optional<ChangedScenario> scenario;  ///< what is taught; the study's own where absent
};

/// The keys of `motion` but `model` and `around`, which stay to be asked for. Throws InputError.
LearnedMotionSpec read_learned_motion_spec(TableReader& motion);

}  // namespace truebearing
