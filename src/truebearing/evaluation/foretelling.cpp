// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/foretelling.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/evaluation/metric.hpp"
#include "truebearing/evaluation/text_table.hpp"

namespace truebearing {
namespace {

// Of one log: neighbouring errors go together, and stretches of it are taken for independent.
constexpr std::size_t kStretches = 20;

int place_in(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

// What was missed, step by step; NaN where a tracker had no estimate.
using Misses = std::vector<std::vector<double>>;  // [tracker][foretold]

void hide_and_foretell(const TrackerSet& trackers, const Recording& recording, std::size_t steps, bool first_half,
                       std::string& quantity, Misses& misses, std::vector<double>& gate_sums) {
  TrackerSet set = trackers.fresh();
  const auto is_hidden = [&](std::size_t k) { return (k / steps % 2 == 0) == first_half; };
  std::vector<Measurement> shown = recording.measurements;
  for (std::size_t k = 0; k < shown.size(); ++k)
    if (is_hidden(k)) shown[k].z.setConstant(kNaN);
  set.foresee(shown);
  for (std::size_t k = 0; k < shown.size(); ++k) {
    set.step(shown[k]);
    const Measurement& measurement = recording.measurements[k];
    const bool is_last_hidden = is_hidden(k) && k % steps == steps - 1;
    if (!is_last_hidden || is_unusable(recording, measurement)) continue;
    std::vector<double> missed, gates;
    for (int i = 0; i < set.size(); ++i) {
      const std::span<const StepRecord> records = set.records(i);
      std::string of;
      std::optional<double> one;
      if (records.size() == 1) one = miss(components_of(recording, measurement), measurement, records[0], of);
      if (one && quantity.empty()) quantity = of;
      missed.push_back(one && of == quantity ? *one : kNaN);
      const bool is_corrected = records.size() == 1 && records[0].correction;
      gates.push_back(is_corrected ? records[0].correction->gate : kNaN);
    }
    if (std::any_of(missed.begin(), missed.end(), [](double error) { return !std::isfinite(error); })) continue;
    for (std::size_t i = 0; i < missed.size(); ++i) {
      misses[i].push_back(missed[i]);
      gate_sums[i] += gates[i];
    }
  }
}

std::vector<SquaredErrors> stretches_of(const std::vector<double>& errors) {
  std::vector<SquaredErrors> stretches(std::min(kStretches, errors.size()));
  for (std::size_t k = 0; k < errors.size(); ++k) stretches[k * stretches.size() / errors.size()].add(errors[k]);
  return stretches;
}

// Mean of a^2 - b^2, with its standard error over the stretches.
Estimate difference_of(const std::vector<double>& a, const std::vector<double>& b) {
  const std::vector<SquaredErrors> of_a = stretches_of(a), of_b = stretches_of(b);
  std::vector<double> means;
  for (std::size_t i = 0; i < of_a.size(); ++i) means.push_back(mean_square(of_a[i]) - mean_square(of_b[i]));
  return mean_of(means);
}

}  // namespace

std::optional<double> miss(const std::vector<std::string>& components, const Measurement& measurement,
                           const StepRecord& record, std::string& quantity) {
  const BoundedVector &z = measurement.z, &x = record.x;
  const SensorState sensor = measurement.sensor.value_or(SensorState{});
  double squared = 0.0;
  int places = 0;
  for (std::size_t i = 0; i < components.size(); ++i) {
    const int state = record.space->component_index(components[i]);
    const bool is_place = components[i] == "position_m" || components[i] == "east_m" || components[i] == "north_m" ||
                          components[i] == "up_m" || components[i].starts_with("lorenz_");
    if (state < 0 || !is_place) continue;
    const double error = z[static_cast<Eigen::Index>(i)] - x[state];
    squared += error * error;
    ++places;
  }
  if (places > 0) {
    quantity = components.front().starts_with("lorenz_") ? "state" : "position_m";
    return std::sqrt(squared);
  }
  const int east = record.space->component_index("east_m"), north = record.space->component_index("north_m");
  const int range = place_in(components, "range_m"), bearing = place_in(components, "bearing_deg");
  if (east < 0 || north < 0 || (range < 0 && bearing < 0)) return std::nullopt;
  const Eigen::Vector2d sight = Eigen::Vector2d(x[east], x[north]) - sensor.position_m;
  const double turned_rad = bearing < 0 ? 0.0 : wrap_pi(z[bearing] - std::atan2(sight.x(), sight.y()));
  if (range < 0) {
    quantity = "bearing_deg";
    return degrees(std::abs(turned_rad));
  }
  // Slant ranges are held against slant ranges.
  const int up = record.space->component_index("up_m");
  const double height_m = up < 0 ? 0.0 : x[up] - sensor.up_m, range_m = std::hypot(sight.norm(), height_m);
  quantity = bearing < 0 ? "range_m" : "position_m";
  return std::hypot(z[range] - range_m, sight.norm() * turned_rad);
}

Foretelling foretell(const TrackerSet& trackers, const Recording& recording, int steps) {
  constexpr std::size_t kLeast = 4;
  Foretelling told{steps, {}, 0, {}, 0};
  Misses misses(static_cast<std::size_t>(trackers.size()));
  std::vector<double> gate_sums(misses.size());
  for (const bool first_half : {false, true})
    hide_and_foretell(trackers, recording, static_cast<std::size_t>(steps), first_half, told.quantity, misses,
                      gate_sums);
  told.foretold = misses.front().size();
  if (told.foretold < kLeast)
    throw InputError("the log",
                     fmt::format("has {} measurements that all trackers foretell {} steps ahead", told.foretold, steps),
                     fmt::format("{} or more, of places, ranges or bearings of one target", kLeast));
  for (std::size_t i = 0; i < misses.size(); ++i) {
    told.trackers.push_back({trackers.name(static_cast<int>(i)),
                             pooled_rmse(stretches_of(misses[i])),
                             {0.0, 0.0},
                             gate_sums[i] / static_cast<double>(told.foretold)});
    if (told.trackers[i].rmse.value < told.trackers[told.best].rmse.value) told.best = i;
  }
  for (std::size_t i = 0; i < misses.size(); ++i)
    if (i != told.best) told.trackers[i].above_best = difference_of(misses[i], misses[told.best]);
  return told;
}

std::string foretelling_text(const Foretelling& told) {
  constexpr double kShut = 0.05;
  const std::string title = title_of(told.quantity);
  std::vector<std::vector<std::string>> rows{
      {"foretold", fmt::format("{} RMSE", title), "+-", "squared, above the best", "in standard errors"}};
  const Foretelling::Tracker& best = told.trackers[told.best];
  const Foretelling::Tracker* next = nullptr;
  for (const Foretelling::Tracker& one : told.trackers) {
    const bool is_best = &one == &best;
    if (!is_best && (!next || one.rmse.value < next->rmse.value)) next = &one;
    rows.push_back({one.name, fmt::format("{:.4g}{}", one.rmse.value, is_best ? "*" : ""),
                    fmt::format("{:.2g}", one.rmse.se), is_best ? "" : fmt::format("{:.3g}", one.above_best.value),
                    one.above_best.se > 0.0 ? fmt::format("{:.1f}", one.above_best.value / one.above_best.se) : ""});
  }
  std::string text = aligned(rows);
  text += fmt::format("{} measurements, {} step{} ahead, each half of the log foretold from the other\n", told.foretold,
                      told.steps, told.steps == 1 ? "" : "s");
  for (const Foretelling::Tracker& one : told.trackers)
    if (one.mean_gate < kShut)
      text += fmt::format(
          "{}: its gate is shut where measurements are hidden, and its figure is that of what it trusts\n", one.name);
  if (!next) return text;
  const double errors = next->above_best.value / next->above_best.se;
  text += errors > 2.0 ? fmt::format("{} foretells best: {:.2g} % below {} ({:.1f} standard errors)\n", best.name,
                                     100.0 * (1.0 - best.rmse.value / next->rmse.value), next->name, errors)
                       : fmt::format("{} and {} foretell alike: no difference can be told\n", best.name, next->name);
  return text;
}

}  // namespace truebearing
