// SPDX-License-Identifier: Apache-2.0
// Tables for people: figures of few digits in columns.
#pragma once

#include <string>
#include <vector>

namespace truebearing {

/// Three or four significant digits, without an exponent below ten million; "-" where there is none.
std::string figure(double value);

/// Columns padded to the widest cell; the first to the left, the others to the right.
std::string aligned(const std::vector<std::vector<std::string>>& rows);

}  // namespace truebearing
