// SPDX-License-Identifier: Apache-2.0
// Are squared residuals as large as they are claimed to be? Means over windows in time, with where 95 % of such means lie.
#pragma once

#include <string>
#include <vector>

#include "truebearing/report/plot.hpp"

namespace truebearing {

struct SquaredResiduals {
  std::vector<double> time_s, nis, freedom;  ///< nu' S^-1 nu of each, and its degrees of freedom
};

/// Empty where there are too few for two windows. id and title are the caller's; name: in the legend.
Plot consistency_plot(const SquaredResiduals& residuals, const std::string& name);

}  // namespace truebearing
