// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/published_rows.hpp"

#include <algorithm>
#include <toml++/toml.h>

#include "truebearing/core/suggestion.hpp"
#include "truebearing/evaluation/metric_family.hpp"

namespace truebearing {
namespace {

// What a comparison has to put beside them: RMSE by quantity, the NEES, and metrics that are at no time.
std::vector<std::string> figure_names(const ScoringRule& rule, const StateSpace& truth) {
  std::vector<std::string> names;
  for (const Quantity& quantity : truth.quantities) names.push_back(quantity.name);
  names.emplace_back("nees");
  const Scorer scorer(truth, truth);
  for (const Metric& metric : MetricTallies(rule, scorer).metrics())
    if (!metric.time_s) names.push_back(metric.name);
  return names;
}

void read_figure(TableReader& row, const std::string& name, const std::vector<std::string>& sets,
                 std::vector<PublishedFigure>& figures) {
  if (!row.node(name)->is_table()) {
    figures.push_back({name, {}, row.number(name)});
    return;
  }
  TableReader by_set = row.table(name);
  for (const std::string& set : by_set.keys()) {
    if (std::find(sets.begin(), sets.end(), set) == sets.end())
      throw by_set.error(set, "is no set of the study",
                         sets.empty() ? "a number: it has no sets" : suggestion(set, sets));
    figures.push_back({name, set, by_set.number(set)});
  }
}

}  // namespace

std::vector<PublishedRow> read_published(TableReader& study, const ScoringRule& rule, const StateSpace& truth,
                                         const std::vector<std::string>& sets) {
  std::vector<PublishedRow> rows;
  for (TableReader& table : study.tables("published")) {
    PublishedRow row{table.text("name"), table.text("source"), {}};
    const auto is_same = [&](const PublishedRow& other) { return other.name == row.name; };
    if (std::any_of(rows.begin(), rows.end(), is_same))
      throw table.error("name", "is \"" + row.name + "\" once more", "a name that no other row has");
    const std::vector<std::string> names = figure_names(rule, truth);
    for (const std::string& key : table.keys()) {
      if (key == "name" || key == "source") continue;
      if (std::find(names.begin(), names.end(), key) == names.end())
        throw table.error(key, "is no figure of this comparison", suggestion(key, names));
      read_figure(table, key, sets, row.figures);
    }
    if (row.figures.empty()) throw table.error("", "holds no figure", "one of those that the comparison prints");
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace truebearing
