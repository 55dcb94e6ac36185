// SPDX-License-Identifier: Apache-2.0
// TrackerSpec: what a study says of one of its trackers, with what it takes over from the one that it is `like`.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/study/correction_spec.hpp"
#include "truebearing/study/learned_motion_spec.hpp"
#include "truebearing/study/study_file.hpp"

namespace truebearing {

/// What a tracker of kind "smoother" is of; see SmoothingTracker.
struct SmootherSpec {
  std::string of;  ///< a filter of the study, with its tuned numbers
  double lag_s = std::numeric_limits<double>::infinity();
};

struct TrackerSpec {
  std::string name;
  std::string kind;
  std::string where;                         ///< what messages call it: "study.toml:12: trackers.plain"
  SharedTable configuration;                 ///< its table, over that of the tracker it is `like`
  SharedTable own;                           ///< what the study's file says of it itself
  std::vector<std::string> tune;             ///< dotted paths of the numbers that `truebearing tune` fits
  bool shown = true;                         ///< false for companions that no table needs
  std::optional<CorrectionSpec> correction;  ///< where kind is "corrected"
  std::optional<SmootherSpec> smoother;      ///< where kind is "smoother"
  std::optional<LearnedMotionSpec> learned;  ///< where motion.model is "learned"
};

/// The trackers of a study, whose file messages call `name`. Throws InputError, also where they are `like` one
/// another so often that a short file would take much memory.
std::vector<TrackerSpec> read_tracker_specs(const StudyFile& file, const std::string& name);

/// Refuses what tables and files of results cannot show as a name: nothing, control characters, bytes that are no UTF-8.
void check_name(const TableReader& table, const std::string& key, const std::string& name);

/// Reads its table, or the same with other numbers in it. What it has only taken over need not be of use to it.
TableReader tracker_reader(const TrackerSpec& spec, const SharedTable& configuration, const std::string& file);

std::vector<std::string> names_of(const std::vector<TrackerSpec>& trackers);

/// Asks for the keys of a tracker's table that are the study's and not its maker's, so that whoever misspelt one hears
/// of it.
void ask_for_study_keys(TableReader& tracker);

}  // namespace truebearing
