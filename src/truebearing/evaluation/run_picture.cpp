// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/run_picture.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "truebearing/evaluation/run_canvas.hpp"

namespace truebearing {
namespace {

int index_in(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

RunPicture draw(TrackerSet trackers, const std::vector<std::string>& drawn, const Recording& recording,
                const SensorSites& sites) {
  RunPicture picture;
  const RunCanvas canvas(*recording.truth_space);
  picture.in_plane = canvas.in_plane();
  picture.component = canvas.component();
  for (const Truth& truth : recording.truth) {
    DrawnLine& line = picture.truth.emplace_back();
    line.track = truth.track;
    for (std::size_t step = 0; step < truth.x.size(); ++step)
      canvas.add(recording.measurements[step].time_s, truth.x[step], line);
  }
  canvas.add_measured(recording, sites, picture);
  canvas.add_beam(recording, picture);
  trackers.foresee(recording.measurements);
  for (const Measurement& measurement : recording.measurements) {
    trackers.step(measurement);
    for (int i = 0; i < trackers.size(); ++i)
      if (index_in(drawn, trackers.name(i)) >= 0)
        canvas.add_records(trackers.records(i), trackers.name(i), picture.tracks);
  }
  return picture;
}

}  // namespace

std::vector<std::string> drawn_trackers(const Comparison& comparison) {
  if (!comparison.pairs.empty()) return {comparison.pairs.front().a, comparison.pairs.front().b};
  const TrackerSummary* best = nullptr;
  for (const TrackerSummary& tracker : comparison.trackers) {
    if (tracker.quantities.empty() || index_in(comparison.bounds, tracker.name) >= 0) continue;
    if (!best || tracker.quantities.front().rmse < best->quantities.front().rmse) best = &tracker;
  }
  return best ? std::vector<std::string>{best->name} : std::vector<std::string>{};
}

std::vector<RunPicture> picture_runs(const TrackerSet& trackers, const std::vector<NamedScenario>& scenarios,
                                     const ComparisonOptions& options, const Comparison& comparison,
                                     const SensorSites& sites) {
  const std::vector<std::string> drawn = drawn_trackers(comparison);
  if (drawn.empty() || comparison.details.size() != comparison.trackers.size()) return {};
  std::size_t judge = 0;
  while (comparison.trackers[judge].name != drawn.front()) ++judge;
  if (comparison.details[judge].run_rmse.empty()) return {};
  const std::vector<double>& rmse = comparison.details[judge].run_rmse.front();
  std::vector<std::size_t> order;
  for (std::size_t run = 0; run < std::min(rmse.size(), scenarios.size() * options.runs); ++run)
    if (std::isfinite(rmse[run])) order.push_back(run);
  if (order.empty()) return {};
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rmse[a] < rmse[b]; });

  std::vector<std::pair<const char*, std::size_t>> chosen{{"median", order[(order.size() - 1) / 2]}};
  if (order.size() > 1) chosen.insert(chosen.begin(), {"best", order.front()});
  if (order.size() > 2) chosen.emplace_back("worst", order.back());
  std::vector<RunPicture> pictures;
  for (const auto& [which, run] : chosen) {
    const NamedScenario& scenario = scenarios[run / options.runs];
    const RunKey key{options.seed, options.role, run % options.runs};
    RunPicture picture = draw(trackers.fresh(), drawn, scenario.scenario->simulate(key), sites);
    picture.which = which;
    picture.run = run % options.runs;
    if (scenarios.size() > 1) picture.set = scenario.name;
    if (options.scoring.assignment && options.scoring.assignment->quantity == picture.component)
      picture.assigned_within = options.scoring.assignment->cutoff;
    picture.judged_by = drawn.front();
    picture.quantity = comparison.trackers[judge].quantities.front().name;
    picture.rmse = rmse[run];
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

}  // namespace truebearing
