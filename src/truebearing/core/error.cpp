#include "truebearing/core/error.hpp"

#include <utility>

namespace truebearing {
namespace {

std::string one_line(const std::string& where, const std::string& found, const std::string& valid) {
  std::string line = where.empty() ? found : where + ": " + found;
  if (!valid.empty()) line += "; valid: " + valid;
  return line;
}

}  // namespace

InputError::InputError(std::string where, std::string found, std::string valid)
    : std::runtime_error(one_line(where, found, valid)),
      where_(std::move(where)),
      found_(std::move(found)),
      valid_(std::move(valid)) {}

}  // namespace truebearing
