// Fills the records of a tracker of angles with each one's nearest neighbour.
#pragma once

#include <cmath>
#include <span>

#include "truebearing/array/line_array.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

/// records: of one step, states [angle, rate]. difference_variance(i, j): that of the difference of two angles.
template <typename Variance>
void find_neighbours(const LineArray& array, std::span<StepRecord> records, const Variance& difference_variance) {
  for (std::size_t i = 0; i < records.size(); ++i) {
    StepRecord& record = records[i];
    record.neighbour.reset();
    std::size_t nearest = i;
    for (std::size_t j = 0; j < records.size(); ++j)
      if (j != i &&
          (nearest == i || std::abs(records[j].x[0] - record.x[0]) < std::abs(records[nearest].x[0] - record.x[0])))
        nearest = j;
    if (nearest == i) continue;
    const double distance = array.distance(record.x[0], records[nearest].x[0]);
    record.neighbour =
        Neighbour{records[nearest].track, records[nearest].x - record.x, 1.0 / (1.0 + distance * distance)};
    const double apart_rad = record.neighbour->difference[0];
    record.neighbour->merged = apart_rad * apart_rad < difference_variance(i, nearest);
  }
}

}  // namespace truebearing
