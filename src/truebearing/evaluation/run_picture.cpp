// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/run_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

/// What is drawn of states of one space.
class Canvas {
 public:
  explicit Canvas(const StateSpace& space) : space_(space), plane_(begins_in_plane(space)) {
    component_ = space.components.front();
    for (const Quantity& quantity : space.quantities)
      if (quantity.indices == std::vector<int>{0}) {
        component_ = quantity.name;
        scale_ = quantity.scale;
      }
  }

  bool in_plane() const { return plane_; }
  const std::string& component() const { return component_; }
  double scale() const { return scale_; }

  void add(double time_s, const BoundedVector& x, DrawnLine& line) const {
    line.time_s.push_back(time_s);
    if (plane_) line.x.push_back(x(0));
    line.y.push_back(plane_ ? x(1) : scale_ * x(0));
  }

  /// A record of another space than the truth's is drawn where it has the same components.
  void add(const StepRecord& record, DrawnTrack& track) const {
    const int first = record.space->component_index(space_.components[0]);
    const int second = plane_ ? record.space->component_index(space_.components[1]) : first;
    if (first < 0 || second < 0 || record.x.size() <= std::max(first, second)) return;
    BoundedVector drawn(2);
    drawn << record.x(first), record.x(second);
    add(record.time_s, drawn, track.line);
    const bool known = record.P.rows() == record.x.size();
    const auto variance = [&](int i, int j) { return known ? record.P(i, j) : kNaN; };
    if (plane_) {
      track.xx.push_back(variance(first, first));
      track.xy.push_back(variance(first, second));
    }
    track.yy.push_back((plane_ ? 1.0 : scale_ * scale_) * variance(second, second));
  }

 private:
  const StateSpace& space_;
  bool plane_;
  std::string component_;
  double scale_ = 1.0;
};

int index_in(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

// Bearings are clockwise from North.
void draw_measured(const Recording& recording, const Canvas& canvas, RunPicture& picture) {
  const int east = index_in(recording.measured, "east_m"), north = index_in(recording.measured, "north_m");
  const int range = index_in(recording.measured, "range_m"), bearing = index_in(recording.measured, "bearing_deg");
  const int value = index_in(recording.measured, canvas.component());
  const bool sights = canvas.in_plane() && bearing >= 0 && range < 0;
  for (const Measurement& measurement : recording.measurements) {
    const SensorState sensor = measurement.sensor.value_or(SensorState{});
    const auto z = [&](int i) { return i < measurement.z.size() ? measurement.z(i) : kNaN; };
    BoundedVector at(2);
    if (sights) {
      at = sensor.position_m;
      canvas.add(measurement.time_s, at, picture.own_ship);
      picture.bearing_deg.push_back(degrees(z(bearing)));
    } else if (canvas.in_plane() && range >= 0 && bearing >= 0) {
      at << sensor.position_m.x() + z(range) * std::sin(z(bearing)),
          sensor.position_m.y() + z(range) * std::cos(z(bearing));
      canvas.add(measurement.time_s, at, picture.measured);
    } else if (canvas.in_plane() && east >= 0 && north >= 0) {
      at << z(east), z(north);
      canvas.add(measurement.time_s, at, picture.measured);
    } else if (!canvas.in_plane() && value >= 0) {
      at << z(value) / canvas.scale(), 0.0;
      canvas.add(measurement.time_s, at, picture.measured);
    }
  }
}

void draw_records(std::span<const StepRecord> records, const std::string& name, const Canvas& canvas,
                  std::vector<DrawnTrack>& tracks) {
  for (const StepRecord& record : records) {
    if (!record.x.allFinite() || record.x.size() == 0) continue;
    auto track = std::find_if(tracks.begin(), tracks.end(), [&](const DrawnTrack& other) {
      return other.tracker == name && other.line.track == record.track;
    });
    if (track == tracks.end()) {
      tracks.push_back({name, {record.track, {}, {}, {}}, {}, {}, {}});
      track = tracks.end() - 1;
    }
    canvas.add(record, *track);
  }
}

RunPicture draw(TrackerSet trackers, const std::vector<std::string>& drawn, const Recording& recording) {
  RunPicture picture;
  const Canvas canvas(*recording.truth_space);
  picture.in_plane = canvas.in_plane();
  picture.component = canvas.component();
  for (const Truth& truth : recording.truth) {
    DrawnLine& line = picture.truth.emplace_back();
    line.track = truth.track;
    for (std::size_t step = 0; step < truth.x.size(); ++step)
      canvas.add(recording.measurements[step].time_s, truth.x[step], line);
  }
  draw_measured(recording, canvas, picture);
  for (const Measurement& measurement : recording.measurements) {
    trackers.step(measurement);
    for (int i = 0; i < trackers.size(); ++i)
      if (index_in(drawn, trackers.name(i)) >= 0)
        draw_records(trackers.records(i), trackers.name(i), canvas, picture.tracks);
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
                                     const ComparisonOptions& options, const Comparison& comparison) {
  const std::vector<std::string> drawn = drawn_trackers(comparison);
  if (drawn.empty() || comparison.details.size() != comparison.trackers.size()) return {};
  std::size_t judge = 0;
  while (comparison.trackers[judge].name != drawn.front()) ++judge;
  if (comparison.details[judge].run_rmse.empty()) return {};
  const std::vector<double>& rmse = comparison.details[judge].run_rmse.front();
  std::vector<std::size_t> order;
  for (std::size_t run = 0; run < rmse.size(); ++run)
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
    RunPicture picture = draw(trackers.fresh(), drawn, scenario.scenario->simulate(key));
    picture.which = which;
    picture.run = run % options.runs;
    if (scenarios.size() > 1) picture.set = scenario.name;
    picture.judged_by = drawn.front();
    picture.quantity = comparison.trackers[judge].quantities.front().name;
    picture.rmse = rmse[run];
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

}  // namespace truebearing
