// SPDX-License-Identifier: Apache-2.0
// Makers of trackers without a filter: the measurement as it is, and what ran elsewhere.
#pragma once

#include <memory>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

std::unique_ptr<Tracker> make_raw_tracker(TableReader& table);
std::unique_ptr<Tracker> make_recorded_tracker(TableReader& table);

}  // namespace truebearing
