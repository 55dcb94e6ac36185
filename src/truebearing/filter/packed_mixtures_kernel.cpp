// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/packed_mixtures_kernel.hpp"

#include "truebearing/filter/packed_registers.hpp"

namespace truebearing::kernels {
namespace {

template <int N>
struct Mixing {
  // Coefficient i of mode m stands i kBlock further: x, then P by rows.
  [[gnu::always_inline]] static const double* of_mode(const FilterBlock<N>* modes, int m) {
    return modes[m / kBlock].x[0].lane + m % kBlock;
  }

  template <int kWidth>
  [[gnu::always_inline]] static inline void mix_loops(const FilterBlock<N>* modes, int count, const OfFilters* weights,
                                                      FilterBlock<N>* mixed) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    if constexpr (kWidth > 4)
      if (lanes_of(count) <= 4) return mix_loops<4>(modes, count, weights, mixed);
    const int blocks = blocks_of(count);
    for (int first = 0; first < count; first += kWidth) {
      List<Doubles, N> mean;
      Table<Doubles, N, N> P;
      Doubles weight;
      for (int i = 0; i < N; ++i) {
        mean[i] = Doubles{};
        for (int j = 0; j <= i; ++j) P[i][j] = Doubles{};
      }
      for (int m = 0; m < count; ++m) {
        Some::load(weights[m * blocks + first / kBlock], first, weight);
        const double* x = of_mode(modes, m);
        for (int i = 0; i < N; ++i) mean[i] += weight * x[i * kBlock];
      }
      for (int m = 0; m < count; ++m) {
        Some::load(weights[m * blocks + first / kBlock], first, weight);
        const double* x = of_mode(modes, m);
        List<Doubles, N> d;
        for (int i = 0; i < N; ++i) d[i] = x[i * kBlock] - mean[i];
        for (int i = 0; i < N; ++i)
          for (int j = 0; j <= i; ++j) P[i][j] += weight * (x[(N + i * N + j) * kBlock] + d[i] * d[j]);
      }
      Some::store(mean, P, first, mixed[first / kBlock]);
    }
  }
  TRUEBEARING_FOR_WIDEST(mix, (const FilterBlock<N>* modes, int count, const OfFilters* weights, FilterBlock<N>* mixed),
                         (modes, count, weights, mixed))
};

// Of the mixture of what blocks hold as a vector of so many components and as its covariance: mean and covariance.
template <typename Block, auto kVector, auto kMatrix, int kLength>
struct Moments {
  template <int kWidth>
  [[gnu::always_inline]] static inline void find_loops(const Block* blocks, int count, const OfFilters* weights,
                                                       double* mean, double* covariance) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    if constexpr (kWidth > 4)
      if (lanes_of(count) <= 4) return find_loops<4>(blocks, count, weights, mean, covariance);
    List<typename Some::Total, kLength> means;
    Table<typename Some::Total, kLength, kLength> squares;
    for (int first = 0; first < count; first += kWidth) {
      Doubles weight, value;
      Some::load(weights[first / kBlock], first, weight);
      for (int i = 0; i < kLength; ++i) {
        Some::load((blocks[first / kBlock].*kVector)[i], first, value);
        means[i].add(first, weight * value);
      }
    }
    for (int i = 0; i < kLength; ++i) mean[i] = means[i].sum();
    for (int first = 0; first < count; first += kWidth) {
      Doubles weight, value;
      List<Doubles, kLength> d;
      Some::load(weights[first / kBlock], first, weight);
      for (int i = 0; i < kLength; ++i) {
        Some::load((blocks[first / kBlock].*kVector)[i], first, d[i]);
        d[i] -= mean[i];
      }
      for (int i = 0; i < kLength; ++i)
        for (int j = 0; j <= i; ++j) {
          Some::load((blocks[first / kBlock].*kMatrix)[i][j], first, value);
          squares[i][j].add(first, weight * (value + d[i] * d[j]));
        }
    }
    for (int i = 0; i < kLength; ++i)
      for (int j = 0; j <= i; ++j) covariance[i + j * kLength] = covariance[j + i * kLength] = squares[i][j].sum();
  }
  TRUEBEARING_FOR_WIDEST(find,
                         (const Block* blocks, int count, const OfFilters* weights, double* mean, double* covariance),
                         (blocks, count, weights, mean, covariance))
};

