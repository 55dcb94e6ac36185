// SPDX-License-Identifier: Apache-2.0
// How a recorded file is to be read, where its own header does not say it all.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "truebearing/measurement/measured.hpp"

namespace truebearing {

struct RecordingOptions {
  /// What a column of the file is called here: {"rng", "range_km"}. A column without a new name is left out.
  std::vector<std::pair<std::string, std::string>> columns{};
  /// What is to be measured, in this order: {"range_m", "bearing_deg"}; whatever the log measures where it is empty, or
  /// where the log has none of it.
  std::vector<std::string> measured{};
  /// Of several sensors: a row is one's, by the name in a column `sensor`, else by the cells that are filled.
  std::vector<Source> sources{};
  /// What the clock of each of them is ahead of the log's: taken off its times. Empty where all clocks agree.
  std::vector<double> clock_offsets_s{};
  /// The target whose rows are read, where the file has several.
  std::string target{};
  /// Rows that come later than others of a later time are put in order where they are no more than this late.
  double sort_window_s = 0.0;
  /// In place of that, of who puts late rows where they belong (evaluation/late_rows.hpp): rows are given as they come.
  /// Who wants a whole recording has it sorted.
  double late_keep_s = 0.0;
};

}  // namespace truebearing
