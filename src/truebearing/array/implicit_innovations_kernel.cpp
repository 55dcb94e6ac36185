// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/implicit_innovations_kernel.hpp"

#include <cmath>
#include <cstddef>

#include "truebearing/array/column_product.hpp"
#include "truebearing/core/simd_sine.hpp"
#include "truebearing/core/simd_width.hpp"
#include "truebearing/core/with_count.hpp"

namespace truebearing::kernels {
namespace {

// W^H W = L L^H, with the inverse of its diagonal in place of that.
[[gnu::always_inline]] inline void gram_root(int N, const ImplicitInnovations& s) {
  for (int j = 0; j < N; ++j)
    for (int i = j; i < N; ++i) {
      const double *re_i = s.W_re + i * s.W_stride, *im_i = s.W_im + i * s.W_stride;
      const double *re_j = s.W_re + j * s.W_stride, *im_j = s.W_im + j * s.W_stride;
      double re = 0.0, im = 0.0;
#pragma omp simd reduction(+ : re, im)
      for (int m = 0; m < s.M; ++m) {
        re += re_i[m] * re_j[m] + im_i[m] * im_j[m];
        im += re_i[m] * im_j[m] - im_i[m] * re_j[m];
      }
      s.L_re[j * N + i] = re;
      s.L_im[j * N + i] = i == j ? 0.0 : im;
    }
  for (int j = 0; j < N; ++j) {
    double *re_j = s.L_re + j * N, *im_j = s.L_im + j * N;
    const double inverse = 1.0 / std::sqrt(re_j[j]);
    for (int i = j; i < N; ++i) {
      re_j[i] *= inverse;
      im_j[i] *= inverse;
    }
    re_j[j] = inverse;
    for (int k = j + 1; k < N; ++k) {  // column k less column j times conj(L_kj)
      double *re_k = s.L_re + k * N, *im_k = s.L_im + k * N;
      const double re = re_j[k], im = im_j[k];
      for (int i = k; i < N; ++i) {
        re_k[i] -= re_j[i] * re + im_j[i] * im;
        im_k[i] -= im_j[i] * re - re_j[i] * im;
      }
    }
  }
}

// W^H a and W^H b of columns i .. i + kColumns - 1 of W. b = j turn m a at sensor m, so that what of W^H a every sensor
// gives serves both.
template <int kWidth, int kColumns>
[[gnu::always_inline]] inline void project(const ImplicitInnovations& s, int g,
                                           const typename VectorOf<kWidth>::Doubles& turn, int i) {
  using Vector = VectorOf<kWidth>;
  typename Vector::Doubles ya_re[std::size_t(kColumns)] = {}, ya_im[std::size_t(kColumns)] = {},
                           yb_re[std::size_t(kColumns)] = {}, yb_im[std::size_t(kColumns)] = {}, c, sine;
  for (int m = 0; m < s.M; ++m) {
    Vector::load(s.a_re + m * s.lanes + g, c);
    Vector::load(s.a_im + m * s.lanes + g, sine);
#pragma GCC unroll 8
    for (int n = 0; n < kColumns; ++n) {
      const double w_re = s.W_re[(i + n) * s.W_stride + m], w_im = s.W_im[(i + n) * s.W_stride + m];
      const typename Vector::Doubles re = w_re * c + w_im * sine, im = w_re * sine - w_im * c;
      ya_re[n] += re;
      ya_im[n] += im;
      yb_re[n] -= double(m) * im;
      yb_im[n] += double(m) * re;
    }
  }
#pragma GCC unroll 8
  for (int n = 0; n < kColumns; ++n) {
    const int at = (i + n) * s.lanes + g;
    Vector::store(ya_re[n], s.ya_re + at);
    Vector::store(ya_im[n], s.ya_im + at);
    Vector::store(turn * yb_re[n], s.yb_re + at);
    Vector::store(turn * yb_im[n], s.yb_im + at);
  }
}

// y <- L^-1 y
template <int kWidth>
[[gnu::always_inline]] inline void solve_root(int N, const ImplicitInnovations& s, int g, double* y_re, double* y_im) {
  using Vector = VectorOf<kWidth>;
  for (int i = 0; i < N; ++i) {
    typename Vector::Doubles re, im, k_re, k_im;
    Vector::load(y_re + i * s.lanes + g, re);
    Vector::load(y_im + i * s.lanes + g, im);
    for (int k = 0; k < i; ++k) {
      const double L_re = s.L_re[k * N + i], L_im = s.L_im[k * N + i];
      Vector::load(y_re + k * s.lanes + g, k_re);
      Vector::load(y_im + k * s.lanes + g, k_im);
      re -= L_re * k_re - L_im * k_im;
      im -= L_re * k_im + L_im * k_re;
    }
    Vector::store(re * s.L_re[i * N + i], y_re + i * s.lanes + g);
    Vector::store(im * s.L_re[i * N + i], y_im + i * s.lanes + g);
  }
}

template <int kWidth, int kN>
[[gnu::always_inline]] inline void implicit_innovations_of(const ImplicitInnovations& s) {
  using Vector = VectorOf<kWidth>;
  using Doubles = typename Vector::Doubles;
  const int N = kN > 0 ? kN : s.N;
  constexpr int kTogether = kWidth == 4 ? 2 : kN > 0 && kN < 6 ? kN : 4;  // as registers hold
  gram_root(N, s);
  for (int g = 0; g < N; g += kWidth) {
    Doubles theta, sine, cosine, c1, s1, c = Doubles{} + 1.0, s_{}, b2{};
    Vector::load(s.theta + g, theta);
    sine_and_cosine<kWidth>(theta, sine, cosine);
    const Doubles turn = s.wave * cosine;
    sine_and_cosine<kWidth>(s.wave * sine, s1, c1);
    for (int m = 0; m < s.M; ++m) {
      Vector::store(s.live[m] * c, s.a_re + m * s.lanes + g);
      Vector::store(s.live[m] * s_, s.a_im + m * s.lanes + g);
      b2 += (s.live[m] * m * m) * (c * c + s_ * s_);
      const Doubles next = c * c1 - s_ * s1;
      s_ = c * s1 + s_ * c1;
      c = next;
    }
    b2 *= turn * turn;
    int i = 0;
    for (; i + kTogether <= N; i += kTogether) project<kWidth, kTogether>(s, g, turn, i);
    for (; i < N; ++i) project<kWidth, 1>(s, g, turn, i);
    solve_root<kWidth>(N, s, g, s.ya_re, s.ya_im);
    solve_root<kWidth>(N, s, g, s.yb_re, s.yb_im);
    Doubles ba{}, bb{}, a_re, a_im, b_re, b_im;
    for (i = 0; i < N; ++i) {
      Vector::load(s.ya_re + i * s.lanes + g, a_re);
      Vector::load(s.ya_im + i * s.lanes + g, a_im);
      Vector::load(s.yb_re + i * s.lanes + g, b_re);
      Vector::load(s.yb_im + i * s.lanes + g, b_im);
      ba += b_re * a_re + b_im * a_im;
      bb += b_re * b_re + b_im * b_im;
    }
    const Doubles curvature = b2 - bb;
    Vector::store(curvature, s.curvature + g);
    Vector::store(ba / curvature, s.angle + g);  // Re(b^H a) = 0
    Vector::store(b2, s.b2 + g);
  }
}
template <int kWidth>
[[gnu::always_inline]] inline void implicit_innovations_loops(const ImplicitInnovations& s) {
  with_count(
      s.N, [&](auto known) __attribute__((always_inline)) { implicit_innovations_of<kWidth, int(known)>(s); });
}

}  // namespace

TRUEBEARING_FOR_WIDEST(implicit_innovations, (const ImplicitInnovations& s), (s))

}  // namespace truebearing::kernels
