// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/past_kernel.hpp"

#include <cstddef>

#include "truebearing/core/simd_lanes.hpp"
#include "truebearing/core/simd_dispatch.hpp"
#include "truebearing/core/with_count.hpp"

namespace truebearing::kernels {
namespace {

// Of columns first .. first + kColumns - 1: y = W^H x
template <std::size_t kColumns>
[[gnu::always_inline]] inline void project(const Past& s, int first, const double* x_re, const double* x_im) {
  Lanes y_re[kColumns] = {}, y_im[kColumns] = {};
  for (int m = 0; m < s.rows; m += kLanes) {
    Lanes re, im, w_re, w_im;
    load(x_re + m, re);
    load(x_im + m, im);
#pragma GCC unroll 8
    for (int n = 0; n < int(kColumns); ++n) {
      load(s.W_re + (first + n) * s.rows + m, w_re);
      load(s.W_im + (first + n) * s.rows + m, w_im);
      y_re[n] += w_re * re;
      y_re[n] += w_im * im;
      y_im[n] += w_re * im;
      y_im[n] -= w_im * re;
    }
  }
#pragma GCC unroll 8
  for (int n = 0; n < int(kColumns); ++n) {
    s.y_re[first + n] = sum(y_re[n]);
    s.y_im[first + n] = sum(y_im[n]);
  }
}

// One snapshot. kColumns: of W where that is known beforehand, so that a group of its rows stays in registers; else 0.
template <std::size_t kColumns>
[[gnu::always_inline]] inline void step(const Past& s, const double* x_re, const double* x_im) {
  const int M = s.rows, N = kColumns > 0 ? int(kColumns) : s.columns;
  if constexpr (kColumns > 0)
    project<kColumns>(s, 0, x_re, x_im);
  else
    for (int n = 0; n < N; ++n) project<1>(s, n, x_re, x_im);
  const int padded = padded_to_lanes(N);
#pragma GCC unroll 2
  for (int i = 0; i < padded; i += kLanes) {  // h = P y
    Lanes h_re = {}, h_im = {}, re, im;
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) {
      load(s.P_re + j * padded + i, re);
      load(s.P_im + j * padded + i, im);
      h_re += re * s.y_re[j];
      h_re -= im * s.y_im[j];
      h_im += re * s.y_im[j];
      h_im += im * s.y_re[j];
    }
    store(h_re, s.h_re + i);
    store(h_im, s.h_im + i);
  }
  double power = s.beta;  // beta + y^H h, real as P is Hermitian
  for (int n = 0; n < N; ++n) power += s.y_re[n] * s.h_re[n] + s.y_im[n] * s.h_im[n];
  const double inverse = 1.0 / power, forget = 1.0 / s.beta;
#pragma GCC unroll 2
  for (int i = 0; i < padded; i += kLanes) {
    Lanes h_re, h_im;
    load(s.h_re + i, h_re);
    load(s.h_im + i, h_im);
    store(h_re * inverse, s.g_re + i);
    store(h_im * inverse, s.g_im + i);
  }

  for (int m = 0; m < M; m += kLanes) {
    constexpr std::size_t kKept = kColumns > 0 ? kColumns : 1;
    Lanes w_re[kKept], w_im[kKept], e_re, e_im;
    load(x_re + m, e_re);
    load(x_im + m, e_im);
#pragma GCC unroll 8
    for (int n = 0; n < N; ++n) {  // e = x - W y
      Lanes &re = w_re[std::size_t(n) % kKept], &im = w_im[std::size_t(n) % kKept];
      load(s.W_re + n * M + m, re);
      load(s.W_im + n * M + m, im);
      e_re -= re * s.y_re[n];
      e_re += im * s.y_im[n];
      e_im -= re * s.y_im[n];
      e_im -= im * s.y_re[n];
    }
#pragma GCC unroll 8
    for (int n = 0; n < N; ++n) {  // W = W + e g^H
      Lanes &re = w_re[std::size_t(n) % kKept], &im = w_im[std::size_t(n) % kKept];
      if constexpr (kColumns == 0) {
        load(s.W_re + n * M + m, re);
        load(s.W_im + n * M + m, im);
      }
      re += e_re * s.g_re[n];
      re += e_im * s.g_im[n];
      im += e_im * s.g_re[n];
      im -= e_re * s.g_im[n];
      store(re, s.W_re + n * M + m);
      store(im, s.W_im + n * M + m);
    }
  }
#pragma GCC unroll 2
  for (int i = 0; i < padded; i += kLanes) {  // P = Tri{P - g h^H} / beta
    Lanes h_re, h_im, re, im;
    load(s.h_re + i, h_re);
    load(s.h_im + i, h_im);
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) {
      load(s.P_re + j * padded + i, re);
      load(s.P_im + j * padded + i, im);
      re -= h_re * s.g_re[j];
      re -= h_im * s.g_im[j];
      im -= h_im * s.g_re[j];
      im += h_re * s.g_im[j];
      store(forget * re, s.P_re + j * padded + i);
      store(forget * im, s.P_im + j * padded + i);
    }
  }
#pragma GCC unroll 8
  for (int j = 0; j < N; ++j) {
#pragma GCC unroll 8
    for (int i = 0; i < j; ++i) {
      s.P_re[j * padded + i] = s.P_re[i * padded + j];
      s.P_im[j * padded + i] = -s.P_im[i * padded + j];
    }
    s.P_im[j * padded + j] = 0.0;
  }
}
[[gnu::always_inline]] inline void past_loops(const Past& s) {
  with_count(
      s.columns, [&](auto known) __attribute__((always_inline)) {
        for (int t = 0; t < s.snapshots; ++t) step<std::size_t(known)>(s, s.x_re + t * s.rows, s.x_im + t * s.rows);
      });
}

}  // namespace

TRUEBEARING_FOR_AVX2(past, (const Past& s), (s))

}  // namespace truebearing::kernels
