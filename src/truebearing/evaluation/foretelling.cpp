// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/foretelling.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <utility>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/evaluation/metric.hpp"
#include "truebearing/evaluation/place_of.hpp"
#include "truebearing/evaluation/text_table.hpp"

namespace truebearing {
namespace {

// Of one log: neighbouring errors go together, and stretches of it are taken for independent. The 97.5 % point of
// Student's t for the mean of so many.
constexpr std::size_t kStretches = 12;
constexpr double kStudent = 2.2;

// Of one hidden measurement, by tracker: what it missed, NaN where it had no estimate, and how far a correction's gate was
// open, NaN of what is none.
struct Foretold {
  std::size_t row;
  std::vector<double> missed, gates;
};

// Of each sensor `steps` rows are hidden and as many shown in turn.
void hide_and_foretell(const TrackerSet& trackers, const Recording& recording, std::size_t steps, bool first_half,
                       const SensorSites& sites, std::string& quantity, std::vector<Foretold>& all) {
  TrackerSet set = trackers.fresh();
  std::map<int, std::size_t> seen;  // rows of each sensor
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const Measurement& measurement = recording.measurements[k];
    const std::size_t own = seen[measurement.source]++;
    const bool is_hidden = (own / steps % 2 == 0) == first_half;
    Measurement shown = measurement;
    if (is_hidden) shown.z.setConstant(kNaN);
    set.step(shown);
    if (!is_hidden || own % steps != steps - 1 || is_unusable(recording, measurement)) continue;
    Foretold one{k, {}, {}};
    for (int i = 0; i < set.size(); ++i) {
      const std::span<const StepRecord> records = set.records(i);
      std::string of;
      std::optional<double> missed;
      if (records.size() == 1) missed = miss(components_of(recording, measurement), measurement, sites, records[0], of);
      if (missed && quantity.empty()) quantity = of;
      one.missed.push_back(missed && of == quantity ? *missed : kNaN);
      one.gates.push_back(missed && records[0].correction ? records[0].correction->gate : kNaN);
    }
    all.push_back(std::move(one));
  }
}

std::vector<SquaredErrors> stretches_of(const std::vector<double>& errors) {
  std::vector<SquaredErrors> stretches(std::min(kStretches, errors.size()));
  for (std::size_t k = 0; k < errors.size(); ++k) stretches[k * stretches.size() / errors.size()].add(errors[k]);
  return stretches;
}

// Mean of a^2 - b^2. Its standard error is the jackknife, one stretch left out at a time, as that of an RMSE.
Estimate difference_of(const std::vector<double>& a, const std::vector<double>& b) {
  const std::vector<SquaredErrors> of_a = stretches_of(a), of_b = stretches_of(b);
  const auto n = static_cast<double>(a.size()), stretches = static_cast<double>(of_a.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < of_a.size(); ++i) sum += of_a[i].sum - of_b[i].sum;
  double mean = 0.0, squares = 0.0;  // of what is left without one of them
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    const double left = (sum - of_a[i].sum + of_b[i].sum) / (n - of_a[i].count), from_mean = left - mean;
    mean += from_mean / static_cast<double>(i + 1);
    squares += from_mean * (left - mean);
  }
  return {sum / n, std::sqrt((stretches - 1.0) / stretches * squares)};
}

}  // namespace

std::optional<double> miss(const std::vector<std::string>& components, const Measurement& measurement,
                           const SensorSites& sites, const StepRecord& record, std::string& quantity) {
  const BoundedVector &z = measurement.z, &x = record.x;
  const SensorState sensor = sites.of(measurement);
  double squared = 0.0;
  int places = 0;
  for (std::size_t i = 0; i < components.size(); ++i) {
    const int state = record.space->component_index(components[i]);
    const bool is_place = components[i] == "position_m" || components[i] == "east_m" || components[i] == "north_m" ||
                          components[i] == "up_m" || components[i].starts_with("lorenz_");
    if (state < 0 || !is_place || static_cast<Eigen::Index>(i) >= z.size()) continue;
    const double error = z[static_cast<Eigen::Index>(i)] - x[state];
    squared += error * error;
    ++places;
  }
  if (places > 0) {
    quantity = components.front().starts_with("lorenz_") ? "state" : "position_m";
    return std::sqrt(squared);
  }
  const int east = record.space->component_index("east_m"), north = record.space->component_index("north_m");
  const int range = place_of(components, "range_m"), bearing = place_of(components, "bearing_deg"),
            elevation = place_of(components, "elevation_deg");
  if (east < 0 || north < 0 || (range < 0 && bearing < 0) || z.size() < static_cast<Eigen::Index>(components.size()))
    return std::nullopt;
  const int up = record.space->component_index("up_m");
  const Eigen::Vector2d sight = Eigen::Vector2d(x[east], x[north]) - sensor.position_m;
  const double height_m = up < 0 ? 0.0 : x[up] - sensor.up_m, range_m = std::hypot(sight.norm(), height_m);
  const double turned_rad = bearing < 0 ? 0.0 : wrap_pi(z[bearing] - std::atan2(sight.x(), sight.y()));
  const double raised_rad = elevation < 0 || up < 0 ? 0.0 : z[elevation] - std::atan2(height_m, sight.norm());
  if (range < 0) {
    quantity = "bearing_deg";
    return degrees(std::hypot(turned_rad, raised_rad));
  }
  // Slant ranges are held against slant ranges.
  quantity = bearing < 0 ? "range_m" : "position_m";
  return std::hypot(std::hypot(z[range] - range_m, sight.norm() * turned_rad), range_m * raised_rad);
}

