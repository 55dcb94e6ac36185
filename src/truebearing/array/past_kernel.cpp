// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/past_kernel.hpp"

#include <cstddef>

#include "truebearing/core/simd_width.hpp"
#include "truebearing/core/with_count.hpp"

namespace truebearing::kernels {
namespace {

template <int kWidth>
[[gnu::always_inline]] inline double sum_of(const typename VectorOf<kWidth>::Doubles& lanes) {
  if constexpr (kWidth == 8) {
    const VectorOf<4>::Doubles halves =
        __builtin_shufflevector(lanes, lanes, 0, 1, 2, 3) + __builtin_shufflevector(lanes, lanes, 4, 5, 6, 7);
    return sum_of<4>(halves);
  } else {
    return (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
  }
}

// Of columns first .. first + kColumns - 1: y = W^H x
template <int kWidth, std::size_t kColumns>
[[gnu::always_inline]] inline void project(const Past& s, int first, const double* x_re, const double* x_im) {
  using Vector = VectorOf<kWidth>;
  typename Vector::Doubles y_re[kColumns] = {}, y_im[kColumns] = {}, re, im, w_re, w_im;
  for (int m = 0; m < s.rows; m += kWidth) {
    Vector::load(x_re + m, re);
    Vector::load(x_im + m, im);
#pragma GCC unroll 8
    for (int n = 0; n < int(kColumns); ++n) {
      Vector::load(s.W_re + (first + n) * s.rows + m, w_re);
      Vector::load(s.W_im + (first + n) * s.rows + m, w_im);
      y_re[n] += w_re * re;
      y_re[n] += w_im * im;
      y_im[n] += w_re * im;
      y_im[n] -= w_im * re;
    }
  }
#pragma GCC unroll 8
  for (int n = 0; n < int(kColumns); ++n) {
    s.y_re[first + n] = sum_of<kWidth>(y_re[n]);
    s.y_im[first + n] = sum_of<kWidth>(y_im[n]);
  }
}

// One snapshot. kColumns: of W where that is known beforehand, so that a group of its rows stays in registers; else 0.
template <int kWidth, std::size_t kColumns>
[[gnu::always_inline]] inline void step(const Past& s, const double* x_re, const double* x_im) {
  using Vector = VectorOf<kWidth>;
  using Doubles = typename Vector::Doubles;
  const int M = s.rows, N = kColumns > 0 ? int(kColumns) : s.columns, padded = padded_to_widest(N);
  if constexpr (kColumns > 0)
    project<kWidth, kColumns>(s, 0, x_re, x_im);
  else
    for (int n = 0; n < N; ++n) project<kWidth, 1>(s, n, x_re, x_im);
#pragma GCC unroll 4
  for (int i = 0; i < N; i += kWidth) {  // h = P y, in sums that do not wait for each other
    Doubles rere = {}, imim = {}, reim = {}, imre = {}, re, im;
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) {
      Vector::load(s.P_re + j * padded + i, re);
      Vector::load(s.P_im + j * padded + i, im);
      rere += re * s.y_re[j];
      imim += im * s.y_im[j];
      reim += re * s.y_im[j];
      imre += im * s.y_re[j];
    }
    Vector::store(rere - imim, s.h_re + i);
    Vector::store(reim + imre, s.h_im + i);
  }
  double power[2] = {s.beta, 0.0};  // beta + y^H h, real as P is Hermitian
  for (int n = 0; n < N; ++n) power[n % 2] += s.y_re[n] * s.h_re[n] + s.y_im[n] * s.h_im[n];
  const double inverse = 1.0 / (power[0] + power[1]), forget = 1.0 / s.beta;
#pragma GCC unroll 4
  for (int i = 0; i < N; i += kWidth) {
    Doubles h_re, h_im;
    Vector::load(s.h_re + i, h_re);
    Vector::load(s.h_im + i, h_im);
    Vector::store(h_re * inverse, s.g_re + i);
    Vector::store(h_im * inverse, s.g_im + i);
  }

  for (int m = 0; m < M; m += kWidth) {
    constexpr std::size_t kKept = kColumns > 0 ? kColumns : 1;
    Doubles w_re[kKept], w_im[kKept], e_re, e_im, of_im_re{}, of_im_im{};
    Vector::load(x_re + m, e_re);
    Vector::load(x_im + m, e_im);
#pragma GCC unroll 8
    for (int n = 0; n < N; ++n) {  // e = x - W y
      Doubles &re = w_re[std::size_t(n) % kKept], &im = w_im[std::size_t(n) % kKept];
      Vector::load(s.W_re + n * M + m, re);
      Vector::load(s.W_im + n * M + m, im);
      e_re -= re * s.y_re[n];
      of_im_re += im * s.y_im[n];
      e_im -= re * s.y_im[n];
      of_im_im += im * s.y_re[n];
    }
    e_re += of_im_re;
    e_im -= of_im_im;
#pragma GCC unroll 8
    for (int n = 0; n < N; ++n) {  // W = W + e g^H
      Doubles &re = w_re[std::size_t(n) % kKept], &im = w_im[std::size_t(n) % kKept];
      if constexpr (kColumns == 0) {
        Vector::load(s.W_re + n * M + m, re);
        Vector::load(s.W_im + n * M + m, im);
      }
      re += e_re * s.g_re[n];
      re += e_im * s.g_im[n];
      im += e_im * s.g_re[n];
      im -= e_re * s.g_im[n];
      Vector::store(re, s.W_re + n * M + m);
      Vector::store(im, s.W_im + n * M + m);
    }
  }
#pragma GCC unroll 4
  for (int i = 0; i < N; i += kWidth) {  // P = Tri{P - g h^H} / beta
    Doubles h_re, h_im, re, im;
    Vector::load(s.h_re + i, h_re);
    Vector::load(s.h_im + i, h_im);
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) {
      Vector::load(s.P_re + j * padded + i, re);
      Vector::load(s.P_im + j * padded + i, im);
      re -= h_re * s.g_re[j];
      re -= h_im * s.g_im[j];
      im -= h_im * s.g_re[j];
      im += h_re * s.g_im[j];
      Vector::store(forget * re, s.P_re + j * padded + i);
      Vector::store(forget * im, s.P_im + j * padded + i);
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
template <int kWidth>
[[gnu::always_inline]] inline void past_loops(const Past& s) {
  with_count(
      s.columns, [&](auto known) __attribute__((always_inline)) {
        for (int t = 0; t < s.snapshots; ++t)
          step<kWidth, std::size_t(known)>(s, s.x_re + t * s.rows, s.x_im + t * s.rows);
      });
}

}  // namespace

TRUEBEARING_FOR_WIDEST(past, (const Past& s), (s))

}  // namespace truebearing::kernels
