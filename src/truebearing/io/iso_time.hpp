// SPDX-License-Identifier: Apache-2.0
// ISO 8601 times as seconds: "2026-11-28T19:59:50.25Z", "2026-11-28 20:59+01:00", "20261128T195950Z".
#pragma once

#include <optional>
#include <string_view>

namespace truebearing {

/// Seconds since 1970-01-01 00:00 UTC, leap seconds not counted. A time without an offset is taken for UTC. Nothing where
/// the text is no date with a time of day.
std::optional<double> seconds_of_iso_time(std::string_view text);

}  // namespace truebearing
