// SPDX-License-Identifier: Apache-2.0
// KeySurvey: while one lives, every TableReader of its thread notes what it is asked for: type, valid values, default.
// What `truebearing keys` prints of a key is thus what its reader really uses.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "truebearing/io/table_reader.hpp"

namespace truebearing {

/// What was seen of one key in all tables of its name.
struct SurveyedKey {
  std::string type;                ///< empty where only its presence was asked for
  std::set<std::string> valid;     ///< "a number > 0", or the names to choose from; several where readers differ
  std::set<std::string> choices;   ///< of all readers, where the values are names
  std::set<std::string> defaults;  ///< as written in a study
  bool optional = false;
  std::set<std::string> kinds;  ///< `kind` or `model` of the tables that it was read from
};

class KeySurvey {
 public:
  KeySurvey();
  ~KeySurvey();
  KeySurvey(const KeySurvey&) = delete;
  KeySurvey& operator=(const KeySurvey&) = delete;

  /// By table ("scenario.sensor", "tracker.motion", names of trackers left out), then by key.
  using Tables = std::map<std::string, std::map<std::string, SurveyedKey>>;
  const Tables& tables() const { return tables_; }

 private:
  friend SurveyedKey* surveyed(const TableReader& reader, const std::string& key);
  friend void note_kind(const TableReader& reader, const std::string& kind);
  Tables tables_;
  std::map<std::string, std::string> kinds_;  // by path, of tables that do not say theirs
  KeySurvey* before_;
};

/// The entry of a key, or nullptr where nobody surveys.
SurveyedKey* surveyed(const TableReader& reader, const std::string& key);

/// Of which kind a table is that is read without its `kind`, as a tracker's.
void note_kind(const TableReader& reader, const std::string& kind);

/// Choices of `kind` and `model` that no table was of, as "measurement.bearing": their keys were not seen. A motion is
/// one wherever it stands, and so are a tracker and a measurement.
std::vector<std::string> unvisited_choices(const KeySurvey::Tables& tables);

/// What messages say of a range: "a number in [0, 1]".
std::string describe(Range range);

}  // namespace truebearing
