// SPDX-License-Identifier: Apache-2.0
// Numbers of a JSON file that are looked at, not computed with: six digits of each; null of what is not known.
#pragma once

#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <vector>

namespace truebearing {

inline nlohmann::ordered_json six_digits(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.6g}", value).c_str(), nullptr);
}

/// Of every n-th.
inline nlohmann::ordered_json six_digits(const std::vector<double>& values, std::size_t every = 1) {
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < values.size(); i += every) array.push_back(six_digits(values[i]));
  return array;
}

}  // namespace truebearing
