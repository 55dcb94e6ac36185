// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/recorded_scenario.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <string>
#include <utility>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/measurement/range_bearing_elevation.hpp"

namespace truebearing {

Measured RecordedSensor::measured() const {
  if (in_space) return output == Output::range_bearing ? RangeBearingElevation<>::measured() : Measured::position(3);
  return output == Output::range_bearing ? Measured::range_bearing() : Measured::position(2);
}

namespace {

bool is_range_or_bearing(const std::string& name) {
  return name == "range_m" || name == "bearing_deg";
}

// The first measured column that does not follow from the truth; empty where all do. A frequency in the plane is the
// source's, not what is heard.
std::string unknown_column(const Recording& recorded) {
  const StateSpace& space = *recorded.truth_space;
  for (const std::string& name : recorded.measured) {
    const bool from_plane = begins_in_plane(space) && is_range_or_bearing(name);
    const bool is_heard = begins_in_plane(space) && name == "frequency_hz";
    if (!from_plane && (is_heard || space.component_index(name) < 0)) return name;
  }
  return {};
}

bool lacks_sigma(const Recording& recorded) {
  return std::any_of(recorded.measurements.begin(), recorded.measurements.end(),
                     [](const Measurement& m) { return !m.is_missing() && m.sigma.size() == 0; });
}

// What a sensor without noise measures of the truth.
double exact(const std::string& name, const StateSpace& space, const BoundedVector& x, const Measurement& measurement) {
  if (const int component = space.component_index(name); component >= 0) return x(component);
  Eigen::Vector2d line_of_sight_m = x.head<2>();
  if (measurement.sensor) line_of_sight_m -= measurement.sensor->position_m;
  return name == "range_m" ? line_of_sight_m.norm() : std::atan2(line_of_sight_m.x(), line_of_sight_m.y());
}

// Range and bearing of a place in the plane; of one in space with its elevation.
BoundedVector seen_from_origin(const BoundedVector& place_m) {
  if (place_m.size() == 2) return Eigen::Vector2d(place_m.norm(), std::atan2(place_m[0], place_m[1]));
  const SightInSpace<double> sight(Eigen::Vector3d{place_m});
  return Eigen::Vector3d(sight.range_m, sight.bearing_rad, sight.elevation_rad);
}

}  // namespace

std::string reason_to_replay(const Recording& recorded) {
  if (!recorded.sources.empty()) return "has several sensors";
  if (const std::string name = unknown_column(recorded); !name.empty())
    return "measures " + name + ", which does not follow from its truth";
  return lacks_sigma(recorded) ? "carries no sigma for its measurements" : "";
}

RecordedScenario RecordedScenario::replayed(Recording recorded) {
  if (!recorded.truth_space) throw InputError("recording", "has no truth to score against", "a log with truth");
  RecordedScenario scenario;
  scenario.tracks_.push_back({std::move(recorded), {}});
  return scenario;
}

std::optional<std::size_t> RecordedScenario::different_runs(Role) const {
  for (const Track& track : tracks_)
    if (!track.sigma.empty()) return std::nullopt;
  return tracks_.size();
}

RecordedScenario::RecordedScenario(Recording recorded, std::optional<double> sigma) {
  if (measures_snapshots(recorded.measured)) {
    *this = replayed(std::move(recorded));
    return;
  }
  if (!recorded.sources.empty())
    throw InputError("recording", "has several sensors, which are not measured afresh", "its own measurements");
  if (!recorded.truth_space || recorded.truth.size() != 1)
    throw InputError("recording", "has no truth to measure", "a log with truth_ columns");
  if (const std::string name = unknown_column(recorded); !name.empty())
    throw InputError("recording", "measures \"" + name + "\", which is no component of its truth",
                     suggestion(name, recorded.truth_space->components));
  if (sigma && !(*sigma > 0.0 && std::isfinite(*sigma)))
    throw InputError("sigma", "is " + std::to_string(*sigma), "a number > 0");
  if (!sigma && lacks_sigma(recorded))
    throw InputError("recording", "carries no sigma for its measurements", "_sigma_ columns, or a sigma beside it");

  Track track;
  for (std::size_t k = 0; k < recorded.measurements.size(); ++k) {
    Measurement& measurement = recorded.measurements[k];
    track.sigma.push_back(measurement.sigma.size() > 0
                              ? measurement.sigma
                              : BoundedVector(BoundedVector::Constant(measurement.z.size(), sigma.value_or(0.0))));
    for (Eigen::Index i = 0; i < measurement.z.size(); ++i)
      if (!std::isnan(measurement.z(i)))
        measurement.z(i) = exact(recorded.measured[static_cast<std::size_t>(i)], *recorded.truth_space,
                                 recorded.truth[0].x[k], measurement);
  }
  const auto bearing = std::find(recorded.measured.begin(), recorded.measured.end(), "bearing_deg");
  if (bearing != recorded.measured.end() && begins_in_plane(*recorded.truth_space))
    bearing_ = bearing - recorded.measured.begin();
  track.exact = std::move(recorded);
  tracks_.push_back(std::move(track));
}

RecordedScenario::RecordedScenario(std::vector<Recording> positions, const RecordedSensor& sensor) {
  if (positions.empty()) throw InputError("recording", "has no track", "at least one");
  const bool range_bearing = sensor.output == RecordedSensor::Output::range_bearing;
  if (range_bearing) bearing_ = 1;
  const StateSpace& space = sensor.in_space ? space_space() : plane_space();
  const int d = space.size() / 2;
  const Eigen::Vector3d sigmas(sensor.sigma_m, range_bearing ? sensor.bearing_sigma_rad : sensor.sigma_m,
                               range_bearing ? sensor.elevation_sigma_rad : sensor.sigma_m);
  const Eigen::Vector3d site(sensor.site_m.x(), sensor.site_m.y(), sensor.site_up_m);
  const BoundedVector sigma = sigmas.head(d), site_m = site.head(d);
  for (Recording& recording : positions) {
    if (recording.truth_space != &space || recording.truth.size() != 1 ||
        recording.measured != Measured::position(d).components)
      throw InputError("recording", d == 3 ? "holds no positions in space" : "holds no positions in the plane",
                       fmt::format("{} with their truth", fmt::join(Measured::position(d).components, ", ")));
    recording.measured = sensor.measured().components;
    for (BoundedVector& x : recording.truth[0].x) x.head(d) -= site_m;
    for (Measurement& measurement : recording.measurements) {
      measurement.z -= site_m;
      if (range_bearing) measurement.z = seen_from_origin(measurement.z);
      if (sensor.reported) measurement.sigma = sigma;
    }
    const std::size_t steps = recording.measurements.size();
    tracks_.push_back({std::move(recording), std::vector<BoundedVector>(steps, sigma)});
  }
}

Recording RecordedScenario::simulate(const RunKey& key) const {
  RandomStream stream(key, StreamId::measurement);
  const Track& track = tracks_[static_cast<std::size_t>(key.run % tracks_.size())];
  Recording recording = track.exact;
  recording.counts = {};
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    Measurement& measurement = recording.measurements[k];
    for (Eigen::Index i = 0; i < measurement.z.size() && !track.sigma.empty(); ++i) {
      const double noise = stream.normal();  // drawn for missing values too: the noise of step k depends on k alone
      if (std::isnan(measurement.z(i))) continue;
      measurement.z(i) += track.sigma[k](i) * noise;
      if (i == bearing_) measurement.z(i) = wrap_pi(measurement.z(i));
    }
    recording.counts.missing += is_unusable(recording, measurement);
  }
  return recording;
}

}  // namespace truebearing
