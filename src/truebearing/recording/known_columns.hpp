// SPDX-License-Identifier: Apache-2.0
// The columns that a measurement log may have in any unit, besides those of its own: the quantities and their names here.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "truebearing/recording/log_columns.hpp"
#include "truebearing/recording/log_units.hpp"

namespace truebearing {

/// What a log may hold of this name in a unit of this dimension, and what it is called here.
struct KnownColumn {
  std::string_view stem;
  Dimension dimension;
  ColumnRole role;
  const char* name;
};

std::span<const KnownColumn> known_columns();

/// The one of that stem in a unit of that dimension; nullptr where there is none.
const KnownColumn* find_known(const NameAndUnit& name);

/// "range_km" -> "range_m", "bearing_rad" -> "bearing_deg", "depth_ft" -> "depth_m".
std::string name_here(const NameAndUnit& name);

}  // namespace truebearing
