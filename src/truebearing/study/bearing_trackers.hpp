// Makers of trackers of bearings in the plane. They have translation units of their own, so that bearings do not
// multiply the filters that are compiled for measured positions.
#pragma once

#include <memory>
#include <variant>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/study/filter_configuration.hpp"
#include "truebearing/tracker/bearing_sensor.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

/// Does the tracker's `measurement` say model = "bearing"?
bool measures_bearings(const TableReader& tracker);

/// measurement = { model = "bearing", bearing_sigma_deg, sigma_factor }.
BearingSensor read_bearing_sensor(TableReader& tracker);
/// motion = { model = "constant_velocity" | "coordinated_turn", ... }.
VelocityMotion read_velocity_motion(TableReader& tracker);

std::unique_ptr<Tracker> make_bearing_kalman(TableReader& table);
std::unique_ptr<Tracker> make_bearing_unscented(TableReader& table);
std::unique_ptr<Tracker> make_modified_gain_tracker(TableReader& table);
std::unique_ptr<Tracker> make_log_polar_tracker(TableReader& table);
std::unique_ptr<Tracker> make_range_bank(TableReader& table);

}  // namespace truebearing
