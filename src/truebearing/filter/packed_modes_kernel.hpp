// SPDX-License-Identifier: Apache-2.0
// The arithmetic of PackedModes: the filters of kLanes modes side by side, one in each lane, as KalmanFilter in Joseph's
// form works on one (covariance_form.hpp) and in the same order, so to the same bits. A last block that is not full
// repeats the last mode.
#pragma once

#include <cstddef>
#include <cstdint>

#include "truebearing/core/simd_lanes.hpp"
#include "truebearing/filter/any_measurement.hpp"

namespace truebearing::kernels {

/// Of each lane all bits or none.
using LaneMask [[gnu::vector_size(kLanes * sizeof(std::int64_t))]] = std::int64_t;

template <int Count>
using LaneVector = Lanes[static_cast<std::size_t>(Count)];
template <int Rows, int Cols>
using LaneMatrix = Lanes[static_cast<std::size_t>(Rows)][static_cast<std::size_t>(Cols)];

/// Where a register of AVX can be loaded from; without AVX the compiler would align for SSE2.
inline constexpr std::size_t kAlignment = kLanes * sizeof(double);

struct alignas(kAlignment) LaneWeights {
  Lanes of_mode;
};
struct alignas(kAlignment) LaneVerdicts {
  LaneMask plainly;  ///< P is positive definite; where that is not said, it may be still
};

/// x (N), P (N x N) of kLanes modes. Lane l of coefficient i stands i kLanes + l doubles from the first.
template <int N>
struct alignas(kAlignment) ModeBlock {
  LaneVector<N> x;
  LaneMatrix<N, N> P;
};

template <int N>
struct alignas(kAlignment) TransitionBlock {
  LaneMatrix<N, N> F;
  LaneMatrix<N, N> Q;
};

/// What an update is told, nu (m) and, unless the first m components are measured, H (m x n); and what it leaves.
template <int N>
struct alignas(kAlignment) UpdateBlock {
  LaneVector<kMaxMeasurements> nu;
  LaneMatrix<kMaxMeasurements, N> H;
  LaneMatrix<kMaxMeasurements, kMaxMeasurements> S;
  LaneMatrix<N, kMaxMeasurements> K;
  Lanes nis;
  Lanes determinant;  ///< of S
  LaneMask has_gain;  ///< S has kept its digits
};

/// The mixtures that the modes begin with: weights[i blocks + b], of mode i in those of block b. Equations (11.6.6-8) to
/// (-10) of Bar-Shalom, Li and Kirubarajan 2001.
template <int N>
void mix_modes(const ModeBlock<N>* modes, int count, const LaneWeights* weights, int blocks, ModeBlock<N>* mixed);

/// x = F x, P = F P F' + Q.
template <int N>
void predict_modes(const TransitionBlock<N>* transitions, int blocks, ModeBlock<N>* modes, LaneVerdicts* verdicts);

/// K, NIS and |S|, x and P with the measurement: R (M x M) by columns; H = [I, 0] where kPosition.
template <int N, int M, bool kPosition>
void update_modes(const double* R, int blocks, ModeBlock<N>* modes, UpdateBlock<N>* updates, LaneVerdicts* verdicts);

/// Mean and covariance (n x n, by columns) of the mixture of all lanes by `weights`, zero in those that repeat.
template <int N>
void mix_to_one(const ModeBlock<N>* modes, const LaneWeights* weights, int blocks, double* x, double* P);

}  // namespace truebearing::kernels
