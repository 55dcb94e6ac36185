#include "truebearing/array/real_covariance.hpp"

#include <cmath>
#include <numbers>

#include "truebearing/array/simd_dispatch.hpp"

namespace truebearing {
namespace {

constexpr int kLanes = 4;

// The lower triangle, in whole columns from the diagonal's group of lanes on, of X X^T.
[[gnu::always_inline]] inline void outer_loops(int rows, int columns, const double* X, double scale, double* R) {
  for (int j = 0; j < rows; ++j) {
    double* R_j = R + j * rows;
    const int first = j / kLanes * kLanes;
    for (int i = first; i < rows; ++i) R_j[i] = 0.0;
    for (int c = 0; c < columns; ++c) {
      const double* x = X + c * rows;
      const double x_j = x[j] * scale;
#pragma omp simd
      for (int i = first; i < rows; ++i) R_j[i] += x[i] * x_j;
    }
  }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < j; ++i) R[j * rows + i] = R[i * rows + j];
}
TRUEBEARING_FOR_AVX2(outer, (int rows, int columns, const double* X, double scale, double* R),
                     (rows, columns, X, scale, R))

}  // namespace

void RealInterval::take(const Interval& interval, int blocks) {
  const int M = interval.sensors();
  array_.pairs = M / 2;
  array_.middle = M % 2 == 1;
  array_.padded = (M + kLanes - 1) / kLanes * kLanes;
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
  rows_.setZero(array_.padded, 2 * Ns);
  if (static_cast<int>(blocks_.size()) < blocks) blocks_.resize(static_cast<std::size_t>(blocks));
  count_ = 0;
  snapshots_ = 0.0;
  int column = 0, begin = 0;
  double time_sum_s = 0.0;
  const auto close_block = [&] {
    const int columns = column - begin;
    if (columns == 0) return;
    RealCovariance& block = blocks_[static_cast<std::size_t>(count_++)];
    block.R.resize(array_.padded, array_.padded);
    block.snapshots = columns / 2;
    snapshots_ += block.snapshots;
    outer(array_.padded, columns, rows_.data() + begin * array_.padded, 1.0 / block.snapshots, block.R.data());
    block.trace = block.R.trace();
    block.time_s = time_sum_s / block.snapshots;
    begin = column;
    time_sum_s = 0.0;
  };
  constexpr double kHalf = 1.0 / std::numbers::sqrt2;
  int of_block = 0;
  for (const int t : interval.snapshots()) {
    const int belongs = t * blocks / Ns;
    if (belongs != of_block) close_block();
    of_block = belongs;
    for (int i = 0; i < array_.pairs; ++i) {
      const double alive = array_.live[i] * kHalf;
      const std::complex<double> above = interval.value(t, static_cast<int>(sensor(i, 1)));
      const std::complex<double> below = interval.value(t, static_cast<int>(sensor(i, -1)));
      const std::complex<double> sum = alive * (above + below), difference = alive * (above - below);
      rows_(i, column) = sum.real();
      rows_(i, column + 1) = sum.imag();
      rows_(array_.pairs + i, column) = difference.imag();  // over j
      rows_(array_.pairs + i, column + 1) = -difference.real();
    }
    if (array_.middle) {
      const std::complex<double> value = interval.value(t, array_.pairs);
      rows_(2 * array_.pairs, column) = value.real();
      rows_(2 * array_.pairs, column + 1) = value.imag();
    }
    column += 2;
    time_sum_s -= (Ns - 1 - t) * interval.interval_s() / Ns;
  }
  close_block();
}

}  // namespace truebearing
