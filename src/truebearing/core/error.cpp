// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/error.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "truebearing/core/printable.hpp"

namespace truebearing {
namespace {

// What the program prints is to fit into 200 characters, its own name in front of the message included.
constexpr std::size_t kMostShown = 200 - std::string_view("truebearing: ").size() - 1;

// Of the place its end, which has the row, of the rest its beginning; what would be valid gives way first.
std::string one_line(const std::string& place, const std::string& fault, const std::string& remedy) {
  constexpr std::size_t kMostOfPlace = 80, kMostOfFault = 100, kFewestOfRemedy = 12;
  constexpr std::string_view kValid = "; valid: ";
  std::string where = printable(place), found = printable(fault), valid = printable(remedy);
  const auto whole = [&] {
    const std::string line = where.empty() ? found : where + ": " + found;
    return valid.empty() ? line : line + std::string(kValid) + valid;
  };
  if (whole().size() <= kMostShown) return whole();
  where = shortened_from_front(where, kMostOfPlace);
  found = shortened(found, kMostOfFault);
  const std::size_t left = kMostShown - std::min(kMostShown, where.size() + found.size() + 2 + kValid.size());
  valid = left < kFewestOfRemedy ? std::string() : shortened(valid, left);
  return whole();
}

}  // namespace

InputError::InputError(std::string where, std::string found, std::string valid)
    : std::runtime_error(one_line(where, found, valid)),
      where_(std::move(where)),
      found_(std::move(found)),
      valid_(std::move(valid)) {}

}  // namespace truebearing
