// Makers of trackers of bearings in the plane. They have translation units of their own, so that bearings do not
// multiply the filters that are compiled for measured positions.
#pragma once

#include <memory>
#include <variant>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/study/filter_configuration.hpp"
#include "truebearing/study/range_prior_configuration.hpp"
#include "truebearing/tracker/bearing_frequency_sensor.hpp"
#include "truebearing/tracker/bearing_sensor.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

/// Does the tracker's `measurement` say model = "bearing"?
bool measures_bearings(const TableReader& tracker);
/// Does it say model = "bearing_frequency"?
bool measures_frequencies(const TableReader& tracker);

/// measurement = { model = "bearing", bearing_sigma_deg, sigma_factor }.
BearingSensor read_bearing_sensor(TableReader& tracker);
/// measurement = { model = "bearing_frequency", bearing_sigma_deg, frequency_sigma_hz, sigma_factor, sound_mps }.
BearingFrequencySensor read_bearing_frequency_sensor(TableReader& tracker);
/// motion = { model = "constant_velocity" | "coordinated_turn", ... }.
VelocityMotion read_velocity_motion(TableReader& tracker);

/// start = { kind = "prior" | "range" | "hand_over", ... } of a state of N components; "hand_over" in a composed
/// tracker, whose batch estimate begins the filter.
template <int N>
std::variant<PriorStart<N>, RangePrior, HandOverStart> read_bearing_start(TableReader& tracker) {
  TableReader table = tracker.table("start");
  const std::string kind = table.choice("kind", {"prior", "range", "hand_over"});
  if (kind == "range") return read_range_prior(tracker.table("start"));
  if (kind == "prior") return std::get<PriorStart<N>>(read_start<N, 2>(tracker));
  const HandOverStart start{N > 5 ? table.number("rest_sigma", kNonNegative) : 0.0};
  table.finish();
  return start;
}

/// A FilterTracker of bearings, with frequencies or without.
template <typename Filter, typename Motion, typename Sensor>
std::unique_ptr<Tracker> bearing_tracker(TableReader& table, const StateSpace& space, const Motion& motion,
                                         const Sensor& sensor) {
  const auto start = read_bearing_start<Filter::kStates>(table);
  const FilterTrackerOptions options = read_options(table, Sensor::Model::kMeasurements);
  if (options.output_pull > 0.0) throw table.error("output_pull", "needs measured positions", "0");
  return std::make_unique<FilterTracker<Filter, Motion, Sensor>>(space, motion, sensor, start, options);
}

std::unique_ptr<Tracker> make_bearing_kalman(TableReader& table);
std::unique_ptr<Tracker> make_bearing_unscented(TableReader& table);
std::unique_ptr<Tracker> make_bearing_multiple_model(TableReader& table);
std::unique_ptr<Tracker> make_modified_gain_tracker(TableReader& table);
std::unique_ptr<Tracker> make_log_polar_tracker(TableReader& table);
std::unique_ptr<Tracker> make_range_bank(TableReader& table);

/// Of bearings and frequencies. `space`: "plane_frequency", or "plane" where the records are to leave the frequency
/// out.
std::unique_ptr<Tracker> make_frequency_kalman(TableReader& table);
std::unique_ptr<Tracker> make_frequency_unscented(TableReader& table);
std::unique_ptr<Tracker> make_frequency_modified_gain(TableReader& table);
std::unique_ptr<Tracker> make_frequency_multiple_model(TableReader& table);
std::unique_ptr<Tracker> make_frequency_range_bank(TableReader& table);

}  // namespace truebearing
