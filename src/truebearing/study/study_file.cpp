// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/study_file.hpp"

#include <algorithm>
#include <toml++/toml.h>

#include "truebearing/study/configuration_text.hpp"

namespace truebearing {
namespace {

std::vector<std::string> tracker_order(const SharedTable& study, const std::filesystem::path& path) {
  TableReader reader(study, path.string());
  const auto trackers = reader.table_if_present("trackers");
  return trackers ? trackers->keys() : std::vector<std::string>{};
}

// `first`, then what only `second` has.
std::vector<std::string> joined(std::vector<std::string> first, const std::vector<std::string>& second) {
  for (const std::string& name : second)
    if (std::find(first.begin(), first.end(), name) == first.end()) first.push_back(name);
  return first;
}

// Paths of one study as another one in the folder `from` writes them.
class MovedPaths {
 public:
  explicit MovedPaths(std::filesystem::path from) : from_(std::move(from)) {}

  void in_study(toml::table& study) const {
    text(study, "scenario");
    text(study, "parameters");
    if (auto* scenario = study["scenario"].as_table()) in_scenario(*scenario);
    in_each(study, "sets", [this](toml::table& sets, std::string_view name) { in_changed_scenario(sets, name); });
    in_each(study, "trackers", [this](toml::table& trackers, std::string_view name) {
      if (auto* tracker = trackers[name].as_table()) in_tracker(*tracker);
    });
  }

 private:
  template <typename Change>
  static void in_each(toml::table& study, std::string_view key, Change change) {
    if (auto* table = study[key].as_table())
      for (const auto& [name, value] : *table) change(*table, name.str());
  }

  void in_tracker(toml::table& tracker) const {
    text(tracker, "model");
    text(tracker, "file");
    if (auto* motion = tracker["motion"].as_table()) {
      text(*motion, "file");
      if (auto* training = (*motion)["training"].as_table()) in_changed_scenario(*training, "scenario");
    }
    if (auto* training = tracker["training"].as_table())
      for (const char* key : {"scenario", "covariance_scenario"}) in_changed_scenario(*training, key);
  }

  // A file, or a table that may name one.
  void in_changed_scenario(toml::table& table, std::string_view key) const {
    text(table, key);
    if (auto* changed = table[key].as_table()) text(*changed, "scenario");
  }

  // Of kind "step_logs".
  void in_scenario(toml::table& scenario) const {
    for (const char* key : {"training", "validation", "evaluation"})
      if (auto* files = scenario[key].as_array())
        for (toml::node& file : *files)
          if (auto* name = file.as_string()) move(name->get());
  }

  void text(toml::table& table, std::string_view key) const {
    if (auto* value = table[key].as_string()) move(value->get());
  }

  void move(std::string& path) const {
    if (!std::filesystem::path(path).is_absolute()) path = (from_ / path).string();
  }

  std::filesystem::path from_;
};

}  // namespace

StudyFile read_study_file(const std::filesystem::path& path) {
  StudyFile file{read_toml_file(path), nullptr, {}};
  file.trackers = tracker_order(file.table, path);
  TableReader reader(file.table, path.string());
  if (!reader.has("like")) return file;
  const std::filesystem::path parent = reader.text("like");
  const std::filesystem::path parent_file = reader.resolve(parent.string());
  const SharedTable inherited = read_toml_file(parent_file);
  if (inherited->contains("like")) throw reader.error("like", "names a study that is itself `like` another");
  toml::table moved = *inherited;
  if (parent.has_parent_path()) MovedPaths(parent.parent_path()).in_study(moved);
  file.own = file.table;
  file.table = std::make_shared<const toml::table>(merged(moved, *file.own));
  file.trackers = joined(tracker_order(inherited, parent_file), file.trackers);
  return file;
}

}  // namespace truebearing
