#include "truebearing/study/tracker_spec.hpp"

#include <set>
#include <toml++/toml.h>

#include "truebearing/core/suggestion.hpp"
#include "truebearing/study/configuration_text.hpp"
#include "truebearing/study/parameters_file.hpp"

namespace truebearing {
namespace {

constexpr const char* kStudyKeys[] = {"kind", "like", "tune", "show"};

// A tracker's table over the tables of those it is `like`, however long the chain.
toml::table resolved(TableReader& trackers, const std::string& name, std::set<std::string> seen = {}) {
  if (!seen.insert(name).second) throw trackers.error(name, "is `like` itself");
  TableReader table = trackers.table(name);
  if (!table.has("like")) return *table.raw();
  const std::string parent = table.text("like");
  if (!trackers.has(parent))
    throw table.error("like", "names no tracker: \"" + parent + "\"", suggestion(parent, trackers.keys()));
  toml::table inherited = resolved(trackers, parent, seen);
  for (const char* key : {"tune", "show", "like"}) inherited.erase(key);
  return merged(inherited, *table.raw());
}

}  // namespace

std::vector<TrackerSpec> read_tracker_specs(TableReader table, const std::vector<std::string>& order) {
  std::vector<TrackerSpec> trackers;
  for (const std::string& name : order) {
    TrackerSpec spec;
    spec.name = name;
    toml::table resolved_table = resolved(table, name);
    TableReader reader(std::make_shared<const toml::table>(resolved_table), table.file(), "trackers." + name);
    spec.kind = reader.text("kind");
    spec.shown = reader.boolean_or("show", true);
    if (reader.has("tune")) {
      spec.tune = reader.texts("tune");
      for (const std::string& path : spec.tune)
        numbers_at(*reader.raw(), path, table.file() + ": trackers." + name + ".tune");
    }
    ask_for_study_keys(reader);
    if (spec.kind == "corrected") {
      spec.correction = read_correction_spec(reader);
      reader.finish();
    }
    for (const char* key : kStudyKeys) resolved_table.erase(key);
    spec.configuration = std::make_shared<const toml::table>(std::move(resolved_table));
    trackers.push_back(std::move(spec));
  }
  if (trackers.empty()) throw table.error("", "names no tracker", "at least one");
  return trackers;
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
