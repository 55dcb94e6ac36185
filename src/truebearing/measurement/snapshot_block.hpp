// SPDX-License-Identifier: Apache-2.0
// What a line array heard over one interval, as a measurement carries it: complex snapshots of all its sensors, as
// views of memory that the Recording owns.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>
#include <vector>

namespace truebearing {

struct SnapshotBlock {
  /// r_m(t) of sensor m and snapshot t at values[t * sensors + m]; NaN where a sensor gave nothing.
  std::span<const std::complex<double>> values;
  int sensors = 0;
  double spacing_wavelengths = 0.5;  ///< between neighbouring sensors, in wavelengths
  /// Snapshots come evenly: number t of Ns, counted from 0, at time_s - (Ns - 1 - t) / Ns interval_s of the
  /// measurement.
  double interval_s = 1.0;

  int snapshots() const { return sensors > 0 ? static_cast<int>(values.size()) / sensors : 0; }
  std::span<const std::complex<double>> snapshot(int t) const {
    return values.subspan(static_cast<std::size_t>(t) * static_cast<std::size_t>(sensors),
                          static_cast<std::size_t>(sensors));
  }

  /// Whether sensor m gave a number in snapshot t; whether all did.
  bool is_finite(int t, int m) const {
    const std::complex<double> r = snapshot(t)[static_cast<std::size_t>(m)];
    return std::isfinite(r.real()) && std::isfinite(r.imag());
  }
  bool is_finite(int t) const {
    for (int m = 0; m < sensors; ++m)
      if (!is_finite(t, m)) return false;
    return true;
  }
  /// Whether sensor m ever gives a number other than zero. One that does not is dead, and the others do without it.
  bool is_live(int m) const {
    for (int t = 0; t < snapshots(); ++t)
      if (is_finite(t, m) && snapshot(t)[static_cast<std::size_t>(m)] != 0.0) return true;
    return false;
  }
  /// Whether there is a snapshot with a number from every sensor that lives, and such a sensor.
  bool has_usable_snapshot() const {
    std::vector<int> live;
    for (int m = 0; m < sensors; ++m)
      if (is_live(m)) live.push_back(m);
    const auto is_whole = [&](int t) {
      return std::all_of(live.begin(), live.end(), [&](int m) { return is_finite(t, m); });
    };
    for (int t = 0; t < snapshots() && !live.empty(); ++t)
      if (is_whole(t)) return true;
    return false;
  }
};

}  // namespace truebearing
