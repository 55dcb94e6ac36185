// SPDX-License-Identifier: Apache-2.0
// What a call that must fail says: for tests that hold an error to where, what and what would be valid.
#pragma once

#include <string>

#include "truebearing/core/error.hpp"

namespace truebearing::testing {

/// The message of the InputError that `call` throws; "no error" where it throws none.
template <typename Call>
std::string error_message(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace truebearing::testing
