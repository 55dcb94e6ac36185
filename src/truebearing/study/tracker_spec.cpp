// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/tracker_spec.hpp"

#include <fmt/format.h>
#include <map>
#include <set>
#include <toml++/toml.h>

#include "truebearing/core/printable.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/study/configuration_text.hpp"
#include "truebearing/study/parameters_file.hpp"
#include "truebearing/study/tracker_registry.hpp"

namespace truebearing {
namespace {

constexpr const char* kStudyKeys[] = {"kind", "like", "tune", "show"};

constexpr int kMaxChain = 32;
constexpr std::size_t kMaxValues = 100'000;

std::size_t count_values(const toml::node& node) {
  std::size_t count = 1;
  if (const auto* table = node.as_table())
    for (const auto& [key, value] : *table) count += count_values(value);
  if (const auto* array = node.as_array())
    for (const toml::node& value : *array) count += count_values(value);
  return count;
}

// The trackers' tables over the tables of those they are `like`. Each is made once, and all together are bounded, since
// a short file may say `like` very often.
class ResolvedTables {
 public:
  explicit ResolvedTables(TableReader trackers) : trackers_(std::move(trackers)) {}

  const SharedTable& of(const std::string& name) { return resolved(name, {}).table; }

 private:
  struct Resolved {
    SharedTable table;
    int chain = 0;  ///< how many it is `like`, one after the other
  };

  // `children` are those that wait for it.
  const Resolved& resolved(const std::string& name, std::set<std::string> children) {
    if (const auto found = known_.find(name); found != known_.end()) return found->second;
    if (!children.insert(name).second) throw trackers_.error(name, "is `like` itself");
    if (children.size() > kMaxChain + 1) throw too_long(name);
    TableReader table = trackers_.table(name);
    return known_.emplace(name, table.has("like") ? over_parent(table, name, children) : counted(*table.raw(), 0))
        .first->second;
  }

  Resolved over_parent(TableReader& table, const std::string& name, const std::set<std::string>& children) {
    const std::string parent = table.text("like");
    if (!trackers_.has(parent))
      throw table.error("like", "names no tracker: \"" + parent + "\"", suggestion(parent, trackers_.keys()));
    const Resolved& above = resolved(parent, children);
    if (above.chain == kMaxChain) throw too_long(name);
    toml::table inherited = *above.table;
    for (const char* key : {"tune", "show", "like"}) inherited.erase(key);
    return counted(merged(inherited, *table.raw()), above.chain + 1);
  }

  Resolved counted(toml::table table, int chain) {
    values_ += count_values(table);
    if (values_ > kMaxValues)
      throw trackers_.error("", fmt::format("hold more than {} values with what they take over", kMaxValues), "fewer");
    return {std::make_shared<const toml::table>(std::move(table)), chain};
  }

  InputError too_long(const std::string& name) const {
    return trackers_.error(name, "is `like` one that is `like` another, and so on",
                           fmt::format("at most {} times", kMaxChain));
  }

  TableReader trackers_;
  std::map<std::string, Resolved> known_;
  std::size_t values_ = 0;
};

// What the study's own file says of a tracker, else the file that it is `like`.
SharedTable own_table(const StudyFile& file, const std::string& name) {
  for (const SharedTable& study : {file.own, file.table})
    if (study)
      if (const toml::table* own = (*study)["trackers"][name].as_table()) return {study, own};
  return nullptr;
}

// sensors: the study's, which a tracker of several reads as if it had said them itself; nullptr where there are none.
TrackerSpec read_tracker_spec(const std::string& name, const SharedTable& resolved, const SharedTable& own,
                              const toml::table* sensors, const std::string& file) {
  TrackerSpec spec;
  spec.name = name;
  spec.own = own;
  TableReader reader(resolved, file, "trackers." + name, own);
  spec.where = reader.where();
  spec.kind = reader.text("kind");
  spec.shown = reader.boolean_or("show", true);
  if (reader.has("tune")) {
    spec.tune = reader.texts("tune");
    for (const std::string& path : spec.tune) numbers_at(*reader.raw(), path, reader.where("tune"));
  }
  ask_for_study_keys(reader);
  if (spec.kind == "corrected") {
    spec.correction = read_correction_spec(reader);
    reader.finish();
  }
  if (spec.kind == kSmoother) {
    if (!spec.tune.empty())
      throw reader.error("tune", "is of a smoother, which has the numbers of its filter", "`tune` of that");
    spec.smoother.emplace().of = reader.text("of");
    spec.smoother->lag_s = reader.number_or("lag_s", spec.smoother->lag_s, kPositive);
    reader.finish();
  }
  if (reader.raw()->at_path("motion.model").value_or(std::string()) == "learned") {
    TableReader motion = reader.table("motion");
    spec.learned = read_learned_motion_spec(motion);
  }
  toml::table configuration = *resolved;
  for (const char* key : kStudyKeys) configuration.erase(key);
  if (sensors)
    if (toml::table* measurement = configuration["measurement"].as_table();
        measurement && (*measurement)["model"].value_or(std::string()) == "sensors")
      measurement->insert("sensors", *sensors);
  spec.configuration = std::make_shared<const toml::table>(std::move(configuration));
  return spec;
}

}  // namespace

std::vector<TrackerSpec> read_tracker_specs(const StudyFile& file, const std::string& name) {
  TableReader trackers = TableReader(file.table, name).table("trackers");
  ResolvedTables resolved(trackers);
  std::vector<TrackerSpec> specs;
  for (const std::string& tracker : file.trackers) check_name(trackers, tracker, tracker);
  for (const std::string& tracker : file.trackers)
    specs.push_back(read_tracker_spec(tracker, resolved.of(tracker), own_table(file, tracker),
                                      (*file.table)["sensors"].as_table(), name));
  if (specs.empty()) throw trackers.error("", "names no tracker", "at least one");
  return specs;
}

TableReader tracker_reader(const TrackerSpec& spec, const SharedTable& configuration, const std::string& file) {
  return {configuration, file, "trackers." + spec.name, spec.own};
}

void check_name(const TableReader& table, const std::string& key, const std::string& name) {
  if (name.empty() || printable(name) != name)
    throw table.error(key, "is no name: " + as_shown(name), "characters that can be shown, at least one");
}

std::vector<std::string> names_of(const std::vector<TrackerSpec>& trackers) {
  std::vector<std::string> names;
  for (const TrackerSpec& tracker : trackers) names.push_back(tracker.name);
  return names;
}

void ask_for_study_keys(TableReader& tracker) {
  for (const char* key : kStudyKeys) tracker.node(key);
}

}  // namespace truebearing
