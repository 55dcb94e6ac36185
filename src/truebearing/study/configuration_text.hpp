// SPDX-License-Identifier: Apache-2.0
// A TOML value on one line, keys sorted, numbers as doubles: how a model file remembers the trackers it was trained
// for.
#pragma once

#include <string>

#include "truebearing/io/toml_forward.hpp"

namespace truebearing {

std::string configuration_text(const toml::node& node);

/// `child` over `parent`: tables are merged key by key, everything else is replaced.
toml::table merged(const toml::table& parent, const toml::table& child);

}  // namespace truebearing
