// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/key_survey.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>
#include <toml++/toml.h>

namespace truebearing {
namespace {

thread_local KeySurvey* current = nullptr;

// Tables of a study; every other table at the top of a file is one of a scenario.
constexpr std::array<std::string_view, 6> kTablesOfStudies{"scoring", "tuning", "log", "recorded", "sets", "published"};

// "trackers.plain.modes[0].motion" as "tracker.modes.motion".
std::string table_name(const TableReader& reader) {
  std::string name;
  std::istringstream parts(reader.path());
  bool names_tracker = false;
  for (std::string part; std::getline(parts, part, '.');) {
    part = part.substr(0, part.find('['));
    if (name.empty() && part == "trackers") {
      name = "tracker";
      names_tracker = true;
    } else if (names_tracker) {
      names_tracker = false;
    } else {
      name += (name.empty() ? "" : ".") + part;
    }
  }
  if (name.empty()) return reader.raw()->contains("kind") ? "scenario" : "study";
  const std::string first = name.substr(0, name.find('.'));
  if (first == "tracker" || first == "scenario" ||
      std::find(kTablesOfStudies.begin(), kTablesOfStudies.end(), first) != kTablesOfStudies.end())
    return name;
  return "scenario." + name;
}

std::string kind_of(const TableReader& reader) {
  if (reader.path().starts_with("trackers.") && std::count(reader.path().begin(), reader.path().end(), '.') == 1)
    return reader.raw()->contains("kind") ? (*reader.raw())["kind"].value_or(std::string()) : std::string();
  for (const char* key : {"kind", "model"})
    if (const toml::node* node = reader.raw()->get(key))
      if (const auto* text = node->as_string()) return text->get();
  return {};
}

}  // namespace

KeySurvey::KeySurvey() : before_(current) {
  current = this;
}

KeySurvey::~KeySurvey() {
  current = before_;
}

SurveyedKey* surveyed(const TableReader& reader, const std::string& key) {
  if (!current || reader.path() == "trackers") return nullptr;  // whose keys are names of the user's own
  SurveyedKey& entry = current->tables_[table_name(reader)][key];
  if (std::string kind = kind_of(reader); !kind.empty()) entry.kinds.insert(std::move(kind));
  return &entry;
}

}  // namespace truebearing
