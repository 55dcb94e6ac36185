// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/multiple_models_kernel.hpp"

#include <limits>

#include "truebearing/core/bounded.hpp"
#include "truebearing/filter/packed_registers.hpp"

namespace truebearing::kernels {
namespace {

// One number of each of r >= 2 modes of kWidth models, and their sum, in the order of TotalOf.
template <int kWidth>
struct OfModes {
  using Doubles = typename Registers<kWidth>::Doubles;

  List<Doubles, kMaxModes> mode;

  [[gnu::always_inline]] OfModes() { mode[0] = mode[1] = Doubles{}; }
  [[gnu::always_inline]] void sum(int r, Doubles& total) {
    for (int j = kBlock; j < r; ++j) mode[j - kBlock] += mode[j];
    for (int j = 4; j < r && j < kBlock; ++j) mode[j - 4] += mode[j];
    Doubles even = mode[0], odd = mode[1];
    if (r > 2) even += mode[2];
    if (r > 3) odd += mode[3];
    total = even + odd;
  }
};

// Of the mixtures of what the modes hold as a vector of so many components and as its covariance: mean and covariance.
template <typename Block, auto kVector, auto kMatrix, int kLength, int kWidth>
[[gnu::always_inline]] inline void mix_to_one(
    const Block* modes, int r, const OfModes<kWidth>& share, int first,
    List<typename Registers<kWidth>::Doubles, kLength>& mean,
    Table<typename Registers<kWidth>::Doubles, kLength, kLength>& covariance) {
  using Some = Registers<kWidth>;
  using Doubles = typename Some::Doubles;
  OfModes<kWidth> terms;
  Doubles value, other;
  for (int i = 0; i < kLength; ++i) {
    for (int j = 0; j < r; ++j) {
      Some::load((modes[j].*kVector)[i], first, value);
      terms.mode[j] = share.mode[j] * value;
    }
    terms.sum(r, mean[i]);
  }
  for (int i = 0; i < kLength; ++i)
    for (int k = 0; k <= i; ++k) {
      for (int j = 0; j < r; ++j) {
        Some::load((modes[j].*kVector)[i], first, value);
        Some::load((modes[j].*kVector)[k], first, other);
        const Doubles square = (value - mean[i]) * (other - mean[k]);
        Some::load((modes[j].*kMatrix)[i][k], first, value);
        terms.mode[j] = share.mode[j] * (value + square);
      }
      terms.sum(r, covariance[i][k]);
    }
}

struct Entering {
  template <int kWidth>
  [[gnu::always_inline]] static inline void weigh_loops(const OfFilters* Pi, const OfFilters* mu, int r, OfFilters* c,
                                                        OfFilters* weights, FilterMask& good) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    for (int first = 0; first < kBlock; first += kWidth) {
      typename Some::Verdict verdict;
      for (int j = 0; j < r; ++j) {
        List<Doubles, kMaxModes> share;
        Doubles sum{};
        for (int i = 0; i < r; ++i) {
          Doubles from;
          Some::load(Pi[i * r + j], first, share[i]);
          Some::load(mu[i], first, from);
          share[i] *= from;
          sum += share[i];
        }
        Some::store(sum, first, c[j]);
        verdict.is_less(Doubles{}, sum);
        verdict.is_finite(sum);
        for (int i = 0; i < r; ++i) Some::store(share[i] / sum, first, weights[i * r + j]);
      }
      verdict.store(first, good);
    }
  }
  TRUEBEARING_FOR_WIDEST(weigh,
                         (const OfFilters* Pi, const OfFilters* mu, int r, OfFilters* c, OfFilters* weights,
                          FilterMask& good),
                         (Pi, mu, r, c, weights, good))
};

template <int N>
struct MixingModels {
  template <int kWidth>
  [[gnu::always_inline]] static inline void entries_loops(const FilterBlock<N>* modes, int r, const OfFilters* weights,
                                                          FilterBlock<N>* mixed) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    for (int first = 0; first < kBlock; first += kWidth)
      for (int j = 0; j < r; ++j) {
        List<Doubles, N> mean;
        Table<Doubles, N, N> P;
        Doubles weight, value;
        for (int i = 0; i < N; ++i) {
          mean[i] = Doubles{};
          for (int k = 0; k <= i; ++k) P[i][k] = Doubles{};
        }
        for (int m = 0; m < r; ++m) {
          Some::load(weights[m * r + j], first, weight);
          for (int i = 0; i < N; ++i) {
            Some::load(modes[m].x[i], first, value);
            mean[i] += weight * value;
          }
        }
        for (int m = 0; m < r; ++m) {
          Some::load(weights[m * r + j], first, weight);
          List<Doubles, N> d;
          for (int i = 0; i < N; ++i) {
            Some::load(modes[m].x[i], first, d[i]);
            d[i] -= mean[i];
          }
          for (int i = 0; i < N; ++i)
            for (int k = 0; k <= i; ++k) {
              Some::load(modes[m].P[i][k], first, value);
              P[i][k] += weight * (value + d[i] * d[k]);
            }
        }
        Some::store(mean, P, first, mixed[j]);
      }
  }
  TRUEBEARING_FOR_WIDEST(entries, (const FilterBlock<N>* modes, int r, const OfFilters* weights, FilterBlock<N>* mixed),
                         (modes, r, weights, mixed))

