#include "truebearing/simulation/recorded_scenario.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"

namespace truebearing {

Measured RecordedSensor::measured() const {
  return output == Output::range_bearing ? Measured::range_bearing() : Measured::position(2);
}

RecordedScenario::RecordedScenario(Recording recorded, std::optional<double> sigma) {
  if (measures_snapshots(recorded.measured)) {
    if (!recorded.truth_space) throw InputError("recording", "has no truth to score against", "a log with truth");
    tracks_.push_back({std::move(recorded), {}});
    return;
  }
  if (!recorded.truth_space || recorded.truth.size() != 1)
    throw InputError("recording", "has no truth to measure", "a log with truth_ columns");
  std::vector<Eigen::Index> components;  // of the truth, by component of z
  for (const std::string& name : recorded.measured) {
    const int component = recorded.truth_space->component_index(name);
    if (component < 0)
      throw InputError("recording", "measures \"" + name + "\", which is no component of its truth",
                       suggestion(name, recorded.truth_space->components));
    components.push_back(component);
  }
  if (sigma && !(*sigma > 0.0 && std::isfinite(*sigma)))
    throw InputError("sigma", "is " + std::to_string(*sigma), "a number > 0");
  const auto lacks_sigma = [](const Measurement& m) { return !m.is_missing() && m.sigma.size() == 0; };
  if (!sigma && std::any_of(recorded.measurements.begin(), recorded.measurements.end(), lacks_sigma))
    throw InputError("recording", "carries no sigma for its measurements", "_sigma_ columns, or a sigma beside it");

  Track track;
  for (std::size_t k = 0; k < recorded.measurements.size(); ++k) {
    Measurement& measurement = recorded.measurements[k];
    track.sigma.push_back(measurement.sigma.size() > 0
                              ? measurement.sigma
                              : BoundedVector(BoundedVector::Constant(measurement.z.size(), sigma.value_or(0.0))));
    for (Eigen::Index i = 0; i < measurement.z.size(); ++i)
      if (!std::isnan(measurement.z(i)))
        measurement.z(i) = recorded.truth[0].x[k](components[static_cast<std::size_t>(i)]);
  }
  track.exact = std::move(recorded);
  tracks_.push_back(std::move(track));
}

RecordedScenario::RecordedScenario(std::vector<Recording> positions, const RecordedSensor& sensor) {
  if (positions.empty()) throw InputError("recording", "has no track", "at least one");
  const bool range_bearing = sensor.output == RecordedSensor::Output::range_bearing;
  if (range_bearing) bearing_ = 1;
  BoundedVector sigma = BoundedVector::Constant(2, sensor.sigma_m);
  if (range_bearing) sigma[1] = sensor.bearing_sigma_rad;
  for (Recording& recording : positions) {
    if (recording.truth_space != &plane_space() || recording.truth.size() != 1 ||
        recording.measured != Measured::position(2).components)
      throw InputError("recording", "holds no positions in the plane", "east_m and north_m with their truth");
    recording.measured = sensor.measured().components;
    for (BoundedVector& x : recording.truth[0].x) x.head<2>() -= sensor.site_m;
    for (Measurement& measurement : recording.measurements) {
      const Eigen::Vector2d position_m = measurement.z - sensor.site_m;
      measurement.z = position_m;
      if (range_bearing) measurement.z << position_m.norm(), std::atan2(position_m.x(), position_m.y());
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
    for (Eigen::Index i = 0; i < measurement.z.size(); ++i) {
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
