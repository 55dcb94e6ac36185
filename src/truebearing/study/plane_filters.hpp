// Makers of trackers in the plane: one translation unit each, since every one of them compiles a dozen filters.
#pragma once

#include <memory>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

std::unique_ptr<Tracker> make_plane_kalman(TableReader& table);
std::unique_ptr<Tracker> make_plane_unscented(TableReader& table);
std::unique_ptr<Tracker> make_interacting_multiple_model(TableReader& table);

}  // namespace truebearing
