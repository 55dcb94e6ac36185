// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/velocity_truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

namespace truebearing {
namespace {

double slope(std::span<const double> t, std::span<const double> p) {
  double count = 0.0, mean_t = 0.0, mean_p = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (std::isnan(p[i])) continue;
    count += 1.0;
    mean_t += (t[i] - mean_t) / count;
    mean_p += (p[i] - mean_p) / count;
  }
  double tt = 0.0, tp = 0.0;
  bool distinct = false;
  double first_t = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (std::isnan(p[i])) continue;
    if (std::isnan(first_t)) first_t = t[i];
    distinct |= t[i] != first_t;
    tt += (t[i] - mean_t) * (t[i] - mean_t);
    tp += (t[i] - mean_t) * (p[i] - mean_p);
  }
  return distinct ? tp / tt : std::numeric_limits<double>::quiet_NaN();
}

/// The position whose derivative a velocity is, and nothing for other components.
std::string position_of(std::string_view velocity) {
  constexpr std::string_view kVelocityUnit = "_mps";
  if (!velocity.ends_with(kVelocityUnit)) return {};
  const std::string_view stem = velocity.substr(0, velocity.size() - kVelocityUnit.size());
  return std::string(stem == "velocity" ? "position" : stem) + "_m";
}

}  // namespace

std::vector<double> velocity_truth(std::span<const double> time_s, std::span<const double> position_m) {
  constexpr std::size_t kNeighbours = 2;
  std::vector<double> velocity_mps(time_s.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    if (std::isnan(position_m[i])) continue;
    const std::size_t first = i - std::min(i, kNeighbours);
    const std::size_t count = std::min(i + kNeighbours + 1, time_s.size()) - first;
    velocity_mps[i] = slope(time_s.subspan(first, count), position_m.subspan(first, count));
  }
  return velocity_mps;
}

void complete_velocities(const StateSpace& space, const std::vector<bool>& given, std::span<const double> time_s,
                         std::span<BoundedVector> x) {
  for (int i = 0; i < space.size(); ++i) {
    const auto component = static_cast<std::size_t>(i);
    const int partner = space.component_index(position_of(space.components[component]));
    if (given[component] || partner < 0) continue;
    std::vector<double> position_m;
    for (const BoundedVector& state : x) position_m.push_back(state(partner));
    const std::vector<double> velocity_mps = velocity_truth(time_s, position_m);
    for (std::size_t k = 0; k < x.size(); ++k) x[k](i) = velocity_mps[k];
  }
}

}  // namespace truebearing
