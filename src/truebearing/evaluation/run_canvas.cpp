// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/run_canvas.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/array/beam_power.hpp"
#include "truebearing/array/interval.hpp"
#include "truebearing/array/sample_covariance.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/place_of.hpp"

namespace truebearing {

RunCanvas::RunCanvas(const StateSpace& space)
    : space_(space), plane_(begins_in_plane(space) || space == space_space()) {
  component_ = space.components.front();
  for (const Quantity& quantity : space.quantities)
    if (quantity.indices == std::vector<int>{0}) {
      component_ = quantity.name;
      scale_ = quantity.scale;
    }
}

void RunCanvas::add(double time_s, const BoundedVector& x, DrawnLine& line) const {
  line.time_s.push_back(time_s);
  if (plane_) line.x.push_back(x(0));
  line.y.push_back(plane_ ? x(1) : scale_ * x(0));
}

void RunCanvas::add(const StepRecord& record, DrawnTrack& track) const {
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

void RunCanvas::add_measured(const Recording& recording, const SensorSites& sites, RunPicture& picture) const {
  for (const Measurement& measurement : recording.measurements) {
    const std::vector<std::string>& measured = components_of(recording, measurement);
    const int east = place_of(measured, "east_m"), north = place_of(measured, "north_m");
    const int range = place_of(measured, "range_m"), bearing = place_of(measured, "bearing_deg");
    const int elevation = place_of(measured, "elevation_deg");
    const int value = place_of(measured, component_);
    const bool sights = plane_ && bearing >= 0 && range < 0;
    const SensorState sensor = sites.of(measurement);
    const auto z = [&](int i) { return i < measurement.z.size() ? measurement.z(i) : kNaN; };
    BoundedVector at(2);
    if (sights) {
      at = sensor.position_m;
      add(measurement.time_s, at, picture.own_ship);
      picture.bearing_deg.push_back(degrees(z(bearing)));
    } else if (plane_ && range >= 0 && bearing >= 0) {
      const double ground_m = elevation >= 0 ? z(range) * std::cos(z(elevation)) : z(range);
      at << sensor.position_m.x() + ground_m * std::sin(z(bearing)),
          sensor.position_m.y() + ground_m * std::cos(z(bearing));
      add(measurement.time_s, at, picture.measured);
    } else if (plane_ && east >= 0 && north >= 0) {
      at << z(east), z(north);
      add(measurement.time_s, at, picture.measured);
    } else if (!plane_ && value >= 0) {
      at << z(value) / scale_, 0.0;
      add(measurement.time_s, at, picture.measured);
    }
  }
}

void RunCanvas::add_beam(const Recording& recording, RunPicture& picture) const {
  if (!measures_snapshots(recording.measured) || recording.measurements.empty()) return;
  constexpr std::size_t kMostTimes = 120;
  constexpr int kEveryDegrees = 2;
  DrawnBeam& beam = picture.beam;
  std::vector<double> angles_rad;
  for (int angle_deg = -90; angle_deg <= 90; angle_deg += kEveryDegrees) {
    beam.angle_deg.push_back(angle_deg);
    angles_rad.push_back(radians(angle_deg));
  }
  const std::size_t every = recording.measurements.size() / (kMostTimes + 1) + 1;
  Interval interval;
  Eigen::MatrixXcd R;
  for (std::size_t i = 0; i < recording.measurements.size(); i += every) {
    const Measurement& measurement = recording.measurements[i];
    beam.time_s.push_back(measurement.time_s);
    std::vector<double>& below_dB = beam.below_dB.emplace_back(angles_rad.size(), kNaN);
    if (!measurement.snapshots) continue;
    interval.take(*measurement.snapshots);
    if (!interval.is_usable()) continue;
    sample_covariance(interval, R);
    const std::vector<double> power = beam_power({interval.sensors(), interval.spacing_wavelengths()}, R, angles_rad);
    const double most = *std::max_element(power.begin(), power.end());
    constexpr double kDecibel = 10.0, kLeastShare = 1e-12;
    if (!(most > 0.0)) continue;
    for (std::size_t angle = 0; angle < power.size(); ++angle)
      below_dB[angle] = -kDecibel * std::log10(std::max(power[angle] / most, kLeastShare));
  }
}

void RunCanvas::add_records(std::span<const StepRecord> records, const std::string& name,
                            std::vector<DrawnTrack>& tracks) const {
  for (const StepRecord& record : records) {
    if (!record.x.allFinite() || record.x.size() == 0) continue;
    auto track = std::find_if(tracks.begin(), tracks.end(), [&](const DrawnTrack& other) {
      return other.tracker == name && other.line.track == record.track;
    });
    if (track == tracks.end()) {
      tracks.push_back({name, {record.track, {}, {}, {}}, {}, {}, {}});
      track = tracks.end() - 1;
    }
    add(record, *track);
  }
}

}  // namespace truebearing
