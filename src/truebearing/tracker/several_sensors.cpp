// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/several_sensors.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace truebearing {
namespace {

bool is_used(const SeveralSensors::Part& part) {
  return part.used;
}

// Whether any of those that are used says so.
template <typename Says>
bool any_used(const std::vector<SeveralSensors::Part>& parts, const Says& says) {
  return std::any_of(parts.begin(), parts.end(), [&](const auto& part) { return part.used && says(*part.sensor); });
}

}  // namespace

SeveralSensors::SeveralSensors(std::vector<Part> parts) : parts_(std::move(parts)) {
  if (std::none_of(parts_.begin(), parts_.end(), is_used))
    throw std::invalid_argument("a tracker uses one sensor at least");
}

Measured SeveralSensors::measured() const {
  std::vector<Source> sources;
  for (const Part& part : parts_) sources.push_back({part.name, part.sensor->measured().components});
  return Measured::several(std::move(sources));
}

int SeveralSensors::size() const {
  int size = 0;
  for (const Part& part : parts_)
    if (part.used) size = std::max(size, part.sensor->size());
  return size;
}

int SeveralSensors::states() const {
  int states = 0;
  for (const Part& part : parts_)
    if (part.used) states = std::max(states, part.sensor->states());
  return states;
}

bool SeveralSensors::measures_position() const {
  return !any_used(parts_, [](const AnySensor& sensor) { return !sensor.measures_position(); });
}

bool SeveralSensors::tells_position() const {
  return any_used(parts_, [](const AnySensor& sensor) { return sensor.tells_position(); });
}

bool SeveralSensors::tells_bearing() const {
  return any_used(parts_, [](const AnySensor& sensor) { return sensor.tells_bearing(); });
}

bool SeveralSensors::heeds_expected() const {
  return any_used(parts_, [](const AnySensor& sensor) { return sensor.heeds_expected(); });
}

AnySensor* SeveralSensors::whose(const Measurement& measurement) const {
  const auto place = static_cast<std::size_t>(measurement.source);
  return place < parts_.size() && parts_[place].used ? parts_[place].sensor.get() : nullptr;
}

bool SeveralSensors::has_value(const Measurement& measurement) const {
  const AnySensor* sensor = whose(measurement);
  return sensor && sensor->has_value(measurement);
}

const AnyMeasurement& SeveralSensors::take(const Measurement& measurement, const Prediction& expected) {
  return whose(measurement)->take(measurement, expected);
}

std::optional<PositionFix> SeveralSensors::fix(const Measurement& measurement) const {
  const AnySensor* sensor = whose(measurement);
  return sensor ? sensor->fix(measurement) : std::nullopt;
}

std::optional<Sight> SeveralSensors::sight(const Measurement& measurement) const {
  const AnySensor* sensor = whose(measurement);
  return sensor ? sensor->sight(measurement) : std::nullopt;
}

std::optional<PriorStart> SeveralSensors::believe(const GaussianState& plane, const Measurement& measurement) const {
  const AnySensor* sensor = whose(measurement);
  return sensor ? sensor->believe(plane, measurement) : std::nullopt;
}

std::unique_ptr<AnySensor> SeveralSensors::fresh() const {
  std::vector<Part> parts;
  for (const Part& part : parts_) parts.push_back({part.name, part.sensor->fresh(), part.used});
  return std::make_unique<SeveralSensors>(std::move(parts));
}

}  // namespace truebearing
