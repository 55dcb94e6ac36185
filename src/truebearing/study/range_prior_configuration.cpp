#include "truebearing/study/range_prior_configuration.hpp"

#include <limits>
#include <string>
#include <vector>

#include "truebearing/core/angle.hpp"

namespace truebearing {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

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

RangePrior read_range_prior(TableReader table) {
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
  table.finish();
  return prior;
}

}  // namespace truebearing
