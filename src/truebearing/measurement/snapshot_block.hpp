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
    const std::complex<double> r =
        values[static_cast<std::size_t>(t) * static_cast<std::size_t>(sensors) + static_cast<std::size_t>(m)];
    return std::isfinite(r.real()) && std::isfinite(r.imag());
  }
  bool is_finite(int t) const {
    for (int m = 0; m < sensors; ++m)
      if (!is_finite(t, m)) return false;
    return true;
  }
  /// Whether there is a snapshot with a number from every sensor that gives one at all: a sensor that never does is
  /// dead, and the others do without it.
  bool has_usable_snapshot() const {
    int most = 0;  // numbers in one snapshot
    std::vector<bool> gives(static_cast<std::size_t>(std::max(sensors, 0)), false);
    for (int t = 0; t < snapshots(); ++t) {
      int count = 0;
      for (int m = 0; m < sensors; ++m) {
        if (!is_finite(t, m)) continue;
        gives[static_cast<std::size_t>(m)] = true;
        ++count;
      }
      most = std::max(most, count);
    }
    return most > 0 && most == std::count(gives.begin(), gives.end(), true);
  }
};

}  // namespace truebearing
