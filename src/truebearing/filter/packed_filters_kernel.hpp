// SPDX-License-Identifier: Apache-2.0
// Kalman filters side by side, eight to a block, each in a lane of its own: the modes of one multiple model (PackedModes),
// or one filter of each of several targets or runs (StatePack). Each lane works as KalmanFilter in Joseph's form does
// (covariance_form.hpp) and in the same order, so to the same bits, whether a register holds two, four or eight of them.
// Lanes behind the last filter that are in a register with it hold any numbers; nothing reads them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "truebearing/filter/any_measurement.hpp"

namespace truebearing::kernels {

inline constexpr int kBlock = 8;  // filters
constexpr int blocks_of(int filters) {
  return (filters + kBlock - 1) / kBlock;
}
/// Where a register of AVX-512 can be loaded from.
inline constexpr std::size_t kAlignment = kBlock * sizeof(double);

/// One number of each filter.
struct alignas(kAlignment) OfFilters {
  double lane[kBlock];

  double& operator[](int filter) { return lane[filter]; }
  double operator[](int filter) const { return lane[filter]; }
};
/// Of each filter yes or no: yes where it is negative.
struct alignas(kAlignment) FilterMask {
  std::int64_t lane[kBlock];

  bool operator[](int filter) const { return lane[filter] < 0; }
};
template <int Count>
using FilterVectors = OfFilters[static_cast<std::size_t>(Count)];
template <int Rows, int Cols>
using FilterMatrices = OfFilters[static_cast<std::size_t>(Rows)][static_cast<std::size_t>(Cols)];

/// The longest measurements that updates of N states are compiled for.
constexpr int most_measurements(int states) {
  return states == 2 ? 2 : states == 4 ? 3 : 4;
}

/// x (N), P (N x N).
template <int N>
struct FilterBlock {
  FilterVectors<N> x;
  FilterMatrices<N, N> P;
};

template <int N>
struct TransitionBlock {
  FilterMatrices<N, N> F;
  FilterMatrices<N, N> Q;
};

inline constexpr double kLogTwoPi = 1.8378770664093454836;  // of each component in a log likelihood

/// What an update is told and what it leaves.
template <int N>
struct UpdateBlock {
  FilterVectors<kMaxMeasurements> nu;                    ///< told; of a position its z, which becomes nu
  FilterMatrices<kMaxMeasurements, kMaxMeasurements> R;  ///< told
  FilterMatrices<kMaxMeasurements, N> H;                 ///< told, but of a position
  FilterMatrices<kMaxMeasurements, kMaxMeasurements> S;
  FilterMatrices<N, kMaxMeasurements> K;
  OfFilters nis;
  OfFilters log_likelihood;  ///< of the innovation
  FilterMask has_gain;       ///< S has kept its digits, and the likelihood is finite
};

/// x = F x, P = F P F' + Q, from `filters` to `moved`, which may be the same. `good` where x is finite and P plainly
/// positive definite; where that is not said, it may still be a covariance.
template <int N>
void predict_filters(const TransitionBlock<N>* transitions, int count, const FilterBlock<N>* filters,
                     FilterBlock<N>* moved, FilterMask* good);

/// K, S and the likelihood, and x and P with the measurement, from `filters` to `updated`, which may be the same.
/// kPosition: H = [I, 0]. `good` as of a prediction.
template <int N, int M, bool kPosition>
void update_filters(int count, const FilterBlock<N>* filters, UpdateBlock<N>* updates, FilterBlock<N>* updated,
                    FilterMask* good);

}  // namespace truebearing::kernels