Foretelling foretell(const TrackerSet& trackers, const Recording& recording, int steps, const SensorSites& sites) {
  constexpr std::size_t kLeast = 4;
  Foretelling told{steps, {}, 0, {}, 0, {}};
  std::vector<Foretold> all;
  for (const bool first_half : {false, true})
    hide_and_foretell(trackers, recording, static_cast<std::size_t>(steps), first_half, sites, told.quantity, all);
  std::sort(all.begin(), all.end(), [](const Foretold& a, const Foretold& b) { return a.row < b.row; });
  std::vector<std::size_t> who;  // has estimates where measurements are hidden
  for (std::size_t i = 0; i < static_cast<std::size_t>(trackers.size()); ++i) {
    const bool has_any =
        std::any_of(all.begin(), all.end(), [&](const Foretold& one) { return std::isfinite(one.missed[i]); });
    if (has_any)
      who.push_back(i);
    else
      told.left_out.push_back(trackers.name(static_cast<int>(i)));
  }
  std::erase_if(all, [&](const Foretold& one) {
    return !std::all_of(who.begin(), who.end(), [&](std::size_t i) { return std::isfinite(one.missed[i]); });
  });
  told.foretold = all.size();
  if (who.empty() || all.size() < kLeast)
    throw InputError("the log",
                     fmt::format("has {} measurements that trackers foretell {} steps ahead", all.size(), steps),
                     fmt::format("{} or more, of places, ranges or bearings of one target", kLeast));
  std::vector<std::vector<double>> missed(who.size());
  for (std::size_t w = 0; w < who.size(); ++w) {
    double gates = 0.0;
    for (const Foretold& one : all) {
      missed[w].push_back(one.missed[who[w]]);
      gates += one.gates[who[w]];
    }
    told.trackers.push_back({trackers.name(static_cast<int>(who[w])),
                             pooled_rmse(stretches_of(missed[w])),
                             {0.0, 0.0},
                             gates / static_cast<double>(all.size())});
    if (told.trackers[w].rmse.value < told.trackers[told.best].rmse.value) told.best = w;
  }
  for (std::size_t w = 0; w < who.size(); ++w)
    if (w != told.best) told.trackers[w].above_best = difference_of(missed[w], missed[told.best]);
  return told;
}

std::string foretelling_verdict(const Foretelling& told) {
  const Foretelling::Tracker& best = told.trackers[told.best];
  const Foretelling::Tracker* next = nullptr;
  for (const Foretelling::Tracker& one : told.trackers)
    if (&one != &best && (!next || one.rmse.value < next->rmse.value)) next = &one;
  if (!next) return {};
  const double errors = next->above_best.value / next->above_best.se;
  if (!(errors > kStudent))
    return fmt::format("{} and {} foretell alike: no difference can be told", best.name, next->name);
  return fmt::format("{} foretells best: {:.2g} % below {} ({:.1f} standard errors)", best.name,
                     100.0 * (1.0 - best.rmse.value / next->rmse.value), next->name, errors);
}

std::string foretelling_text(const Foretelling& told) {
  constexpr double kShut = 0.05;
  const std::string title = title_of(told.quantity);
  std::vector<std::vector<std::string>> rows{
      {"foretold", fmt::format("{} RMSE", title), "+-", "squared, above the best", "in standard errors"}};
  for (const Foretelling::Tracker& one : told.trackers) {
    const bool is_best = &one == &told.trackers[told.best];
    rows.push_back({one.name, fmt::format("{:.4g}{}", one.rmse.value, is_best ? "*" : ""),
                    fmt::format("{:.2g}", one.rmse.se), is_best ? "" : fmt::format("{:.3g}", one.above_best.value),
                    one.above_best.se > 0.0 ? fmt::format("{:.1f}", one.above_best.value / one.above_best.se) : ""});
  }
  std::string text = aligned(rows);
  text += fmt::format("{} measurements, {} step{} ahead, each half of the log foretold from the other\n", told.foretold,
                      told.steps, told.steps == 1 ? "" : "s");
  for (const std::string& name : told.left_out)
    text += fmt::format("{}: has no estimate where measurements are hidden\n", name);
  for (const Foretelling::Tracker& one : told.trackers)
    if (one.mean_gate < kShut)
      text += fmt::format(
          "{}: its gate is shut where measurements are hidden, and its figure is that of what it trusts\n", one.name);
  if (const std::string verdict = foretelling_verdict(told); !verdict.empty()) text += verdict + "\n";
  return text;
}

}  // namespace truebearing
