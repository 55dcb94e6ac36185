// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/axis.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/constants.hpp"
#include "truebearing/report/markup.hpp"

namespace truebearing {
namespace {

// 1, 2 or 5 times a power of ten, the least that is not below `step`.
double round_step(double step) {
  const double decade = std::pow(10.0, std::floor(std::log10(step)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (step <= factor * decade * (1.0 + 1e-9)) return factor * decade;
  return 10.0 * decade;
}

void widen_nothing(double& low, double& high) {
  if (high > low) return;
  const double half = low == 0.0 ? 1.0 : 0.5 * std::abs(low);
  low -= half;
  high += half;
}

// Digits that tell neighbours apart.
int digits_of(double largest, double step) {
  return std::max(1,
                  static_cast<int>(std::floor(std::log10(largest) + 1e-9) - std::floor(std::log10(step) + 1e-9)) + 1);
}

void add_ticks(Axis& axis, double step) {
  const double largest = std::max(std::abs(axis.low), std::abs(axis.high));
  const double first = std::ceil(axis.low / step - 1e-9), last = std::floor(axis.high / step + 1e-9);
  for (double i = first; i <= last; i += 1.0) {
    axis.ticks.push_back(i * step);
    axis.labels.push_back(shown(i * step, digits_of(std::max(largest, step), step)));
  }
}

}  // namespace

double Axis::place(double value) const {
  if (!logarithmic) return (value - low) / (high - low);
  return value > 0.0 ? std::log(value / low) / std::log(high / low) : kNaN;
}

Axis linear_axis(double low, double high, int about) {
  widen_nothing(low, high);
  const double step = round_step((high - low) / about);
  Axis axis{step * std::floor(low / step + 1e-9), step * std::ceil(high / step - 1e-9), false, {}, {}};
  add_ticks(axis, step);
  return axis;
}

Axis exact_axis(double low, double high, int about) {
  widen_nothing(low, high);
  Axis axis{low, high, false, {}, {}};
  add_ticks(axis, round_step((high - low) / about));
  return axis;
}

Axis logarithmic_axis(double low, double high) {
  Axis axis{low, high, true, {}, {}};
  if (high <= low) axis = {low / 2.0, low * 2.0, true, {}, {}};
  constexpr double kFewDecades = 2.5, kMostTicks = 7.0;
  const double decades = std::log10(axis.high / axis.low);
  const auto add = [&](double tick) {
    if (tick < axis.low * (1.0 - 1e-9) || tick > axis.high * (1.0 + 1e-9)) return;
    axis.ticks.push_back(tick);
    axis.labels.push_back(shown(tick, 2));
  };
  const int every = std::max(1, static_cast<int>(std::ceil(decades / kMostTicks)));
  const int first = static_cast<int>(std::floor(std::log10(axis.low)));
  for (int decade = first; std::pow(10.0, decade) <= axis.high; ++decade) {
    if (decades > kFewDecades && (decade % every) != 0) continue;
    for (const double factor : {1.0, 2.0, 5.0})
      if (factor == 1.0 || decades <= kFewDecades) add(factor * std::pow(10.0, decade));
  }
  if (axis.ticks.size() < 2) {  // less than a factor of two and a half
    axis.ticks.clear();
    axis.labels.clear();
    Axis even{axis.low, axis.high, false, {}, {}};
    add_ticks(even, round_step((axis.high - axis.low) / 4.0));
    axis.ticks = even.ticks;
    axis.labels = even.labels;
  }
  return axis;
}

bool wants_logarithm(const std::vector<double>& values) {
  double least = kInfinity, greatest = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    if (value <= 0.0) return false;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  constexpr double kFactor = 30.0;
  return greatest > kFactor * least;
}

}  // namespace truebearing