template <int N, int M>
struct Combining {
  template <int kWidth>
  [[gnu::always_inline]] static inline void gains_loops(const UpdateBlock<N>* updates, int count,
                                                        const OfFilters* weights, double* K) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    if constexpr (kWidth > 4)
      if (lanes_of(count) <= 4) return gains_loops<4>(updates, count, weights, K);
    Table<typename Some::Total, N, M> totals;
    for (int first = 0; first < count; first += kWidth) {
      Doubles weight, value;
      Some::load(weights[first / kBlock], first, weight);
      for (int i = 0; i < N; ++i)
        for (int m = 0; m < M; ++m) {
          Some::load(updates[first / kBlock].K[i][m], first, value);
          totals[i][m].add(first, weight * value);
        }
    }
    for (int i = 0; i < N; ++i)
      for (int m = 0; m < M; ++m) K[i + m * N] = totals[i][m].sum();
  }
  TRUEBEARING_FOR_WIDEST(gains, (const UpdateBlock<N>* updates, int count, const OfFilters* weights, double* K),
                         (updates, count, weights, K))
};

}  // namespace

template <int N>
void mix_modes(const FilterBlock<N>* modes, int count, const OfFilters* weights, FilterBlock<N>* mixed) {
  Mixing<N>().mix(modes, count, weights, mixed);
}

template <int N>
void mix_to_one(const FilterBlock<N>* modes, int count, const OfFilters* weights, double* x, double* P) {
  Moments<FilterBlock<N>, &FilterBlock<N>::x, &FilterBlock<N>::P, N>().find(modes, count, weights, x, P);
}

template <int N, int M>
void mix_innovations(const UpdateBlock<N>* updates, int count, const OfFilters* weights, double* nu, double* S) {
  Moments<UpdateBlock<N>, &UpdateBlock<N>::nu, &UpdateBlock<N>::S, M>().find(updates, count, weights, nu, S);
}

template <int N, int M>
void mix_gains(const UpdateBlock<N>* updates, int count, const OfFilters* weights, double* K) {
  Combining<N, M>().gains(updates, count, weights, K);
}

#define TRUEBEARING_PACKED_INNOVATIONS(N, M)                                                           \
  template void mix_innovations<N, M>(const UpdateBlock<N>*, int, const OfFilters*, double*, double*); \
  template void mix_gains<N, M>(const UpdateBlock<N>*, int, const OfFilters*, double*)
#define TRUEBEARING_PACKED_MIXTURES(N)                                                         \
  template void mix_modes<N>(const FilterBlock<N>*, int, const OfFilters*, FilterBlock<N>*);   \
  template void mix_to_one<N>(const FilterBlock<N>*, int, const OfFilters*, double*, double*); \
  TRUEBEARING_PACKED_INNOVATIONS(N, 1)
TRUEBEARING_PACKED_MIXTURES(2);
TRUEBEARING_PACKED_INNOVATIONS(2, 2);
TRUEBEARING_PACKED_MIXTURES(4);
TRUEBEARING_PACKED_INNOVATIONS(4, 2);
TRUEBEARING_PACKED_INNOVATIONS(4, 3);
TRUEBEARING_PACKED_MIXTURES(6);
TRUEBEARING_PACKED_INNOVATIONS(6, 2);
TRUEBEARING_PACKED_INNOVATIONS(6, 3);
TRUEBEARING_PACKED_INNOVATIONS(6, 4);

}  // namespace truebearing::kernels
