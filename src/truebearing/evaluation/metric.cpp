// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/metric.hpp"

#include <fmt/format.h>

namespace truebearing {

std::string unit_of(const std::string& quantity) {
  const std::size_t underscore = quantity.rfind('_');
  const std::string unit = underscore == std::string::npos ? "" : quantity.substr(underscore + 1);
  return unit == "mps" ? "m/s" : unit == "degps" ? "deg/s" : unit == "hz" ? "Hz" : unit;
}

std::string squared_unit_of(const std::string& quantity) {
  const std::string unit = unit_of(quantity);
  return unit.find('/') == std::string::npos ? fmt::format("{}^2", unit) : fmt::format("({})^2", unit);
}

std::string name_of(const std::string& quantity) {
  return quantity.substr(0, quantity.rfind('_'));
}

std::string title_of(const std::string& quantity) {
  return fmt::format("{} {}", name_of(quantity), unit_of(quantity));
}

}  // namespace truebearing
