// SPDX-License-Identifier: Apache-2.0
// Kalman filters side by side as data: eight to a block, each in a lane of its own, one number of all eight after the
// other. What kernels (packed_filters_kernel.hpp) work on, and how one filter is put into its lane and read from there.
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "truebearing/filter/any_measurement.hpp"
#include "truebearing/filter/lane_mask.hpp"

namespace truebearing::kernels {

inline constexpr int kBlock = kPackLanes;  // filters
constexpr int blocks_of(int filters) {
  return (filters + kBlock - 1) / kBlock;
}
/// The lanes that kernels work on where so many filters stand side by side: those of a short register where one holds
/// all, else those of whole blocks.
constexpr int lanes_of(int filters) {
  constexpr int kShort = 4;
  return filters <= kShort ? kShort : kBlock * blocks_of(filters);
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
  void set(int filter, bool yes) { lane[filter] = yes ? -1 : 0; }
  /// Yes where both are.
  FilterMask& operator&=(const FilterMask& other) {
    for (int i = 0; i < kBlock; ++i) lane[i] &= other.lane[i];
    return *this;
  }
  /// Those that are a yes.
  LaneMask lanes() const {
    unsigned yes = 0;
    for (int i = 0; i < kBlock; ++i) yes |= static_cast<unsigned>(lane[i] < 0) << i;
    return static_cast<LaneMask>(yes);
  }
};
template <int Count>
using FilterVectors = OfFilters[static_cast<std::size_t>(Count)];
template <int Rows, int Cols>
using FilterMatrices = OfFilters[static_cast<std::size_t>(Rows)][static_cast<std::size_t>(Cols)];

// One filter's vector or matrix, which may be shorter than what there is room for.
template <typename Vector>
void set_lane(const Vector& v, int lane, OfFilters* to) {
  for (Eigen::Index i = 0; i < v.size(); ++i) to[i][lane] = v(i);
}
template <typename Matrix, std::size_t Width>
void set_lane(const Matrix& A, int lane, OfFilters (*to)[Width]) {
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    for (Eigen::Index j = 0; j < A.cols(); ++j) to[i][j][lane] = A(i, j);
}
template <typename Vector>
void read_lane(const OfFilters* from, int lane, Vector& v) {
  for (Eigen::Index i = 0; i < v.size(); ++i) v(i) = from[i][lane];
}
template <typename Matrix, std::size_t Width>
void read_lane(const OfFilters (*from)[Width], int lane, Matrix& A) {
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    for (Eigen::Index j = 0; j < A.cols(); ++j) A(i, j) = from[i][j][lane];
}

/// x (N), P (N x N).
template <int N>
struct FilterBlock {
  using State = Eigen::Matrix<double, N, 1>;
  using Covariance = Eigen::Matrix<double, N, N>;

  FilterVectors<N> x;
  FilterMatrices<N, N> P;

  void set(int lane, const State& own_x, const Covariance& own_P) {
    set_lane(own_x, lane, x);
    set_lane(own_P, lane, P);
  }
  State x_of(int lane) const {
    State own;
    read_lane(x, lane, own);
    return own;
  }
  Covariance P_of(int lane) const {
    Covariance own;
    read_lane(P, lane, own);
    return own;
  }
  /// The lane becomes what it is in `other`.
  void copy(int lane, const FilterBlock& other) { set(lane, other.x_of(lane), other.P_of(lane)); }
};

template <int N>
struct TransitionBlock {
  FilterMatrices<N, N> F;
  FilterMatrices<N, N> Q;

  void set(int lane, const Eigen::Matrix<double, N, N>& own_F, const Eigen::Matrix<double, N, N>& own_Q) {
    set_lane(own_F, lane, F);
    set_lane(own_Q, lane, Q);
  }
};

/// The longest measurements that updates of N states are compiled for.
constexpr int most_measurements(int states) {
  return states == 2 ? 2 : states == 4 ? 3 : 4;
}

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

  /// Of measurements of M components all lanes are told what they are in `other`: R, and z of positions.
  template <int M>
  void tell_as(const UpdateBlock& other, bool of_position) {
    for (int m = 0; m < M; ++m) {
      if (of_position) nu[m] = other.nu[m];
      for (int l = 0; l < M; ++l) R[m][l] = other.R[m][l];
    }
  }
};

// Of many filters in a row: filter i stands in lane lane_of(i) of the block that block_of() gives.
constexpr int lane_of(std::integral auto filter) {
  return static_cast<int>(filter) % kBlock;
}
template <typename Block>
Block& block_of(std::vector<Block>& blocks, std::integral auto filter) {
  return blocks[static_cast<std::size_t>(filter) / kBlock];
}
template <typename Block>
const Block& block_of(const std::vector<Block>& blocks, std::integral auto filter) {
  return blocks[static_cast<std::size_t>(filter) / kBlock];
}

}  // namespace truebearing::kernels
