// SPDX-License-Identifier: Apache-2.0
// StudyScoring: how a study is scored, which differences and bounds it wants.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/io/table_reader.hpp"
#include "truebearing/study/timed_scoring.hpp"

namespace truebearing {

struct StudyScoring {
  ScoringRule rule;
  TimedScoring timed;
  std::optional<AngleBound> angle_bound;
  std::vector<std::pair<std::string, std::string>> pairs;  ///< names of trackers whose difference is wanted
  std::vector<std::string> bounds;                         ///< names of trackers that are shown as bounds
};

/// trackers: the names that it may use; truth: of the scenarios, each `compared` under the name that messages call it.
/// Throws InputError.
StudyScoring read_study_scoring(TableReader scoring, const std::vector<std::string>& trackers, const StateSpace& truth,
                                const std::vector<NamedScenario>& compared);

}  // namespace truebearing