  template <int kWidth>
  [[gnu::always_inline]] static inline void models_loops(const FilterBlock<N>* modes, int r, const OfFilters* weights,
                                                         FilterBlock<N>& mixed) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    for (int first = 0; first < kBlock; first += kWidth) {
      OfModes<kWidth> share;
      List<Doubles, N> mean;
      Table<Doubles, N, N> P;
      for (int j = 0; j < r; ++j) Some::load(weights[j], first, share.mode[j]);
      mix_to_one<FilterBlock<N>, &FilterBlock<N>::x, &FilterBlock<N>::P, N>(modes, r, share, first, mean, P);
      Some::store(mean, P, first, mixed);
    }
  }
  TRUEBEARING_FOR_WIDEST(models, (const FilterBlock<N>* modes, int r, const OfFilters* weights, FilterBlock<N>& mixed),
                         (modes, r, weights, mixed))
};

template <int N, int M>
struct CombiningModels {
  template <int kWidth>
  [[gnu::always_inline]] static inline void innovations_loops(const UpdateBlock<N>* updates, int r, const OfFilters* c,
                                                              UpdateBlock<N>& combined) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    for (int first = 0; first < kBlock; first += kWidth) {
      OfModes<kWidth> share;
      List<Doubles, M> nu;
      Table<Doubles, M, M> S;
      Doubles total{};
      for (int j = 0; j < r; ++j) {
        Some::load(c[j], first, share.mode[j]);
        total += share.mode[j];
      }
      for (int j = 0; j < r; ++j) share.mode[j] /= total;
      mix_to_one<UpdateBlock<N>, &UpdateBlock<N>::nu, &UpdateBlock<N>::S, M>(updates, r, share, first, nu, S);
      for (int m = 0; m < M; ++m) {
        Some::store(nu[m], first, combined.nu[m]);
        for (int l = 0; l <= m; ++l) {
          Some::store(S[m][l], first, combined.S[m][l]);
          Some::store(S[m][l], first, combined.S[l][m]);
        }
      }
      Doubles nis{};
      for (int k = 0; k < M; ++k) {  // as mahalanobis_squared() does
        const Doubles pivot = S[k][k] > 0.0 ? S[k][k] : Doubles{} + std::numeric_limits<double>::quiet_NaN();
        const Doubles inverse = 1.0 / pivot;
        nis += nu[k] * nu[k] * inverse;
        for (int i = k + 1; i < M; ++i) {
          const Doubles factor = S[i][k] * inverse;
          nu[i] -= factor * nu[k];
          for (int l = k + 1; l <= i; ++l) S[i][l] -= factor * S[l][k];
        }
      }
      Some::store(nis, first, combined.nis);
    }
  }
  TRUEBEARING_FOR_WIDEST(innovations,
                         (const UpdateBlock<N>* updates, int r, const OfFilters* c, UpdateBlock<N>& combined),
                         (updates, r, c, combined))

  template <int kWidth>
  [[gnu::always_inline]] static inline void gains_loops(const UpdateBlock<N>* updates, int r, const OfFilters* mu,
                                                        UpdateBlock<N>& combined) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    for (int first = 0; first < kBlock; first += kWidth)
      for (int i = 0; i < N; ++i)
        for (int m = 0; m < M; ++m) {
          OfModes<kWidth> terms;
          Doubles value;
          for (int j = 0; j < r; ++j) {
            Some::load(mu[j], first, terms.mode[j]);
            Some::load(updates[j].K[i][m], first, value);
            terms.mode[j] *= value;
          }
          terms.sum(r, value);
          Some::store(value, first, combined.K[i][m]);
        }
  }
  TRUEBEARING_FOR_WIDEST(gains, (const UpdateBlock<N>* updates, int r, const OfFilters* mu, UpdateBlock<N>& combined),
                         (updates, r, mu, combined))
};

