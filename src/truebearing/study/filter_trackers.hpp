// Makers of the trackers that the house brings: from a table of a study to a FilterTracker, a FilterBank, the raw
// measurement or a recorded tracker. Their keys are in the README.
#pragma once

#include <memory>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

std::unique_ptr<Tracker> make_kalman_tracker(TableReader& table);
std::unique_ptr<Tracker> make_unscented_tracker(TableReader& table);
std::unique_ptr<Tracker> make_modified_gain_tracker(TableReader& table);
std::unique_ptr<Tracker> make_log_polar_tracker(TableReader& table);
std::unique_ptr<Tracker> make_multiple_model_tracker(TableReader& table);
std::unique_ptr<Tracker> make_kalman_bank(TableReader& table);
std::unique_ptr<Tracker> make_range_bank(TableReader& table);
std::unique_ptr<Tracker> make_raw_tracker(TableReader& table);
std::unique_ptr<Tracker> make_recorded_tracker(TableReader& table);

}  // namespace truebearing
