// SPDX-License-Identifier: Apache-2.0
// Makers of filter trackers: from a table of a study to a FilterTracker or a FilterBank. Their keys are in docs/studies.md.
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

}  // namespace truebearing
