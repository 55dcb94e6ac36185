// SPDX-License-Identifier: Apache-2.0
// Comparing the trackers of a study and writing what came of it: what `compare` and `learn` share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/arguments.hpp"
#include "app/log_options.hpp"
#include "app/report_output.hpp"
#include "app/terminal.hpp"
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
  bool quiet = false;
};

/// Prints the tables and the answer in a sentence, and writes JSON, page and plots where the options name them. `models` in place of those of the
/// files. Throws InputError.
void compare_study(const Study& study, const CorrectionModels& models, const CompareStudyOptions& options);

}  // namespace truebearing
