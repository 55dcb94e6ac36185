// The hypotheses of a bank on the range from its table in a study.
#pragma once

#include "truebearing/io/table_reader.hpp"
#include "truebearing/tracker/range_hypotheses.hpp"

namespace truebearing {

/// start, ranges, velocity_cells, speed_between_mps, least_range_m.
RangeHypotheses read_range_hypotheses(TableReader& table);

}  // namespace truebearing
