#include "truebearing/study/bearing_trackers.hpp"

#include <string>

#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/log_polar.hpp"
#include "truebearing/filter/modified_gain.hpp"
#include "truebearing/filter/unscented.hpp"
#include "truebearing/study/range_prior_configuration.hpp"

namespace truebearing {
namespace {

// start = { kind = "prior", ... } or { kind = "range", ... }.
std::variant<PriorStart<4>, RangePrior> read_bearing_start(TableReader& tracker) {
  TableReader table = tracker.table("start");
  if (table.choice("kind", {"prior", "range"}) == "range") return read_range_prior(tracker.table("start"));
  return std::get<PriorStart<4>>(read_start<4, 2>(tracker));
}

template <typename Filter>
std::unique_ptr<Tracker> make(TableReader& table) {
  table.choice_or("space", {"plane"}, "plane");
  const VelocityMotion motion = read_velocity_motion(table);
  const BearingSensor sensor = read_bearing_sensor(table);
  const auto start = read_bearing_start(table);
  const FilterTrackerOptions options = read_options(table, 1);
  if (options.output_pull > 0.0) throw table.error("output_pull", "needs measured positions", "0");
  return std::make_unique<FilterTracker<Filter, VelocityMotion, BearingSensor>>(plane_space(), motion, sensor, start,
                                                                                options);
}

}  // namespace

bool measures_bearings(const TableReader& tracker) {
  return tracker.raw()["measurement"]["model"].value_or(std::string()) == "bearing";
}

BearingSensor read_bearing_sensor(TableReader& tracker) {
  TableReader table = tracker.table("measurement");
  table.choice("model", {"bearing"});
  const double sigma_rad = radians(table.number("bearing_sigma_deg", {0.0, 90.0, true}));
  const BearingSensor sensor{sigma_rad, table.number_or("sigma_factor", 1.0, kPositive)};
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
  return make<ModifiedGainFilter<4>>(table);
}

std::unique_ptr<Tracker> make_log_polar_tracker(TableReader& table) {
  return make<LogPolarFilter<>>(table);
}

}  // namespace truebearing
