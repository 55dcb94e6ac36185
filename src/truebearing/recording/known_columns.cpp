// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/known_columns.hpp"

#include <algorithm>
#include <array>

namespace truebearing {
namespace {

constexpr std::array kKnown{
    KnownColumn{"position", Dimension::length, ColumnRole::measured, "position_m"},
    KnownColumn{"east", Dimension::length, ColumnRole::measured, "east_m"},
    KnownColumn{"north", Dimension::length, ColumnRole::measured, "north_m"},
    KnownColumn{"up", Dimension::length, ColumnRole::measured, "up_m"},
    KnownColumn{"range", Dimension::length, ColumnRole::measured, "range_m"},
    KnownColumn{"range_rate", Dimension::speed, ColumnRole::measured, "range_rate_mps"},
    KnownColumn{"bearing", Dimension::angle, ColumnRole::measured, "bearing_deg"},
    KnownColumn{"elevation", Dimension::angle, ColumnRole::measured, "elevation_deg"},
    KnownColumn{"frequency", Dimension::frequency, ColumnRole::measured, "frequency_hz"},
    KnownColumn{"sensor_east", Dimension::length, ColumnRole::sensor, "sensor_east_m"},
    KnownColumn{"sensor_north", Dimension::length, ColumnRole::sensor, "sensor_north_m"},
    KnownColumn{"sensor_up", Dimension::length, ColumnRole::sensor, "sensor_up_m"},
    KnownColumn{"sensor_east", Dimension::speed, ColumnRole::sensor, "sensor_east_mps"},
    KnownColumn{"sensor_north", Dimension::speed, ColumnRole::sensor, "sensor_north_mps"},
    KnownColumn{"sensor_up", Dimension::speed, ColumnRole::sensor, "sensor_up_mps"},
    KnownColumn{"guess_range", Dimension::length, ColumnRole::guess, "guess_range_m"},
    KnownColumn{"guess_range_sigma", Dimension::length, ColumnRole::guess, "guess_range_sigma_m"},
    KnownColumn{"guess_speed", Dimension::speed, ColumnRole::guess, "guess_speed_mps"},
    KnownColumn{"guess_speed_sigma", Dimension::speed, ColumnRole::guess, "guess_speed_sigma_mps"}};

}  // namespace

std::span<const KnownColumn> known_columns() {
  return kKnown;
}

const KnownColumn* find_known(const NameAndUnit& name) {
  const auto known = std::find_if(kKnown.begin(), kKnown.end(), [&](const KnownColumn& one) {
    return name.unit && one.stem == name.stem && one.dimension == name.unit->dimension;
  });
  return known == kKnown.end() ? nullptr : &*known;
}

std::string name_here(const NameAndUnit& name) {
  const KnownColumn* known = find_known(name);
  return known ? known->name : name.standard_name();
}

}  // namespace truebearing
