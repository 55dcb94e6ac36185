// SPDX-License-Identifier: Apache-2.0
// Bad input: a file, a key, an option. One exception type for all of it; the command line prints it in one line.
#pragma once

#include <stdexcept>
#include <string>

namespace truebearing {

class InputError : public std::runtime_error {
 public:
  /// where: file, line or key ("study.toml:12: trackers.plain.Q"). found: what is wrong there.
  /// valid: what would be valid; may be empty where that is plain.
  InputError(std::string where, std::string found, std::string valid = {});

  const std::string& where() const { return where_; }
  const std::string& found() const { return found_; }
  const std::string& valid() const { return valid_; }

 private:
  std::string where_;
  std::string found_;
  std::string valid_;
};

/// Throws InputError unless `valid`.
inline void require_valid(bool valid, const char* where, const std::string& found, const std::string& wanted) {
  if (!valid) throw InputError(where, found, wanted);
}

}  // namespace truebearing
