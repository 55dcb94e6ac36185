// TrackerSpec: what a study says of one of its trackers, with what it takes over from the one that it is `like`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/study/correction_spec.hpp"

namespace truebearing {

struct TrackerSpec {
  std::string name;
  std::string kind;
  SharedTable configuration;                 ///< its table, over that of the tracker it is `like`
  std::vector<std::string> tune;             ///< dotted paths of the numbers that `truebearing tune` fits
  bool shown = true;                         ///< false for companions that no table needs
  std::optional<CorrectionSpec> correction;  ///< where kind is "corrected"
};

/// The trackers of a study's table, in that order of their names. Throws InputError.
std::vector<TrackerSpec> read_tracker_specs(TableReader table, const std::vector<std::string>& order);

std::vector<std::string> names_of(const std::vector<TrackerSpec>& trackers);

/// Asks for the keys of a tracker's table that are the study's and not its maker's, so that whoever misspelt one hears
/// of it.
void ask_for_study_keys(TableReader& tracker);

}  // namespace truebearing
