// SPDX-License-Identifier: Apache-2.0
// Comparing the trackers of a study and writing what came of it: what `compare`, `learn` and `merge` share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/arguments.hpp"
#include "app/log_options.hpp"
#include "app/report_output.hpp"
#include "app/terminal.hpp"
#include "truebearing/evaluation/ranks.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing {

struct CompareStudyOptions {
  std::uint64_t seed = 1;
  std::size_t runs = 0;  ///< 0: the study's own number
  int threads = 0;       ///< 0: one per core
  std::string truth;     ///< a recorded track in place of the study's scenarios; or empty
  LogArguments reading;
  std::string json;
  ReportArguments report;
  TableArguments tables;
  bool details = false;  ///< keep what plots need, though this process draws none
  bool quiet = false;
};

/// A comparison of a study's trackers, ready to run whole or in parts.
class StudyComparison {
 public:
  /// `models` in place of those of the files. All must outlive it. Throws InputError.
  StudyComparison(const Study& study, const CorrectionModels& models, const CompareStudyOptions& options);

  ComparisonRuns& runs() { return *runs_; }
  const ComparisonOptions& options() const { return comparison_options_; }
  /// Prints the tables and the answer in a sentence, and writes JSON, page and plots where the options name them. Throws
  /// InputError.
  void write(Comparison comparison) const;

 private:
  std::string not_scored(const Recording& first) const;

  const Study& study_;
  const CorrectionModels& models_;
  const CompareStudyOptions& asked_;
  std::unique_ptr<Scenario> recorded_;
  std::vector<NamedScenario> scenarios_;
  std::string notes_;
  ComparisonOptions comparison_options_;
  TrackerSet trackers_;
  std::unique_ptr<ComparisonRuns> runs_;
};

/// All of its runs in this process, or shared with others, and what came of them written by the first. Throws InputError.
void compare_study(const Study& study, const CorrectionModels& models, const CompareStudyOptions& options,
                   Ranks* ranks = nullptr);

}  // namespace truebearing
