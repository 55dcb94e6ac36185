// SPDX-License-Identifier: Apache-2.0
// truebearing keys [KIND]: every key of a study file. Type, valid values and default are those that the readers ask for
// (io/key_survey.hpp) while the studies that come with the program are read; meanings stand in data/keys/meanings.toml.
#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "app/data_folder.hpp"
#include "app/subcommands.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/io/key_survey.hpp"
#include "truebearing/study/study.hpp"
#include "truebearing/study/tracker_registry.hpp"

namespace truebearing {
namespace {

struct KeysArguments {
  std::string kind;
  bool markdown = false;
};

// Keys that are names of the user's own (sets, published figures, quantities), and the parts of a distribution.
bool is_named_by_user(const std::string& table, const std::string& key) {
  return table == "published" && key != "name" && key != "source";
}

bool is_left_out(const std::string& table, const std::map<std::string, SurveyedKey>& keys) {
  return keys.contains("log_uniform") || table == "sets" || table == "scoring.loss_thresholds" ||
         table == "log.columns" || table.starts_with("sets.") || table.starts_with("published.");
}

KeySurvey::Tables surveyed_tables() {
  const KeySurvey survey;
  for (const char* folder : {"studies", "keys"})
    for (const auto& file : std::filesystem::directory_iterator(data_folder() / "data" / folder))
      if (file.path().extension() == ".toml" && file.path().filename() != "meanings.toml")
        static_cast<void>(Study::load(file.path()));
  KeySurvey::Tables tables;
  for (const auto& [table, keys] : survey.tables()) {
    if (is_left_out(table, keys)) continue;
    for (const auto& [key, entry] : keys)
      if (!is_named_by_user(table, key)) tables[table].emplace(key, entry);
  }
  // Read as text, since a program may bring kinds of its own.
  SurveyedKey& kind = tables["tracker"]["kind"];
  std::vector<std::string> kinds = tracker_kinds();
  kinds.insert(kinds.end(), {"corrected", kSmoother});
  kind.choices.insert(kinds.begin(), kinds.end());
  kind.valid.insert(fmt::format("\"{}\"", fmt::join(kind.choices, "\", \"")));
  if (const std::vector<std::string> unvisited = unvisited_choices(tables); !unvisited.empty())
    throw InputError((data_folder() / "data/keys").string(), fmt::format("visits no {}", fmt::join(unvisited, ", ")),
                     "a study for each");
  return tables;
}

// A meaning is looked up by "table.key", else by "key" of any table. Throws where a key has none, and where one is of no
// key.
std::map<std::string, std::string> meanings_of(const KeySurvey::Tables& tables) {
  const std::string file = (data_folder() / "data/keys/meanings.toml").string();
  TableReader reader(read_toml_file(file), file);
  std::map<std::string, std::string> known, found;
  for (const std::string& name : reader.keys()) known[name] = reader.text(name);
  std::vector<std::string> missing;
  std::set<std::string> used;
  for (const auto& [table, keys] : tables)
    for (const auto& [key, entry] : keys) {
      const std::string full = table + "." + key;
      const std::string name = known.contains(full) ? full : key;
      used.insert(name);
      if (known.contains(name))
        found[full] = known[name];
      else
        missing.push_back(full);
    }
  if (!missing.empty()) throw InputError(file, fmt::format("lacks {}", fmt::join(missing, ", ")), "a line for each");
  for (const auto& [name, meaning] : known)
    if (!used.contains(name)) throw reader.error(name, "is a key that no study's reader asks for");
  return found;
}

// By the ending of a key, the longest first.
std::string unit_of(const std::string& key) {
  static const std::vector<std::pair<std::string, std::string>> kUnits{{"_per_s", "1/s"},
                                                                       {"_deg2ps3", "deg^2/s^3"},
                                                                       {"_m2ps3", "m^2/s^3"},
                                                                       {"_m2ps5", "m^2/s^5"},
                                                                       {"_m2ps7", "m^2/s^7"},
                                                                       {"_hz2ps", "Hz^2/s"},
                                                                       {"_degps2", "deg/s^2"},
                                                                       {"_degps", "deg/s"},
                                                                       {"_mps2", "m/s^2"},
                                                                       {"_mps", "m/s"},
                                                                       {"_deg", "deg"},
                                                                       {"_hz", "Hz"},
                                                                       {"_m2", "m^2"},
                                                                       {"_m", "m"},
                                                                       {"_s", "s"},
                                                                       {"_db", "dB"}};
  for (const auto& [ending, unit] : kUnits)
    if (key.ends_with(ending)) return unit;
  return {};
}

std::string listed(const std::set<std::string>& values) {
  constexpr std::size_t kMost = 3;
  return values.size() > kMost ? "depends on other keys" : fmt::format("{}", fmt::join(values, "; or "));
}

std::string values_of(const SurveyedKey& entry) {
  if (entry.type.empty()) return "not in any study";
  if (entry.type == "number or distribution") return listed(entry.valid) + ", or a distribution";
  return entry.valid.empty() ? entry.type : listed(entry.valid);
}

std::string default_of(const SurveyedKey& entry) {
  if (!entry.defaults.empty()) return listed(entry.defaults);
  return entry.optional || entry.type.empty() ? "none" : "required";
}

using Keys = std::map<std::string, SurveyedKey>;

std::set<std::string> kinds_of(const Keys& keys) {
  std::set<std::string> kinds;
  for (const auto& [key, entry] : keys) kinds.insert(entry.kinds.begin(), entry.kinds.end());
  return kinds;
}

// The kinds that have the key, where not all of its table do.
std::string only_of(const SurveyedKey& entry, const std::set<std::string>& kinds) {
  return entry.kinds == kinds ? "" : fmt::format("{}", fmt::join(entry.kinds, ", "));
}

void print_wrapped(const std::string& text, const std::string& margin) {
  constexpr std::size_t kColumns = 100;
  std::istringstream words(text);
  std::string line = margin;
  for (std::string word; words >> word;) {
    if (line.size() > margin.size() && line.size() + 1 + word.size() > kColumns) {
      fmt::print("{}\n", line);
      line = margin;
    }
    line += (line.size() > margin.size() ? " " : "") + word;
  }
  fmt::print("{}\n", line);
}

void print_text(const std::string& table, const Keys& keys, const std::map<std::string, std::string>& meanings,
                const std::set<std::string>& kinds) {
  fmt::print("[{}]\n", table);
  for (const auto& [key, entry] : keys) {
    const std::string unit = unit_of(key), only = only_of(entry, kinds);
    print_wrapped(key + (unit.empty() ? "" : " (" + unit + ")") + ": " + meanings.at(table + "." + key), "  ");
    print_wrapped(
        fmt::format("{}; default: {}{}", values_of(entry), default_of(entry), only.empty() ? "" : "; of " + only),
        "      ");
  }
  fmt::print("\n");
}

void print_markdown(const std::string& table, const Keys& keys, const std::map<std::string, std::string>& meanings,
                    const std::set<std::string>& kinds) {
  fmt::print("\n## {}\n\n| key | meaning | unit | values | default | only of |\n|---|---|---|---|---|---|\n", table);
  for (const auto& [key, entry] : keys)
    fmt::print("| `{}` | {} | {} | {} | {} | {} |\n", key, meanings.at(table + "." + key), unit_of(key),
               values_of(entry), default_of(entry), only_of(entry, kinds));
}

// Names that may be asked for: tables, whole or by one part of their name, and kinds and models.
std::set<std::string> names_of(const KeySurvey::Tables& tables) {
  std::set<std::string> names;
  for (const auto& [table, keys] : tables) {
    names.insert(table);
    std::istringstream parts(table);
    for (std::string part; std::getline(parts, part, '.');) names.insert(part);
    names.merge(kinds_of(keys));
  }
  return names;
}

bool is_of(const std::string& table, const std::string& name) {
  return ("." + table + ".").find("." + name + ".") != std::string::npos;
}

// Tables that only that kind has, as the modes of an imm.
std::vector<std::string> tables_only_of(const std::string& kind, const KeySurvey::Tables& tables) {
  std::vector<std::string> own;
  for (const auto& [table, keys] : tables)
    for (const auto& [key, entry] : keys)
      if (entry.kinds == std::set<std::string>{kind} && kinds_of(keys).size() > 1 && tables.contains(table + "." + key))
        own.push_back(table + "." + key);
  return own;
}

bool is_within(const std::string& table, const std::vector<std::string>& parents) {
  return std::any_of(parents.begin(), parents.end(),
                     [&](const std::string& parent) { return (table + ".").starts_with(parent + "."); });
}

void print_keys(const KeysArguments& arguments) {
  const KeySurvey::Tables tables = surveyed_tables();
  const std::map<std::string, std::string> meanings = meanings_of(tables);
  const std::string& kind = arguments.kind;
  if (const std::set<std::string> names = names_of(tables); !kind.empty() && !names.contains(kind))
    throw InputError("keys", "there is no table or kind \"" + kind + "\"",
                     suggestion(kind, {names.begin(), names.end()}));
  if (arguments.markdown)
    fmt::print(
        "# The keys of a study\n\nWritten by `truebearing keys --markdown`, from what the readers ask for; "
        "`truebearing keys motion` or `keys singer` prints a part.\nIn place of `tracker` stands the name of a "
        "tracker, `[trackers.NAME]`; `scenario` is a table of the study or a file of its own. A\ndistribution is "
        "`{{ uniform = [low, high] }}`, `{{ normal = [mean, standard deviation] }}`, `{{ log_uniform = [low, high] "
        "}}`\nor `{{ choice = [a, b] }}`. `only of`: the kinds or models that have the key, where not all do.\n");
  const std::vector<std::string> own = tables_only_of(kind, tables);
  for (const auto& [table, keys] : tables) {
    const bool is_whole = kind.empty() || is_of(table, kind) || is_within(table, own);
    Keys shown;
    for (const auto& [key, entry] : keys)
      if (is_whole || entry.kinds.contains(kind)) shown.emplace(key, entry);
    if (shown.empty()) continue;
    (arguments.markdown ? print_markdown : print_text)(table, shown, meanings, kinds_of(keys));
  }
}

}  // namespace

void add_keys(const Subcommands& all) {
  auto arguments = std::make_shared<KeysArguments>();
  const Subcommand command =
      all.add("keys", "print every key of a study: what it means, its unit, valid values and default");
  command.argument("kind", arguments->kind,
                   "a table (motion, scoring) or a model (singer, range_bearing); all where it is left out");
  command.flag("--markdown", arguments->markdown, "as docs/keys.md");
  command.runs([arguments] { print_keys(*arguments); });
}

}  // namespace truebearing
