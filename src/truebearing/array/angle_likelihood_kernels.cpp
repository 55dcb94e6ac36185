// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/angle_likelihood_kernels.hpp"

#include <cstddef>

#include "truebearing/core/simd_lanes.hpp"
#include "truebearing/core/simd_dispatch.hpp"
#include "truebearing/core/with_count.hpp"

namespace truebearing::kernels {
namespace {

// Columns i .. i + kColumns - 1 with column j.
template <std::size_t kColumns>
[[gnu::always_inline]] inline void grams_of(const Grams& g, int i, int j) {
  Lanes AA[kColumns] = {}, DA[kColumns] = {}, DD[kColumns] = {}, a_i, d_i, a_j, d_j;
  for (int m = 0; m < g.rows; m += kLanes) {
    load(g.A + j * g.rows + m, a_j);
    load(g.D + j * g.rows + m, d_j);
#pragma GCC unroll 8
    for (std::size_t c = 0; c < kColumns; ++c) {
      load(g.A + (i + int(c)) * g.rows + m, a_i);
      load(g.D + (i + int(c)) * g.rows + m, d_i);
      AA[c] += a_i * a_j;
      DA[c] += d_i * a_j;
      DD[c] += d_i * d_j;
    }
  }
#pragma GCC unroll 8
  for (std::size_t c = 0; c < kColumns; ++c) {
    const int at = j * g.N + i + int(c);
    g.AA[at] = sum(AA[c]);
    g.DA[at] = sum(DA[c]);
    g.DD[at] = sum(DD[c]);
  }
}
[[gnu::always_inline]] inline void grams_loops(const Grams& g) {
  constexpr int kTogether = 3;  // as many as there are registers for
  for (int j = 0; j < g.N; ++j) {
    int i = 0;
    for (; i + kTogether <= g.N; i += kTogether) grams_of<kTogether>(g, i, j);
    for (; i < g.N; ++i) grams_of<1>(g, i, j);
  }
}

template <std::size_t kColumns>
[[gnu::always_inline]] inline void products_of(const Products& p, int first) {
  const int rows = p.rows, N = p.N;
  for (int m = 0; m < rows; m += kLanes) {
    Lanes w[kColumns] = {}, v[kColumns], a;
#pragma GCC unroll 8
    for (std::size_t c = 0; c < kColumns; ++c) load(p.D + (first + int(c)) * rows + m, v[c]);
    for (int i = 0; i < N; ++i) {
      load(p.A + i * rows + m, a);
#pragma GCC unroll 8
      for (std::size_t c = 0; c < kColumns; ++c) {
        w[c] += a * p.K[(first + int(c)) * N + i];
        v[c] -= a * p.E[(first + int(c)) * N + i];
      }
    }
#pragma GCC unroll 8
    for (std::size_t c = 0; c < kColumns; ++c) {
      store(w[c], p.W + (first + int(c)) * rows + m);
      store(v[c] * p.inverse_noise, p.V + (first + int(c)) * rows + m);
    }
  }
  for (int m = 0; m < rows; m += kLanes) {
    Lanes rw[kColumns] = {}, r;
    for (int i = 0; i < rows; ++i) {
      load(p.R + i * rows + m, r);
#pragma GCC unroll 8
      for (std::size_t c = 0; c < kColumns; ++c) rw[c] += r * p.W[(first + int(c)) * rows + i];
    }
#pragma GCC unroll 8
    for (std::size_t c = 0; c < kColumns; ++c) store(rw[c], p.RW + (first + int(c)) * rows + m);
  }
}
[[gnu::always_inline]] inline void products_loops(const Products& p) {
  with_count(
      p.N, [&](auto known) __attribute__((always_inline)) {
        if constexpr (known > 0)
          products_of<std::size_t(known)>(p, 0);
        else
          for (int n = 0; n < p.N; ++n) products_of<1>(p, n);
      });
}

[[gnu::always_inline]] inline void inner_of(int N, const Inner& s) {
  for (int j = 0; j < N; ++j) {
    double *K = s.K + j * N, *E = s.E + j * N, *aRa = s.aRa + j * N, *dRa = s.dRa + j * N, *dRd = s.dRd + j * N;
    const double inverse_p = 1.0 / s.p[j];
    for (int i = 0; i < N; ++i) {
      K[i] = s.C[j * N + i] * inverse_p;
      E[i] = aRa[i] = dRa[i] = 0.0;
      dRd[i] = s.DD[j * N + i];
    }
    for (int k = 0; k < N; ++k) {
      const double da = s.DA[k * N + j];
#pragma omp simd
      for (int i = 0; i < N; ++i) E[i] += s.C[k * N + i] * da;
    }
    for (int k = 0; k < N; ++k) {
      const double K_k = K[k], E_k = E[k];
#pragma omp simd
      for (int i = 0; i < N; ++i) {
        aRa[i] += s.AA[k * N + i] * K_k;
        dRa[i] += s.DA[k * N + i] * K_k;
        dRd[i] -= s.DA[k * N + i] * E_k;
      }
    }
    for (int i = 0; i < N; ++i) dRd[i] *= s.inverse_noise;
  }
}
[[gnu::always_inline]] inline void inner_loops(const Inner& s) {
  with_count(
      s.N, [&](auto known) __attribute__((always_inline)) { inner_of(known > 0 ? int(known) : s.N, s); });
}

}  // namespace

TRUEBEARING_FOR_AVX2(grams, (const Grams& g), (g))
TRUEBEARING_FOR_AVX2(products, (const Products& p), (p))
TRUEBEARING_FOR_AVX2(inner, (const Inner& s), (s))

}  // namespace truebearing::kernels
