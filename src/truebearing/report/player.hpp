// SPDX-License-Identifier: Apache-2.0
// The script of a page with pictures of runs: a slider under each that plays it. Without it the page is complete.
#pragma once

#include <string>

namespace truebearing {

/// Its text holds neither < nor &, so that a page stays well-formed.
const std::string& player_script();

}  // namespace truebearing
