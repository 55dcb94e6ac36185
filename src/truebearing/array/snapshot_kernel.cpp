// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/snapshot_kernel.hpp"

#include "truebearing/core/simd_width.hpp"

namespace truebearing::kernels {
namespace {

// The parts of kWidth complex numbers.
template <int kWidth>
[[gnu::always_inline]] inline void part_of(const double* values, typename VectorOf<kWidth>::Doubles& re,
                                           typename VectorOf<kWidth>::Doubles& im) {
  typename VectorOf<kWidth>::Doubles low, high;
  VectorOf<kWidth>::load(values, low);
  VectorOf<kWidth>::load(values + kWidth, high);
  if constexpr (kWidth == 8) {
    re = __builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
    im = __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15);
  } else {
    re = __builtin_shufflevector(low, high, 0, 2, 4, 6);
    im = __builtin_shufflevector(low, high, 1, 3, 5, 7);
  }
}

// Of sensors m .. m + kWidth - 1.
template <int kWidth>
[[gnu::always_inline]] inline void part_sensors(const Snapshots& s, int m) {
  using Vector = VectorOf<kWidth>;
  typename Vector::Doubles sum_re{}, sum_im{}, power{}, re, im;
  for (int t = 0; t < s.count; ++t) {
    part_of<kWidth>(s.values + 2 * (t * s.sensors + m), re, im);
    Vector::store(re, s.re + t * s.rows + m);
    Vector::store(im, s.im + t * s.rows + m);
    sum_re += re;
    sum_im += im;
    power += re * re + im * im;
  }
  Vector::store(sum_re, s.sum_re + m);
  Vector::store(sum_im, s.sum_im + m);
  Vector::store(power, s.power + m);
}

template <int kWidth>
[[gnu::always_inline]] inline void part_loops(const Snapshots& s) {
  if (s.sensors >= kWidth) {
    for (int m = 0; m + kWidth <= s.sensors; m += kWidth) part_sensors<kWidth>(s, m);
    if (s.sensors % kWidth > 0) part_sensors<kWidth>(s, s.sensors - kWidth);  // some of them once more
    return;
  }
  for (int m = 0; m < s.sensors; ++m) {
    s.sum_re[m] = s.sum_im[m] = s.power[m] = 0.0;
    for (int t = 0; t < s.count; ++t) {
      const double *value = s.values + 2 * (t * s.sensors + m), re = value[0], im = value[1];
      s.re[t * s.rows + m] = re;
      s.im[t * s.rows + m] = im;
      s.sum_re[m] += re;
      s.sum_im[m] += im;
      s.power[m] += re * re + im * im;
    }
  }
}

}  // namespace

TRUEBEARING_FOR_WIDEST(part, (const Snapshots& s), (s))

}  // namespace truebearing::kernels
