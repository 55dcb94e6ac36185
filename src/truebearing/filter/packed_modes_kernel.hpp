// SPDX-License-Identifier: Apache-2.0
// The arithmetic of PackedModes: the filters of eight modes side by side, each in a lane of its own, as KalmanFilter in
// Joseph's form works on one (covariance_form.hpp) and in the same order, so to the same bits, whether a register holds
// two, four or eight of them. Lanes behind the last mode that are in a register with it repeat it; nothing
// reads them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "truebearing/filter/any_measurement.hpp"

namespace truebearing::kernels {

inline constexpr int kBlock = 8;  // modes
constexpr int blocks_of(int modes) {
  return (modes + kBlock - 1) / kBlock;
}
/// Where a register of AVX-512 can be loaded from.
inline constexpr std::size_t kAlignment = kBlock * sizeof(double);

/// One number of each mode.
struct alignas(kAlignment) OfModes {
  double lane[kBlock];

  double& operator[](int mode) { return lane[mode]; }
  double operator[](int mode) const { return lane[mode]; }
};
/// Of each mode yes or no: yes where it is negative.
struct alignas(kAlignment) ModeMask {
  std::int64_t lane[kBlock];

  bool operator[](int mode) const { return lane[mode] < 0; }
};
template <int Count>
using ModeVectors = OfModes[static_cast<std::size_t>(Count)];
template <int Rows, int Cols>
using ModeMatrices = OfModes[static_cast<std::size_t>(Rows)][static_cast<std::size_t>(Cols)];

/// x (N), P (N x N).
template <int N>
struct ModeBlock {
  ModeVectors<N> x;
  ModeMatrices<N, N> P;
};

template <int N>
struct TransitionBlock {
  ModeMatrices<N, N> F;
  ModeMatrices<N, N> Q;
};

/// What an update is told and what it leaves.
template <int N>
struct UpdateBlock {
  ModeVectors<kMaxMeasurements> nu;     ///< told, but of a position
  ModeMatrices<kMaxMeasurements, N> H;  ///< told, but of a position
  ModeMatrices<kMaxMeasurements, kMaxMeasurements> S;
  ModeMatrices<N, kMaxMeasurements> K;
  OfModes log_likelihood;  ///< of the innovation
  ModeMask has_gain;       ///< S has kept its digits, and the likelihood is finite
};

/// The mixtures that the modes begin with: weights[i blocks + b], of mode i in those of block b. Equations (11.6.6-8)
/// to (-10) of Bar-Shalom, Li and Kirubarajan 2001.
template <int N>
void mix_modes(const ModeBlock<N>* modes, int count, const OfModes* weights, ModeBlock<N>* mixed);

/// x = F x, P = F P F' + Q. `good` where x is finite and P plainly positive definite; where that is not said, it may
/// still be a covariance.
template <int N>
void predict_modes(const TransitionBlock<N>* transitions, int count, ModeBlock<N>* modes, ModeMask* good);

/// K, S and the likelihood, and x and P with the measurement, from `modes` to `updated`: R (M x M) by columns. z (M) of
/// a position, H = [I, 0]; otherwise nu and H are told. `good` as of a prediction.
template <int N, int M, bool kPosition>
void update_modes(const double* z, const double* R, int count, const ModeBlock<N>* modes, UpdateBlock<N>* updates,
                  ModeBlock<N>* updated, ModeMask* good);

/// Mean and covariance (n x n, by columns) of the mixture of all modes by `weights`, zero in those that repeat.
template <int N>
void mix_to_one(const ModeBlock<N>* modes, int count, const OfModes* weights, double* x, double* P);

/// nu (M) and S (M x M) of the mixture of what the modes expected, and their weighted K (N x M). What a mode without a
/// weight expected must be finite too.
template <int N, int M>
void mix_innovations(const UpdateBlock<N>* updates, int count, const OfModes* weights, double* nu, double* S);
template <int N, int M>
void mix_gains(const UpdateBlock<N>* updates, int count, const OfModes* weights, double* K);

}  // namespace truebearing::kernels
