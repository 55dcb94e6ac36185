#include "truebearing/measurement/velocity_truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace truebearing
