#include "truebearing/study/bearing_trackers.hpp"

#include <string>

#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/log_polar.hpp"
#include "truebearing/filter/modified_gain.hpp"
#include "truebearing/filter/unscented.hpp"

namespace truebearing {
namespace {

template <typename Filter>
std::unique_ptr<Tracker> make(TableReader& table) {
  table.choice_or("space", {"plane"}, "plane");
  const VelocityMotion motion = read_velocity_motion(table);
  return bearing_tracker<Filter>(table, plane_space(), motion, read_bearing_sensor(table));
}

}  // namespace

bool measures_bearings(const TableReader& tracker) {
  return tracker.raw()["measurement"]["model"].value_or(std::string()) == "bearing";
}

bool measures_frequencies(const TableReader& tracker) {
  return tracker.raw()["measurement"]["model"].value_or(std::string()) == "bearing_frequency";
}

BearingSensor read_bearing_sensor(TableReader& tracker) {
  TableReader table = tracker.table("measurement");
  table.choice("model", {"bearing"});
  const double sigma_rad = radians(table.number("bearing_sigma_deg", {0.0, 90.0, true}));
  const BearingSensor sensor{sigma_rad, table.number_or("sigma_factor", 1.0, kPositive)};
  table.finish();
  return sensor;
}

BearingFrequencySensor read_bearing_frequency_sensor(TableReader& tracker) {
  TableReader table = tracker.table("measurement");
  table.choice("model", {"bearing_frequency"});
  BearingFrequencySensor sensor;
  sensor.sigma_rad = radians(table.number("bearing_sigma_deg", {0.0, 90.0, true}));
  sensor.sigma_hz = table.number("frequency_sigma_hz", kPositive);
  sensor.sigma_factor = table.number_or("sigma_factor", 1.0, kPositive);
  sensor.sound_mps = table.number_or("sound_mps", kSoundInWater_mps, kPositive);
  table.finish();
  return sensor;
}

VelocityMotion read_velocity_motion(TableReader& tracker) {
  TableReader table = tracker.table("motion");
  table.choice("model", {"constant_velocity", "coordinated_turn"});
  const VelocityMotion motion = std::get<VelocityMotion>(read_plane_motion(table));
  table.finish();
  return motion;
}

std::unique_ptr<Tracker> make_bearing_kalman(TableReader& table) {
  table.choice_or("form", {"joseph"}, "joseph");
  return make<KalmanFilter<4>>(table);
}

std::unique_ptr<Tracker> make_bearing_unscented(TableReader& table) {
  return make<UnscentedKalmanFilter<4>>(table);
}

std::unique_ptr<Tracker> make_modified_gain_tracker(TableReader& table) {
  if (measures_frequencies(table)) return make_frequency_modified_gain(table);
  return make<ModifiedGainFilter<4>>(table);
}

std::unique_ptr<Tracker> make_log_polar_tracker(TableReader& table) {
  return make<LogPolarFilter<>>(table);
}

}  // namespace truebearing
