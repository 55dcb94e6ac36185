// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/angle_likelihood_kernels.hpp"

#include <cmath>
#include <cstddef>

#include "truebearing/array/column_product.hpp"
#include "truebearing/core/simd_lanes.hpp"
#include "truebearing/core/simd_dispatch.hpp"
#include "truebearing/core/simd_width.hpp"
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
#pragma GCC unroll 8
  for (std::size_t c = 0; c < kColumns; ++c) {
    const int n = first + int(c);
    Lanes of_w{}, of_v{}, of_a{};
    for (int m = n * rows; m < (n + 1) * rows; m += kLanes) {
      Lanes rw, w, v, a;
      load(p.RW + m, rw);
      load(p.W + m, w);
      load(p.V + m, v);
      load(p.A + m, a);
      of_w += w * rw;
      of_v += v * rw;
      of_a += a * rw;
    }
    p.W_RW[n] = sum(of_w);
    p.V_RW[n] = sum(of_v);
    p.A_RW[n] = sum(of_a);
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

[[gnu::always_inline]] inline void coupling_of(int N, const Coupling& s) {
  double* __restrict L = s.L;  // sigma^2 P^-1 + A'A = L L', with the inverse of its diagonal in place of that
  double* __restrict C = s.C;
  *s.is_positive_definite = false;
  for (int k = 0; k < N * N; ++k) L[k] = s.AA[k];
  double det = 1.0;
  for (int j = 0; j < N; ++j) L[j * N + j] += s.noise / s.p[j];
  for (int j = 0; j < N; ++j) {
    double* L_j = L + j * N;
    if (!(L_j[j] > 0.0)) return;
    det *= L_j[j];
    const double inverse = 1.0 / std::sqrt(L_j[j]);
    for (int i = j; i < N; ++i) L_j[i] *= inverse;
    L_j[j] = inverse;
    for (int k = j + 1; k < N; ++k) {
      const double factor = L_j[k];
      for (int i = k; i < N; ++i) L[k * N + i] -= L_j[i] * factor;
    }
  }
  *s.is_positive_definite = true;
  *s.log_det = std::log(det);
  // C is X' first, X = L^-1, so that inner loops run down columns.
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) C[j * N + i] = i == j ? 1.0 : 0.0;
  for (int i = 0; i < N; ++i) {
    double* C_i = C + i * N;
    for (int k = 0; k < i; ++k) {
      const double factor = L[k * N + i];
#pragma omp simd
      for (int j = 0; j < N; ++j) C_i[j] -= factor * C[k * N + j];
    }
    const double inverse = L[i * N + i];
#pragma omp simd
    for (int j = 0; j < N; ++j) C_i[j] *= inverse;
  }
  for (int j = 0; j < N; ++j) {  // C = X' X, in the place of L
    double* __restrict out = L + j * N;
    for (int i = 0; i < N; ++i) out[i] = 0.0;
    for (int k = j; k < N; ++k) {
      const double factor = C[k * N + j];
#pragma omp simd
      for (int i = 0; i < N; ++i) out[i] += C[k * N + i] * factor;
    }
  }
  for (int k = 0; k < N * N; ++k) C[k] = L[k];
}
template <int kWidth>
[[gnu::always_inline]] inline void coupling_loops(const Coupling& s) {
  with_count(
      s.N, [&](auto known) __attribute__((always_inline)) { coupling_of(known > 0 ? int(known) : s.N, s); });
}

template <int kWidth>
[[gnu::always_inline]] inline void inner_of(int N, const Inner& s) {
  using Vector = VectorOf<kWidth>;
  for (int j = 0; j < N; ++j) {
    const double *C_j = s.C + j * N, inverse_p = 1.0 / s.p[j];
    double *K = s.K + j * N, *E = s.E + j * N;
    for (int i = 0; i < N; ++i) K[i] = C_j[i] * inverse_p;
    double da[kMostSignals];  // row j of D'A
    for (int k = 0; k < N; ++k) da[k] = s.DA[k * N + j];
    multiply<kWidth>(N, 0, N, s.C, N, da, E);
    multiply<kWidth>(N, 0, N, s.AA, N, K, s.aRa + j * N);
    for (int i = 0; i < N; i += kWidth) {
      typename Vector::Doubles dRa{}, dRd, a;
      Vector::load(s.DD + j * N + i, dRd);
      for (int k = 0; k < N; ++k) {
        Vector::load(s.DA + k * N + i, a);
        dRa += a * K[k];
        dRd -= a * E[k];
      }
      Vector::store(dRa, s.dRa + j * N + i);
      Vector::store(dRd * s.inverse_noise, s.dRd + j * N + i);
    }
  }
}
template <int kWidth>
[[gnu::always_inline]] inline void inner_loops(const Inner& s) {
  with_count(
      s.N, [&](auto known) __attribute__((always_inline)) { inner_of<kWidth>(known > 0 ? int(known) : s.N, s); });
}

}  // namespace

TRUEBEARING_FOR_AVX2(grams, (const Grams& g), (g))
TRUEBEARING_FOR_AVX2(products, (const Products& p), (p))
TRUEBEARING_FOR_WIDEST(coupling, (const Coupling& s), (s))
TRUEBEARING_FOR_WIDEST(inner, (const Inner& s), (s))

}  // namespace truebearing::kernels
