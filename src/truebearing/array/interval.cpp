#include "truebearing/array/interval.hpp"

#include <cmath>

namespace truebearing {
namespace {

bool is_finite(std::complex<double> value) {
  return std::isfinite(value.real()) && std::isfinite(value.imag());
}

bool is_alive(const SnapshotBlock& block, int m) {
  for (int t = 0; t < block.snapshots(); ++t) {
    const std::complex<double> value = block.snapshot(t)[static_cast<std::size_t>(m)];
    if (is_finite(value) && value != 0.0) return true;
  }
  return false;
}

}  // namespace

void Interval::take(const SnapshotBlock& block) {
  block_ = block;
  live_.resize(static_cast<std::size_t>(block.sensors));
  live_count_ = 0;
  for (int m = 0; m < block.sensors; ++m) {
    const bool alive = is_alive(block, m);
    live_[static_cast<std::size_t>(m)] = alive ? 1.0 : 0.0;
    live_count_ += alive ? 1 : 0;
  }
  snapshots_.clear();
  for (int t = 0; t < block.snapshots(); ++t) {
    bool finite = true;
    for (int m = 0; m < block.sensors; ++m) finite &= is_finite(value(t, m));
    if (finite) snapshots_.push_back(t);
  }
}

}  // namespace truebearing
