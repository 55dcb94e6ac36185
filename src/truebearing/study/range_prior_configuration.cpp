// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/range_prior_configuration.hpp"

#include <fmt/format.h>
#include <string>
#include <vector>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

RangePrior::Course read_course(TableReader table, bool guessed) {
  RangePrior::Course course{kNaN, kNaN, 0.0, 0.0};
  course.from_bearing_rad = radians(table.number("from_bearing_deg", {-360.0, 360.0}));
  course.sigma_rad = radians(table.number("sigma_deg", {0.0, 360.0, true}));
  if (!guessed) {
    course.speed_mps = table.number("speed_mps", kNonNegative);
    course.speed_sigma_mps = table.number("speed_sigma_mps", kPositive);
  }
  table.finish();
  return course;
}

}  // namespace

RangePrior read_range_prior(TableReader table, int dimensions) {
  table.choice("kind", {"range"});
  RangePrior prior;
  const bool guessed = table.boolean_or("guess", false);
  if (!guessed) {
    prior.range_m = table.number("range_m", kPositive);
    prior.range_sigma_m = table.number("range_sigma_m", kPositive);
  }
  if (table.has("between_m")) {
    const std::vector<double> between = table.numbers("between_m", 2, kPositive);
    if (between[0] >= between[1]) throw table.error("between_m", "is empty", "[low, high] with low < high");
    prior.between = RangePrior::Interval{between[0], between[1]};
  }
  if (table.has("course") == table.has("velocity_sigma_mps"))
    throw table.error("", "has neither or both of course and velocity_sigma_mps", "one of the two");
  if (table.has("course"))
    prior.course = read_course(table.table("course"), guessed);
  else
    prior.velocity_sigma_mps = table.number("velocity_sigma_mps", kPositive);
  if (dimensions == 3 && table.has("climb_sigma_mps"))
    prior.climb_sigma_mps = table.number("climb_sigma_mps", kPositive);
  table.finish();
  return prior;
}

RangeHypotheses read_range_hypotheses(TableReader& table, int dimensions) {
  constexpr int kMost = 10000;
  RangeHypotheses hypotheses{read_range_prior(table.table("start"), dimensions)};
  hypotheses.ranges = static_cast<int>(table.integer("ranges", 1, kMost));
  hypotheses.velocity_cells = static_cast<int>(table.integer_or("velocity_cells", 1, 1, 360));
  hypotheses.least_range_m = table.number_or("least_range_m", 0.0, kNonNegative);
  if (hypotheses.velocity_cells == 2 || (hypotheses.velocity_cells > 2 && hypotheses.prior.course))
    throw table.error("velocity_cells", fmt::format("is {}", hypotheses.velocity_cells),
                      hypotheses.prior.course ? "1 beside a course" : "1, or 3 and more sectors");
  if (table.has("speed_between_mps")) {
    const std::vector<double> speeds = table.numbers("speed_between_mps", 2, kNonNegative);
    if (speeds[0] >= speeds[1] || hypotheses.velocity_cells == 1)
      throw table.error("speed_between_mps",
                        hypotheses.velocity_cells == 1 ? "stands beside one velocity cell" : "is empty",
                        "[low, high] with low < high, beside velocity_cells");
    hypotheses.speed_between_mps = {speeds[0], speeds[1]};
  }
  if (hypotheses.size() > kMost)
    throw table.error("ranges", fmt::format("makes a bank of {}", hypotheses.size()), fmt::format("1 to {}", kMost));
  return hypotheses;
}

}  // namespace truebearing
