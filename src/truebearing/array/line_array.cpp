// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/line_array.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace truebearing {

std::string LineArray::note() const {
  constexpr double kHalf = 0.5 * (1.0 + 1e-9);
  if (spacing_wavelengths <= kHalf) return {};
  const double repeats_deg = degrees(std::asin(std::min(1.0, 0.5 / spacing_wavelengths)));
  return fmt::format(
      "The sensors stand {:.4g} wavelengths apart, more than half of one: angles whose sines differ by {:.3g} sound "
      "alike, so that only targets within {:.3g} deg of broadside can be told from their images.",
      spacing_wavelengths, 1.0 / spacing_wavelengths, repeats_deg);
}

}  // namespace truebearing
