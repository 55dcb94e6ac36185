// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/real_covariance.hpp"

#include <cmath>
#include <numbers>

#include "truebearing/array/outer_product_kernel.hpp"
#include "truebearing/core/simd_lanes.hpp"

namespace truebearing {
void RealInterval::take(const Interval& interval, int blocks) {
  const int M = interval.sensors();
  const bool is_as_before = array_.pairs == M / 2 && array_.middle == (M % 2 == 1);
  array_.pairs = M / 2;
  array_.middle = M % 2 == 1;
  array_.padded = padded_to_lanes(M);
  array_.spacing_wavelengths = interval.spacing_wavelengths();
  array_.live.setZero(array_.padded);
  const std::vector<double>& live = interval.live();
  const auto sensor = [&](int i, int side) {  // of pair i, above or below the middle
    return static_cast<std::size_t>(side > 0 ? M - array_.pairs + i : array_.pairs - 1 - i);
  };
  for (int i = 0; i < array_.pairs; ++i)
    array_.live[i] = array_.live[array_.pairs + i] = live[sensor(i, 1)] * live[sensor(i, -1)];
  if (array_.middle) array_.live[2 * array_.pairs] = live[static_cast<std::size_t>(array_.pairs)];
  array_.live_rows = static_cast<int>(array_.live.sum());

  const int Ns = interval.block_snapshots();
  if (!is_as_before || rows_.cols() < 2 * Ns) rows_.setZero(array_.padded, 2 * Ns);
  if (static_cast<int>(blocks_.size()) < blocks) blocks_.resize(static_cast<std::size_t>(blocks));
  count_ = 0;
  snapshots_ = 0.0;
  int begin = 0;
  double time_sum_s = 0.0;
  const auto close_block = [&](int end) {
    if (end == begin) return;
    RealCovariance& block = blocks_[static_cast<std::size_t>(count_++)];
    block.R.resize(array_.padded, array_.padded);
    block.snapshots = end - begin;
    snapshots_ += block.snapshots;
    kernels::outer_product(array_.padded, 2 * (end - begin), rows_.col(2 * begin).data(), 1.0 / block.snapshots,
                           block.R.data());
    block.trace = block.R.trace();
    block.time_s = time_sum_s / block.snapshots;
    begin = end;
    time_sum_s = 0.0;
  };
  constexpr double kHalf = 1.0 / std::numbers::sqrt2;
  const int above = M - array_.pairs, below = array_.pairs - 1;  // of pair 0
  int of_block = 0;
  for (int t = 0; t < interval.snapshots(); ++t) {
    const int belongs = interval.number(t) * blocks / Ns;
    if (belongs != of_block) close_block(t);
    of_block = belongs;
    const double *re = interval.re(t), *im = interval.im(t);
    double *real = rows_.col(2 * t).data(), *imaginary = rows_.col(2 * t + 1).data();
    for (int i = 0; i < array_.pairs; ++i) {
      const double alive = array_.live[i] * kHalf;
      real[i] = alive * (re[above + i] + re[below - i]);
      imaginary[i] = alive * (im[above + i] + im[below - i]);
      real[array_.pairs + i] = alive * (im[above + i] - im[below - i]);  // the difference over j
      imaginary[array_.pairs + i] = -alive * (re[above + i] - re[below - i]);
    }
    if (array_.middle) {
      real[2 * array_.pairs] = re[array_.pairs];
      imaginary[2 * array_.pairs] = im[array_.pairs];
    }
    time_sum_s -= (Ns - 1 - interval.number(t)) * interval.interval_s() / Ns;
  }
  close_block(interval.snapshots());
}

}  // namespace truebearing
