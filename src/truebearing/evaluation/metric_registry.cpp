// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/metric_registry.hpp"

#include <algorithm>
#include <functional>

#include "truebearing/core/suggestion.hpp"
#include "truebearing/evaluation/batch_metrics.hpp"
#include "truebearing/evaluation/event_metrics.hpp"
#include "truebearing/evaluation/time_metrics.hpp"

namespace truebearing {

// Makes a family from the table [scoring], which has its key; nullptr where that says no.
using ReadFamily = std::shared_ptr<const MetricFamily>(TableReader& scoring, const StateSpace& truth,
                                                       ScoringRule& rule);
// Each is defined in the family's own file.
ReadFamily read_target_motion, read_tracks, read_gospa, read_peak_error, read_mse_db, read_mean_error;

namespace {

struct Entry {
  const char* key;  // in [scoring]; empty for one of the usual families
  ReadFamily* read;
};

template <auto Make>
std::shared_ptr<const MetricFamily> always(TableReader&, const StateSpace&, ScoringRule&) {
  return Make();
}

// In the order of the results.
constexpr Entry kFamilies[] = {
    {"", always<time_metrics>},      {"target_motion", read_target_motion},
    {"", always<batch_metrics>},     {"", always<event_metrics>},
    {"tracks", read_tracks},         {"gospa", read_gospa},
    {"peak_error", read_peak_error}, {"mse_db", read_mse_db},
    {"mean_error", read_mean_error},
};

}  // namespace

std::vector<std::shared_ptr<const MetricFamily>> usual_metrics() {
  return {time_metrics(), batch_metrics(), event_metrics()};
}

void read_metrics(TableReader& scoring, const StateSpace& truth, ScoringRule& rule) {
  if (scoring.has("times_s")) {
    rule.times_s = scoring.numbers("times_s", -1, kNonNegative);
    if (std::adjacent_find(rule.times_s.begin(), rule.times_s.end(), std::greater_equal<>()) != rule.times_s.end())
      throw scoring.error("times_s", "do not increase", "times in ascending order, each once");
  }
  rule.families.clear();
  for (const Entry& entry : kFamilies)
    if (*entry.key == '\0' || scoring.has(entry.key))
      if (auto family = entry.read(scoring, truth, rule)) rule.families.push_back(std::move(family));
}

std::string read_scalar_quantity(TableReader& table, const StateSpace& truth) {
  std::vector<std::string> valid;
  for (const Quantity& quantity : truth.quantities)
    if (quantity.indices.size() == 1) valid.push_back(quantity.name);
  const std::string name = table.text("quantity");
  if (std::find(valid.begin(), valid.end(), name) == valid.end())
    throw table.error("quantity", "is no quantity of one component in the scenario's truth: \"" + name + "\"",
                      valid.empty() ? "a truth that has one" : suggestion(name, valid));
  return name;
}

}  // namespace truebearing
