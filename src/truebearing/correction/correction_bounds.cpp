// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/correction_bounds.hpp"

#include <cmath>
#include <fmt/format.h>

#include "truebearing/core/error.hpp"

namespace truebearing {

void CorrectionBounds::validate() const {
  const auto require = [](bool valid, const char* where, double found, const char* wanted) {
    if (!valid) throw InputError(where, fmt::format("is {}", found), wanted);
  };
  require(kappa > 0.0, "kappa", kappa, "a number > 0, or infinity for none");
  require(longest_interval_s > 0.0, "longest_interval_s", longest_interval_s, "a number > 0, or infinity for none");
  if (!referee && !fallback.empty())
    throw InputError("fallback", "is \"" + fallback + "\", and no referee says when it is better", "a referee");
  if (!referee) return;
  require(referee->alpha > 0.0 && referee->alpha <= 1.0, "referee.alpha", referee->alpha, "a number in (0, 1]");
  require(referee->tolerance > 0.0 && std::isfinite(referee->tolerance), "referee.tolerance", referee->tolerance,
          "a number > 0");
  require(referee->edge > 0.0 && std::isfinite(referee->edge), "referee.edge", referee->edge, "a number > 0");
}

std::string describe(const CorrectionBounds& bounds) {
  std::string text = fmt::format("kappa {}, {}gate", bounds.kappa, bounds.gate ? "" : "no ");
  if (std::isfinite(bounds.longest_interval_s)) text += fmt::format(" up to {} s", bounds.longest_interval_s);
  text += ", ";
  if (!bounds.referee) return text + "no referee";
  const auto& [alpha, tolerance, edge] = *bounds.referee;
  text += fmt::format("referee of alpha {}, tolerance {}, edge {}", alpha, tolerance, edge);
  return bounds.fallback.empty() ? text : text + ", fallback " + bounds.fallback;
}

}  // namespace truebearing
