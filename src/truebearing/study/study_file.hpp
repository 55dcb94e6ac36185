// SPDX-License-Identifier: Apache-2.0
// A study's file, over the file of the study that it is `like`. What that one names by paths is where it was, also from
// another folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "truebearing/io/table_reader.hpp"

namespace truebearing {

struct StudyFile {
  SharedTable table;
  SharedTable own;                    ///< what the file says itself; nullptr where it is `like` no other
  std::vector<std::string> trackers;  ///< in the order of their files, which a merged table has lost
};

/// Throws InputError, also where the other study is itself `like` another.
StudyFile read_study_file(const std::filesystem::path& path);

}  // namespace truebearing
