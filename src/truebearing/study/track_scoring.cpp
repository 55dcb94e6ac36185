#include "truebearing/study/track_scoring.hpp"

#include <algorithm>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/suggestion.hpp"

namespace truebearing {
namespace {

// The name of a quantity of the truth that has one component.
std::string read_quantity(TableReader& table, const StateSpace& truth) {
  std::vector<std::string> valid;
  for (const Quantity& quantity : truth.quantities)
    if (quantity.indices.size() == 1) valid.push_back(quantity.name);
  const std::string name = table.text("quantity");
  if (std::find(valid.begin(), valid.end(), name) == valid.end())
    throw table.error("quantity", "is no quantity of one component in the scenario's truth: \"" + name + "\"",
                      valid.empty() ? "a truth that has one" : suggestion(name, valid));
  return name;
}

}  // namespace

void read_track_scoring(TableReader& scoring, const StateSpace& truth, ScoringRule& rule) {
  if (auto table = scoring.table_if_present("tracks")) {
    TrackRule& tracks = rule.tracks.emplace();
    tracks.quantity = read_quantity(*table, truth);
    tracks.bad = table->number("bad", kPositive);
    tracks.last_steps = static_cast<int>(table->integer_or("last_steps", tracks.last_steps, 1, 1000000));
    tracks.excursion = table->number("excursion", kPositive);
    table->finish();
  }
  if (auto table = scoring.table_if_present("gospa")) {
    GospaRule& gospa = rule.gospa.emplace();
    gospa.quantity = read_quantity(*table, truth);
    gospa.cutoff = table->number("cutoff", kPositive);
    table->finish();
  }
  if (rule.tracks && rule.gospa) throw scoring.error("gospa", "stands beside tracks", "one of the two");
  for (const char* key : {"tracks", "gospa"})
    if (scoring.has(key) && !rule.times_s.empty())
      throw scoring.error(key, "stands beside times_s, which is of one target", "one of the two");
}

std::optional<AngleBound> read_angle_bound(TableReader& scoring, const StateSpace& truth) {
  std::optional<TableReader> table = scoring.table_if_present("angle_bound");
  if (!table) return std::nullopt;
  if (truth != angle_space())
    throw scoring.error("angle_bound", "is of angles at a line array, and the scenario's truth is " + truth.name);
  AngleBound bound;
  bound.q_rad2ps3 = table->number_or("q_deg2ps3", 0.03, kPositive) * radians(1.0) * radians(1.0);
  bound.rate_sigma_radps = radians(table->number_or("rate_sigma_degps", 2.0, kPositive));
  bound.apart_rad = radians(table->number_or("apart_deg", 10.0, kNonNegative));
  table->finish();
  return bound;
}

}  // namespace truebearing
