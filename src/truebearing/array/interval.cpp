// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/interval.hpp"

#include <algorithm>
#include <cmath>

namespace truebearing {
namespace {

bool is_finite(std::complex<double> value) {
  return std::isfinite(value.real()) && std::isfinite(value.imag());
}

}  // namespace

void Interval::take(const SnapshotBlock& block) {
  const bool is_as_before = block.sensors == sensors_;
  sensors_ = block.sensors;
  block_snapshots_ = block.snapshots();
  spacing_wavelengths_ = block.spacing_wavelengths;
  interval_s_ = block.interval_s;
  if (!is_as_before || re_.cols() < block_snapshots_) {
    re_.setZero(padded_to_lanes(sensors_), block_snapshots_);
    im_.setZero(padded_to_lanes(sensors_), block_snapshots_);
    live_.assign(static_cast<std::size_t>(sensors_), 1.0);
    numbers_.reserve(static_cast<std::size_t>(block_snapshots_));
  }
  std::fill(live_.begin(), live_.end(), 0.0);
  double sum_re = 0.0, sum_im = 0.0, power = 0.0;
  for (int t = 0; t < block_snapshots_; ++t) {
    const std::complex<double>* x = block.snapshot(t).data();
    double *re = re_.col(t).data(), *im = im_.col(t).data();
    for (int m = 0; m < sensors_; ++m) {
      re[m] = x[m].real();
      im[m] = x[m].imag();
      const double size = re[m] * re[m] + im[m] * im[m];
      live_[static_cast<std::size_t>(m)] += size;
      sum_re += re[m];
      sum_im += im[m];
      power += size;
    }
  }
  sums_ << sum_re, sum_im, power;
  numbers_.clear();
  live_count_ = sensors_;
  if (std::isfinite(power) && std::all_of(live_.begin(), live_.end(), [](double size) { return size > 0.0; })) {
    std::fill(live_.begin(), live_.end(), 1.0);
    for (int t = 0; t < block_snapshots_; ++t) numbers_.push_back(t);
    return;
  }
  take_part(block);
}

// The same where sensors are dead or values missing.
void Interval::take_part(const SnapshotBlock& block) {
  live_count_ = 0;
  for (int m = 0; m < sensors_; ++m) {
    const bool alive = block.is_live(m);
    live_[static_cast<std::size_t>(m)] = alive ? 1.0 : 0.0;
    live_count_ += alive ? 1 : 0;
  }
  for (int t = 0; t < block_snapshots_; ++t) {
    const auto column = static_cast<Eigen::Index>(numbers_.size());
    bool finite = true;
    for (int m = 0; m < sensors_; ++m) {
      const std::size_t sensor = static_cast<std::size_t>(m);
      const std::complex<double> value = live_[sensor] == 0.0 ? 0.0 : block.snapshot(t)[sensor];
      finite &= is_finite(value);
      re_(m, column) = value.real();
      im_(m, column) = value.imag();
    }
    if (finite) numbers_.push_back(t);
  }
}

}  // namespace truebearing
