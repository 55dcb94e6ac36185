// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/bound_summary.hpp"

#include <array>
#include <cmath>

namespace truebearing {
namespace {

struct Bounded {
  const char* name;
  const char* unit;
  double TargetMotionVariance::*variance;
};
constexpr std::array kBounded{
    Bounded{"position_rmse", "m", &TargetMotionVariance::position_m2},
    Bounded{"velocity_rmse", "m/s", &TargetMotionVariance::velocity_m2ps2},
    Bounded{"range_error_rmse", "percent", &TargetMotionVariance::range_percent2},
    Bounded{"course_error_rmse", "deg", &TargetMotionVariance::course_deg2},
    Bounded{"speed_error_rmse", "m/s", &TargetMotionVariance::speed_m2ps2},
};
constexpr Bounded kFrequency{"frequency_rmse", "Hz", &TargetMotionVariance::frequency_hz2};
constexpr const char* kRange = "range_error_rmse";

}  // namespace

void BoundTally::begin(std::size_t times) {
  if (!sums_.empty()) return;
  sums_.resize(times);
  for (TargetMotionVariance& sum : sums_) {
    for (const Bounded& part : kBounded) sum.*part.variance = 0.0;
    sum.*kFrequency.variance = 0.0;
  }
}

void BoundTally::exchange(TallyStream& stream) {
  begin(stream.length(sums_.size()));
  for (TargetMotionVariance& sum : sums_) {
    for (const Bounded& part : kBounded) stream.sum(sum.*part.variance);
    stream.sum(sum.*kFrequency.variance);
  }
  stream.any(has_frequency_);
  stream.sum(runs_);
}

void BoundTally::add(const std::vector<TargetMotionVariance>& run) {
  begin(run.size());
  for (std::size_t time = 0; time < run.size(); ++time) {
    for (const Bounded& part : kBounded) sums_[time].*part.variance += run[time].*part.variance;
    sums_[time].*kFrequency.variance += run[time].*kFrequency.variance;
    has_frequency_ |= std::isfinite(run[time].*kFrequency.variance);
  }
  runs_ += 1.0;
}

// A run that does not reach the time has no step there, and NaN, as has one that is not determined: neither has a bound.
double BoundTally::mean(std::size_t time, double TargetMotionVariance::*variance) const {
  return time < sums_.size() ? sums_[time].*variance / runs_ : std::nan("");
}

BoundSummary BoundTally::summary(const std::vector<double>& times_s) const {
  BoundSummary summary;
  std::vector<Bounded> bounded(kBounded.begin(), kBounded.end());
  if (has_frequency_) bounded.push_back(kFrequency);
  double position_m2 = 0.0, velocity_m2ps2 = 0.0;
  for (std::size_t time = 0; time < times_s.size(); ++time) {
    for (const Bounded& part : bounded)
      summary.metrics.push_back(
          {part.name, part.unit, times_s[time], std::sqrt(mean(time, part.variance)), std::nan("")});
    position_m2 += mean(time, &TargetMotionVariance::position_m2);
    velocity_m2ps2 += mean(time, &TargetMotionVariance::velocity_m2ps2);
  }
  const double times = static_cast<double>(times_s.size());
  summary.position_m = std::sqrt(position_m2 / times);
  summary.velocity_mps = std::sqrt(velocity_m2ps2 / times);
  return summary;
}

BoundSummary summarise_bound(const std::vector<const std::vector<TargetMotionVariance>*>& runs,
                             const std::vector<double>& times_s) {
  BoundTally tally;
  for (const std::vector<TargetMotionVariance>* run : runs) tally.add(*run);
  return tally.summary(times_s);
}

std::vector<Metric> range_efficiency(const std::vector<Metric>& tracker, const std::vector<Metric>& bound) {
  std::vector<Metric> efficiency;
  for (const Metric& reached : tracker)
    for (const Metric& least : bound)
      if (reached.name == kRange && least.name == kRange && reached.time_s == least.time_s)
        efficiency.push_back(
            {"range_efficiency", "1", reached.time_s, reached.value / least.value, reached.se / least.value});
  return efficiency;
}

}  // namespace truebearing
