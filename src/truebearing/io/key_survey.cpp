// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/key_survey.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <sstream>
#include <string_view>
#include <toml++/toml.h>

namespace truebearing {
namespace {

thread_local KeySurvey* current = nullptr;

// Tables of a study; every other table at the top of a file is one of a scenario.
constexpr std::array<std::string_view, 7> kTablesOfStudies{"scoring", "tuning",  "log",      "recorded",
                                                           "sets",    "sensors", "published"};

// Whose keys are names of the user's own.
bool holds_names(const TableReader& reader) {
  const std::string& path = reader.path();
  return path == "trackers" || path == "sensors" || path == "scenario.sensors";
}

// "trackers.plain.modes[0].motion" as "tracker.modes.motion", "sensors.radar" as "sensors".
std::string table_name(const TableReader& reader) {
  std::string name;
  std::istringstream parts(reader.path());
  bool is_users = false;
  for (std::string part; std::getline(parts, part, '.');) {
    part = part.substr(0, part.find('['));
    if (is_users) {
      is_users = false;
      continue;
    }
    is_users = (name.empty() && part == "trackers") || (part == "sensors" && (name.empty() || name == "scenario"));
    name += (name.empty() ? "" : ".") + (part == "trackers" ? "tracker" : part);
  }
  // A scenario in a file of its own names its sensors as a study does; they have an output.
  if (name == "sensors" && reader.raw()->contains("output")) name = "scenario.sensors";
  if (name.empty()) return reader.raw()->contains("kind") ? "scenario" : "study";
  const std::string first = name.substr(0, name.find('.'));
  if (first == "tracker" || first == "scenario" ||
      std::find(kTablesOfStudies.begin(), kTablesOfStudies.end(), first) != kTablesOfStudies.end())
    return name;
  return "scenario." + name;
}

std::string kind_of(const TableReader& reader) {
  const bool is_tracker =
      reader.path().starts_with("trackers.") && std::count(reader.path().begin(), reader.path().end(), '.') == 1;
  for (const char* key : {"kind", "model"}) {
    if (const toml::node* node = reader.raw()->get(key))
      if (const auto* text = node->as_string()) return text->get();
    if (is_tracker) break;  // whose model is a file
  }
  return {};
}

// What the kind of a table is the kind of.
std::string family_of(const std::string& table) {
  const std::string last = table.substr(table.rfind('.') + 1);
  if (last == "modes" || last == "around" || last == "truth") return "motion";
  if (last == "batch" || last == "filter") return "tracker";
  return last == "sensors" ? "measurement" : last;
}

}  // namespace

KeySurvey::KeySurvey() : before_(current) {
  current = this;
}

KeySurvey::~KeySurvey() {
  current = before_;
}

SurveyedKey* surveyed(const TableReader& reader, const std::string& key) {
  if (!current || holds_names(reader)) return nullptr;
  SurveyedKey& entry = current->tables_[table_name(reader)][key];
  std::string kind = kind_of(reader);
  if (const auto noted = current->kinds_.find(reader.path()); kind.empty() && noted != current->kinds_.end())
    kind = noted->second;
  if (!kind.empty()) entry.kinds.insert(std::move(kind));
  return &entry;
}

void note_kind(const TableReader& reader, const std::string& kind) {
  if (current) current->kinds_[reader.path()] = kind;
}

std::vector<std::string> unvisited_choices(const KeySurvey::Tables& tables) {
  std::set<std::string> choices, visited;
  for (const auto& [table, keys] : tables)
    for (const auto& [key, entry] : keys) {
      if (key != "kind" && key != "model") continue;
      const std::string family = family_of(table) + ".";
      for (const std::string& choice : entry.choices) choices.insert(family + choice);
      for (const std::string& kind : entry.kinds) visited.insert(family + kind);
    }
  std::vector<std::string> unvisited;
  std::set_difference(choices.begin(), choices.end(), visited.begin(), visited.end(), std::back_inserter(unvisited));
  return unvisited;
}

}  // namespace truebearing
