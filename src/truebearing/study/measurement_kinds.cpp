// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/measurement_kinds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <toml++/toml.h>
#include <vector>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/simulation/lorenz_scenario.hpp"
#include "truebearing/tracker/bearing_sensor.hpp"
#include "truebearing/tracker/biased_sensor.hpp"
#include "truebearing/tracker/lorenz_sensor.hpp"
#include "truebearing/tracker/polar_sensor.hpp"
#include "truebearing/tracker/position_sensor.hpp"
#include "truebearing/tracker/position_velocity_sensor.hpp"
#include "truebearing/tracker/range_rate_sensor.hpp"
#include "truebearing/tracker/several_sensors.hpp"
#include "truebearing/tracker/space_sensor.hpp"

namespace truebearing {
namespace {

constexpr Range kSigma_deg{0.0, 90.0, true};
constexpr Range kGate{0.5, 1.0 - 1e-12};

// What a reader takes: the table, the space of the records, and what the standard deviations are multiplied by.
struct Reading {
  TableReader& table;
  const StateSpace& space;
  double factor;
};

double read_factor(const Reading& reading) {
  return reading.table.number_or("sigma_factor", 1.0, kPositive) * reading.factor;
}

double read_position_sigma(TableReader& table) {
  const std::string key = table.one_of("sigma_m", "variance_m2");
  const double value = table.number(key, kPositive);
  return key == "sigma_m" ? value : std::sqrt(value);
}

std::unique_ptr<AnySensor> read_position(const Reading& reading) {
  const double sigma_m = read_position_sigma(reading.table), factor = read_factor(reading);
  const bool reported = reading.table.boolean_or("reported", true);
  if (reading.space == line_space())
    return sensor_of(PositionSensor<1>{PositionSensor<1>::Sigma(sigma_m), factor, reported});
  if (reading.space == space_space())
    return sensor_of(PositionSensor<3>{PositionSensor<3>::Sigma::Constant(sigma_m), factor, reported});
  return sensor_of(PositionSensor<2>{{sigma_m, sigma_m}, factor, reported});
}

std::unique_ptr<AnySensor> read_position_velocity(const Reading& reading) {
  const double sigma_m = reading.table.number("sigma_m", kPositive);
  const double sigma_mps = reading.table.number("velocity_sigma_mps", kPositive);
  return sensor_of(PositionVelocitySensor{{sigma_m, sigma_mps}, read_factor(reading)});
}

PolarSensor read_polar(const Reading& reading) {
  TableReader& table = reading.table;
  PolarSensor sensor;
  sensor.sigma_factor = read_factor(reading);
  sensor.sigma << table.number("range_sigma_m", kPositive), radians(table.number("bearing_sigma_deg", kSigma_deg));
  if (table.has("site_m")) {
    const std::vector<double> site = table.numbers("site_m", 2);
    sensor.site_m << site[0], site[1];
  }
  return sensor;
}

std::unique_ptr<AnySensor> read_range_bearing(const Reading& reading) {
  return sensor_of(read_polar(reading));
}

std::unique_ptr<AnySensor> read_converted(const Reading& reading) {
  ConvertedSensor sensor{read_polar(reading)};
  if (reading.table.has("position_sigma_m"))
    sensor.position_sigma_m = sensor.polar.sigma_factor * reading.table.number("position_sigma_m", kPositive);
  return sensor_of(sensor);
}

// Of range and range rate.
double read_correlation(TableReader& table) {
  constexpr double kNearlyOne = 0.999;
  return table.number_or("range_rate_correlation", 0.0, {-kNearlyOne, kNearlyOne});
}

RangeBearingRateSensor read_polar_rate(const Reading& reading) {
  const PolarSensor polar = read_polar(reading);
  const double rate_sigma_mps = reading.table.number("range_rate_sigma_mps", kPositive);
  return {{polar.sigma[0], polar.sigma[1], rate_sigma_mps},
          polar.sigma_factor,
          polar.site_m,
          read_correlation(reading.table)};
}

bool read_second_order(const Reading& reading) {
  return reading.table.boolean_or("second_order", false);
}

std::unique_ptr<AnySensor> read_range_bearing_rate(const Reading& reading) {
  const RangeBearingRateSensor sensor = read_polar_rate(reading);
  return read_second_order(reading) ? sensor_of(SecondOrderRateSensor{sensor}) : sensor_of(sensor);
}

std::unique_ptr<AnySensor> read_converted_rate(const Reading& reading) {
  const RangeBearingRateSensor sensor = read_polar_rate(reading);
  return sensor_of(ConvertedRateSensor{sensor, read_second_order(reading)});
}

// A range rate, with the range before it or without.
template <typename Model>
std::unique_ptr<AnySensor> read_partial_rate(const Reading& reading) {
  TableReader& table = reading.table;
  PartialRangeRateSensor<Model> sensor;
  sensor.sigma_factor = read_factor(reading);
  sensor.sigma[0] = sensor.sigma[Model::kMeasurements - 1] = table.number("range_rate_sigma_mps", kPositive);
  if constexpr (Model::kMeasurements == 2) {
    sensor.sigma[0] = table.number("range_sigma_m", kPositive);
    sensor.correlation = read_correlation(table);
  }
  if (table.has("site_m")) sensor.site_m = Eigen::Map<const Eigen::Vector2d>(table.numbers("site_m", 2).data());
  return sensor_of(sensor);
}

std::unique_ptr<AnySensor> read_bearing(const Reading& reading) {
  const double sigma_rad = radians(reading.table.number("bearing_sigma_deg", kSigma_deg));
  return sensor_of(BearingSensor{sigma_rad, read_factor(reading)});
}

BearingFrequencySensor read_bearing_frequency(const Reading& reading) {
  TableReader& table = reading.table;
  BearingFrequencySensor sensor;
  sensor.sigma_rad = radians(table.number("bearing_sigma_deg", kSigma_deg));
  sensor.sigma_hz = table.number("frequency_sigma_hz", kPositive);
  sensor.sigma_factor = read_factor(reading);
  sensor.sound_mps = table.number_or("sound_mps", kSoundInWater_mps, kPositive);
  return sensor;
}

std::unique_ptr<AnySensor> read_frequencies(const Reading& reading) {
  return sensor_of(read_bearing_frequency(reading));
}

std::unique_ptr<AnySensor> read_lorenz(const Reading& reading) {
  TableReader& table = reading.table;
  LorenzSensor sensor;
  sensor.sigma.setConstant(table.number("sigma", kPositive));
  sensor.sigma_factor = read_factor(reading);
  if (table.has("matrix") && table.has("rotation_deg"))
    throw table.error("", "has both of matrix and rotation_deg", "one of the two");
  if (table.has("rotation_deg")) sensor.matrix = rotation_of(table.numbers("rotation_deg", 3));
  if (table.has("matrix"))
    sensor.matrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(table.numbers("matrix", 9).data());
  return sensor_of(sensor);
}

// Of the components that are measured: M of range, bearing, elevation and range rate, or the two angles alone.
template <int M>
SpaceSite<M> read_space_site(const Reading& reading) {
  TableReader& table = reading.table;
  SpaceSite<M> site;
  site.sigma_factor = read_factor(reading);
  const double bearing_rad = radians(table.number("bearing_sigma_deg", kSigma_deg));
  const double elevation_rad = radians(table.number("elevation_sigma_deg", kSigma_deg));
  if constexpr (M == 2)
    site.sigma << bearing_rad, elevation_rad;
  else
    site.sigma.template head<3>() << table.number("range_sigma_m", kPositive), bearing_rad, elevation_rad;
  if constexpr (M == 4) site.sigma[3] = table.number("range_rate_sigma_mps", kPositive);
  if (table.has("site_m")) site.site_m = Eigen::Map<const Eigen::Vector3d>(table.numbers("site_m", 3).data());
  return site;
}

std::unique_ptr<AnySensor> read_elevation(const Reading& reading) {
  return sensor_of(RangeBearingElevationSensor{read_space_site<3>(reading)});
}

std::unique_ptr<AnySensor> read_converted_elevation(const Reading& reading) {
  return sensor_of(ConvertedElevationSensor{read_space_site<3>(reading)});
}

std::unique_ptr<AnySensor> read_elevation_rate(const Reading& reading) {
  return sensor_of(RangeBearingElevationRateSensor{read_space_site<4>(reading), read_correlation(reading.table)});
}

std::unique_ptr<AnySensor> read_converted_elevation_rate(const Reading& reading) {
  return sensor_of(ConvertedElevationRateSensor{read_space_site<4>(reading), read_correlation(reading.table)});
}

std::unique_ptr<AnySensor> read_two_angles(const Reading& reading) {
  return sensor_of(BearingElevationSensor{read_space_site<2>(reading)});
}

struct MeasurementKind {
  const char* model;
  std::vector<std::string> spaces;  ///< the first is the default
  std::unique_ptr<AnySensor> (*read)(const Reading& reading);
  bool has_frequency = false;
};

const std::vector<MeasurementKind>& kinds() {
  static const std::vector<MeasurementKind> the_kinds{
      {"position", {"line", "plane", "space"}, read_position},
      {"position_velocity", {"line"}, read_position_velocity},
      {"range_bearing", {"plane"}, read_range_bearing},
      {"converted_range_bearing", {"plane"}, read_converted},
      {"range_bearing_rate", {"plane"}, read_range_bearing_rate},
      {"converted_range_bearing_rate", {"plane"}, read_converted_rate},
      {"range_range_rate", {"plane"}, read_partial_rate<RangeAndRate>},
      {"range_rate", {"plane"}, read_partial_rate<RangeRate>},
      {"bearing", {"plane"}, read_bearing},
      {"bearing_frequency", {"plane_frequency", "plane"}, read_frequencies, true},
      {"range_bearing_elevation", {"space"}, read_elevation},
      {"converted_range_bearing_elevation", {"space"}, read_converted_elevation},
      {"range_bearing_elevation_rate", {"space"}, read_elevation_rate},
      {"converted_range_bearing_elevation_rate", {"space"}, read_converted_elevation_rate},
      {"bearing_elevation", {"space"}, read_two_angles},
      {"lorenz", {"lorenz"}, read_lorenz},
  };
  return the_kinds;
}

constexpr const char* kSensors = "sensors";

const MeasurementKind& read_kind(TableReader& table, bool or_sensors) {
  static const MeasurementKind kSeveral{kSensors, {"plane"}, nullptr};
  std::vector<std::string> models;
  for (const MeasurementKind& kind : kinds()) models.emplace_back(kind.model);
  if (or_sensors) models.emplace_back(kSensors);
  const std::string model = table.choice("model", models);
  for (const MeasurementKind& kind : kinds())
    if (model == kind.model) return kind;
  return kSeveral;
}

// In the units of the components' names, as files have them.
std::unique_ptr<AnySensor> without_bias(TableReader& table, std::unique_ptr<AnySensor> sensor) {
  if (!table.has("bias")) return sensor;
  const std::vector<double> bias = table.numbers("bias", sensor->size());
  const std::vector<std::string> components = sensor->measured().components;
  BoundedVector in_z(sensor->size());
  for (std::size_t i = 0; i < bias.size(); ++i)
    in_z[static_cast<Eigen::Index>(i)] = components[i].ends_with("_deg") ? radians(bias[i]) : bias[i];
  return std::make_unique<BiasedSensor>(std::move(sensor), in_z);
}

bool adds_second_order(const TableReader& measurement) {
  return (*measurement.raw())["second_order"].value_or(false);
}

// [sensors.NAME].
struct OneSensor {
  std::unique_ptr<AnySensor> sensor;
  double gate_nis;
  bool second_order;
};

OneSensor read_sensor(TableReader table, const StateSpace& space, double factor) {
  const MeasurementKind& kind = read_kind(table, false);
  const auto is_of = [&](const std::string& name) {
    return std::find(kind.spaces.begin(), kind.spaces.end(), name) != kind.spaces.end();
  };
  // With the frequency of a source behind it a state in the plane is one still.
  if (!is_of(space.name) && !(space == plane_frequency_space() && is_of("plane")))
    throw table.error("model", fmt::format("is \"{}\", which has no meaning in the space {}", kind.model, space.name),
                      fmt::format("the space {}", fmt::join(kind.spaces, ", ")));
  OneSensor one{without_bias(table, kind.read({table, space, factor})), kInfinity, adds_second_order(table)};
  static_cast<void>(table.number_or("clock_offset_s", 0.0, {-1e6, 1e6}));  // which logs are read by
  if (table.has("gate_probability"))
    one.gate_nis = chi_square_quantile(table.number("gate_probability", kGate), one.sensor->size());
  table.finish();
  return one;
}

std::vector<std::string> sorted_names(const TableReader& sensors) {
  std::vector<std::string> names = sensors.keys();
  std::sort(names.begin(), names.end());  // as a scenario's are, and a log's
  return names;
}

// measurement = { model = "sensors", use = [...], sensors = {...} }.
MeasurementChoice read_sensors(TableReader& tracker, TableReader& table, double factor) {
  const std::optional<TableReader> found = table.table_if_present(kSensors);
  if (!found) throw table.error("model", "is \"sensors\"", "tables [sensors.NAME] in the study");
  TableReader sensors(found->raw(), table.file(), kSensors);  // as the study has them
  if (sensors.keys().empty() || sensors.keys().size() > kMostSensors)
    throw sensors.error("", fmt::format("names {} of them", sensors.keys().size()),
                        fmt::format("1 to {}", kMostSensors));
  const std::vector<std::string> names = sorted_names(sensors);
  const std::vector<std::string> used = table.has("use") ? table.texts("use") : names;
  for (const std::string& name : used)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw table.error("use", "names no sensor: \"" + name + "\"", suggestion(name, names));
  if (used.empty()) throw table.error("use", "is empty", fmt::format("{}", fmt::join(names, ", ")));
  const StateSpace& space =
      *find_state_space(tracker.choice_or("space", {"plane", "plane_frequency", "space"}, "plane"));
  std::vector<SeveralSensors::Part> parts;
  std::vector<double> gates;
  bool second_order = false;
  for (const std::string& name : names) {
    OneSensor one = read_sensor(sensors.table(name), space, factor);
    gates.push_back(one.gate_nis);
    second_order |= one.second_order;
    parts.push_back({name, std::move(one.sensor), std::find(used.begin(), used.end(), name) != used.end()});
  }
  MeasurementChoice choice{kSensors, std::make_unique<SeveralSensors>(std::move(parts)), &space,
                           space == plane_frequency_space(), second_order};
  if (std::any_of(gates.begin(), gates.end(), [](double gate) { return gate < kInfinity; }))
    choice.gate_nis_of = std::move(gates);
  return choice;
}

}  // namespace

MeasurementChoice read_measurement(TableReader& tracker, double factor) {
  TableReader table = tracker.table("measurement");
  const MeasurementKind& kind = read_kind(table, true);
  if (!kind.read) {
    MeasurementChoice choice = read_sensors(tracker, table, factor);
    table.finish();
    return choice;
  }
  const StateSpace& space = *find_state_space(tracker.choice_or("space", kind.spaces, kind.spaces.front()));
  MeasurementChoice choice{kind.model, without_bias(table, kind.read({table, space, factor})), &space,
                           kind.has_frequency, adds_second_order(table)};
  table.finish();
  return choice;
}

bool measures(const TableReader& tracker, const std::string& model) {
  const toml::table* measurement = (*tracker.raw())["measurement"].as_table();
  return measurement && (*measurement)["model"].value_or(std::string()) == model;
}

BearingFrequencySensor read_bearing_frequency_sensor(TableReader& tracker) {
  TableReader table = tracker.table("measurement");
  table.choice("model", {"bearing_frequency"});
  const BearingFrequencySensor sensor = read_bearing_frequency({table, plane_frequency_space(), 1.0});
  table.finish();
  return sensor;
}

}  // namespace truebearing
