// What a line array heard over one interval, as a measurement carries it: complex snapshots of all its sensors, as
// views of memory that the Recording owns.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>

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

  /// Whether every sensor gave something in that snapshot; in any of them.
  bool is_finite(int t) const {
    const auto finite = [](std::complex<double> r) { return std::isfinite(r.real()) && std::isfinite(r.imag()); };
    const std::span<const std::complex<double>> r = snapshot(t);
    return std::all_of(r.begin(), r.end(), finite);
  }
  bool has_finite_snapshot() const {
    for (int t = 0; t < snapshots(); ++t)
      if (is_finite(t)) return true;
    return false;
  }
};

}  // namespace truebearing
