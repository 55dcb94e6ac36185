// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/interval.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "truebearing/array/snapshot_kernel.hpp"

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
    re_.setZero(padded_to_widest(sensors_), block_snapshots_);
    im_.setZero(padded_to_widest(sensors_), block_snapshots_);
    live_.resize(static_cast<std::size_t>(sensors_));
    sensor_sums_.resize(sensors_, 3);
    numbers_.reserve(static_cast<std::size_t>(block_snapshots_));
  }
  auto sum_re = sensor_sums_.col(0), sum_im = sensor_sums_.col(1), power = sensor_sums_.col(2);
  // Complex numbers may be read as pairs of real ones.
  kernels::part({sensors_, block_snapshots_, reinterpret_cast<const double*>(block.values.data()),
                 static_cast<int>(re_.rows()), re_.data(), im_.data(), sum_re.data(), sum_im.data(), power.data()});
  sums_ << sum_re.sum(), sum_im.sum(), power.sum();
  live_count_ = sensors_;
  if (std::isfinite(sums_[2]) && (power.array() > 0.0).all()) {
    std::fill(live_.begin(), live_.end(), 1.0);
    numbers_.resize(static_cast<std::size_t>(block_snapshots_));
    std::iota(numbers_.begin(), numbers_.end(), 0);
    return;
  }
  numbers_.clear();
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
