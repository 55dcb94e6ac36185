// SPDX-License-Identifier: Apache-2.0
// Trackers driven by bytes: which tracker, and what comes to it when.
#pragma once

#include <cstdint>
#include <span>

namespace truebearing::testing {

/// The first byte chooses the tracker (the table in estimators.cpp), the second how many ordinary rows come first, the
/// others make measurements. True where the tracker published anything. Throws std::logic_error where an invariant of
/// support/stream_invariants.hpp is broken, a reset does not give the same bits, or an empty row leaves a trace.
bool drive_estimator(std::span<const std::uint8_t> bytes);

}  // namespace truebearing::testing
