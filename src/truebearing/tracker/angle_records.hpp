// SPDX-License-Identifier: Apache-2.0
// What trackers of several targets' angles do with their records alike.
#pragma once

#include <cmath>
#include <span>
#include <variant>

#include "truebearing/array/line_array.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

/// Whether a target is in the array's sector, and not anywhere in it. x: [angle, rate].
template <typename Vector, typename Matrix>
bool is_in_sector(const Vector& x, const Matrix& P) {
  constexpr double kAnywhere_rad = 1.0;
  return std::abs(x[0]) < 0.5 * kPi && P(0, 0) < kAnywhere_rad * kAnywhere_rad && x.allFinite() && P.allFinite();
}

/// Of a measurement that was not looked at: the states of the step before stand.
inline void refuse(std::span<StepRecord> records) {
  for (StepRecord& record : records) {
    record.status = StepStatus::rejected;
    record.prediction.reset();
    record.innovation.reset();
    record.gain.reset();
  }
}

/// Sensors without which that many targets cannot be told apart; 0 where their number is counted.
template <typename Criterion>
int fewest_sensors(const std::variant<int, Criterion>& targets) {
  const int* given = std::get_if<int>(&targets);
  return given ? *given + 1 : 0;
}

/// Fills in each record's nearest neighbour. records: of one step, states [angle, rate]. difference_variance(i, j):
/// that of the difference of two angles.
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