template <int N>
struct Weighing {
  template <int kWidth>
  [[gnu::always_inline]] static inline void exponents_loops(const UpdateBlock<N>* updates, int r,
                                                            OfFilters* exponents) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    for (int first = 0; first < kBlock; first += kWidth) {
      Doubles largest, likelihood;
      Some::load(updates[0].log_likelihood, first, largest);
      for (int j = 1; j < r; ++j) {
        Some::load(updates[j].log_likelihood, first, likelihood);
        largest = likelihood > largest ? likelihood : largest;
      }
      for (int j = 0; j < r; ++j) {
        Some::load(updates[j].log_likelihood, first, likelihood);
        Some::store(likelihood - largest, first, exponents[j]);
      }
    }
  }
  TRUEBEARING_FOR_WIDEST(exponents, (const UpdateBlock<N>* updates, int r, OfFilters* exponents),
                         (updates, r, exponents))
};

struct Believing {
  template <int kWidth>
  [[gnu::always_inline]] static inline void believe_loops(const OfFilters* c, const OfFilters* powers, int r,
                                                          OfFilters* mu) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    for (int first = 0; first < kBlock; first += kWidth) {
      List<Doubles, kMaxModes> weight;
      Doubles total{}, power;
      for (int j = 0; j < r; ++j) {
        Some::load(c[j], first, weight[j]);
        Some::load(powers[j], first, power);
        weight[j] *= power;
        total += weight[j];
      }
      for (int j = 0; j < r; ++j) Some::store(weight[j] / total, first, mu[j]);
    }
  }
  TRUEBEARING_FOR_WIDEST(believe, (const OfFilters* c, const OfFilters* powers, int r, OfFilters* mu),
                         (c, powers, r, mu))
};

}  // namespace

void weigh_entries(const OfFilters* Pi, const OfFilters* mu, int r, OfFilters* c, OfFilters* weights,
                   FilterMask& good) {
  Entering().weigh(Pi, mu, r, c, weights, good);
}

template <int N>
void mix_entries(const FilterBlock<N>* modes, int r, const OfFilters* weights, FilterBlock<N>* mixed) {
  MixingModels<N>().entries(modes, r, weights, mixed);
}

template <int N>
void mix_models(const FilterBlock<N>* modes, int r, const OfFilters* weights, FilterBlock<N>& mixed) {
  MixingModels<N>().models(modes, r, weights, mixed);
}

template <int N, int M>
void combine_innovations(const UpdateBlock<N>* updates, int r, const OfFilters* c, UpdateBlock<N>& combined) {
  CombiningModels<N, M>().innovations(updates, r, c, combined);
}

template <int N, int M>
void combine_gains(const UpdateBlock<N>* updates, int r, const OfFilters* mu, UpdateBlock<N>& combined) {
  CombiningModels<N, M>().gains(updates, r, mu, combined);
}

template <int N>
void find_exponents(const UpdateBlock<N>* updates, int r, OfFilters* exponents) {
  Weighing<N>().exponents(updates, r, exponents);
}

void weigh_modes(const OfFilters* c, const OfFilters* powers, int r, OfFilters* mu) {
  Believing().believe(c, powers, r, mu);
}

#define TRUEBEARING_MODELS_MEASURED(N, M)                                                                 \
  template void combine_innovations<N, M>(const UpdateBlock<N>*, int, const OfFilters*, UpdateBlock<N>&); \
  template void combine_gains<N, M>(const UpdateBlock<N>*, int, const OfFilters*, UpdateBlock<N>&)
#define TRUEBEARING_MODELS(N)                                                                  \
  template void mix_entries<N>(const FilterBlock<N>*, int, const OfFilters*, FilterBlock<N>*); \
  template void mix_models<N>(const FilterBlock<N>*, int, const OfFilters*, FilterBlock<N>&);  \
  template void find_exponents<N>(const UpdateBlock<N>*, int, OfFilters*);                     \
  TRUEBEARING_MODELS_MEASURED(N, 1)
TRUEBEARING_MODELS(2);
TRUEBEARING_MODELS_MEASURED(2, 2);
TRUEBEARING_MODELS(4);
TRUEBEARING_MODELS_MEASURED(4, 2);
TRUEBEARING_MODELS_MEASURED(4, 3);
TRUEBEARING_MODELS(6);
TRUEBEARING_MODELS_MEASURED(6, 2);
TRUEBEARING_MODELS_MEASURED(6, 3);
TRUEBEARING_MODELS_MEASURED(6, 4);

}  // namespace truebearing::kernels
