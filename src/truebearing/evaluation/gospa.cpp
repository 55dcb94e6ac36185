// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/gospa.hpp"

#include <algorithm>
#include <numeric>

namespace truebearing {
namespace {

// Places in ascending order of the values.
std::vector<std::size_t> order_of(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  return order;
}

}  // namespace

Gospa gospa(std::span<const double> targets, std::span<const double> tracks, double cutoff) {
  const std::vector<std::size_t> target_order = order_of(targets), track_order = order_of(tracks);
  const std::size_t n = targets.size(), m = tracks.size();
  const double alone = 0.5 * cutoff * cutoff;
  const auto together = [&](std::size_t i, std::size_t j) {
    const double d = targets[target_order[i]] - tracks[track_order[j]];
    return d * d;
  };
  // Least cost of the first i targets and the first j tracks at least[i * (m + 1) + j].
  std::vector<double> least((n + 1) * (m + 1));
  const auto cost = [&](std::size_t i, std::size_t j) -> double& { return least[i * (m + 1) + j]; };
  for (std::size_t i = 0; i <= n; ++i)
    for (std::size_t j = 0; j <= m; ++j) {
      if (i == 0 || j == 0) {
        cost(i, j) = alone * static_cast<double>(i + j);
        continue;
      }
      cost(i, j) =
          std::min({cost(i - 1, j) + alone, cost(i, j - 1) + alone, cost(i - 1, j - 1) + together(i - 1, j - 1)});
    }

  Gospa found;
  found.track_of.assign(n, -1);
  std::size_t assigned = 0;
  for (std::size_t i = n, j = m; i > 0 && j > 0;) {
    if (cost(i, j) == cost(i - 1, j) + alone) {
      --i;
    } else if (cost(i, j) == cost(i, j - 1) + alone) {
      --j;
    } else {
      --i, --j, ++assigned;
      found.track_of[target_order[i]] = static_cast<int>(track_order[j]);
      found.localisation += together(i, j);
    }
  }
  found.missed = static_cast<int>(n - assigned);
  found.false_tracks = static_cast<int>(m - assigned);
  return found;
}

}  // namespace truebearing
