// SPDX-License-Identifier: Apache-2.0
// Makers of batch target-motion analysis from tables of a study.
#pragma once

#include <memory>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/tracker/bearings_batch_tracker.hpp"

namespace truebearing {

/// Kind "bearings_batch". Keys: method = "ml", "map", "gauss_newton", "levenberg" or "levenberg_marquardt"; measurement
/// = { model = "bearing", bearing_sigma_deg, sigma_factor }; window_s; solve_at_s or solve_every_s. Of ml and map:
/// start_ranges_m or start_grid, huber_sigmas, warm_start, cut_at_manoeuvres; measurement = { model =
/// "bearing_frequency", bearing_sigma_deg, frequency_sigma_hz, sigma_factor, sound_mps } and with it frequency_changes
/// = "levels", "segments", "switch" or "ignored", false_alarm_probability, scan_threshold. Of map: prior = { kind =
/// "range", ... } as filters start from, or { kind = "velocity", velocity_sigma_mps }. Of gauss_newton: inverse =
/// "cofactor", "cofactor_float" or "pivoted".
std::unique_ptr<Tracker> make_bearings_batch(TableReader& table);

}  // namespace truebearing
