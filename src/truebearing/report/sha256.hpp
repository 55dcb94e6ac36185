// SPDX-License-Identifier: Apache-2.0
// SHA-256 (FIPS 180-4), by which a page's content security policy names the style and the script that are its own.
#pragma once

#include <string>
#include <string_view>

namespace truebearing {

/// The hash in base 64, as a policy writes it.
std::string sha256_base64(std::string_view text);

}  // namespace truebearing
