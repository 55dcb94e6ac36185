// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/gated_recurrent_kernel.hpp"

#include <cstddef>
#include <cstdint>

#include "truebearing/core/simd_dispatch.hpp"

namespace truebearing::kernels {
namespace {

using Floats [[gnu::vector_size(kFloatLanes * sizeof(float))]] = float;
using FloatsInMemory [[gnu::vector_size(kFloatLanes * sizeof(float)), gnu::aligned(alignof(float)), gnu::may_alias]] =
    float;
using FloatBits [[gnu::vector_size(kFloatLanes * sizeof(float))]] = std::int32_t;

[[gnu::always_inline]] inline void load_floats(const float* from, Floats& x) {
  x = *reinterpret_cast<const FloatsInMemory*>(from);
}
[[gnu::always_inline]] inline void store_floats(const Floats& x, float* to) {
  *reinterpret_cast<FloatsInMemory*>(to) = x;
}

// 1 / (1 + e^-x), e^x = 2^n e^r with r = x - n ln 2 of at most half of it by the polynomial of Cephes' expf (Moshier
// 1989). Beyond +-80 the answer is 0 or 1 to the last digit of a float.
[[gnu::always_inline]] inline void sigmoid(Floats& x) {
  constexpr float kMost = 80.0F, kInteger = 0x1.8p23F;  // a sum with kInteger has no digits behind the point
  Floats y = -x;
  y = y > kMost ? Floats{} + kMost : y;
  y = y < -kMost ? Floats{} - kMost : y;
  const Floats shifted = 1.44269504088896341F * y + kInteger;
  const Floats n = shifted - kInteger;
  const Floats r = y - n * 0.693359375F + n * 2.12194440e-4F;
  Floats p = 1.9875691500e-4F * r + 1.3981999507e-3F;
  p = p * r + 8.3334519073e-3F;
  p = p * r + 4.1665795894e-2F;
  p = p * r + 1.6666665459e-1F;
  p = p * r + 5.0000001201e-1F;
  p = p * r * r + r + 1.0F;
  const Floats power = shifted + 127.0F;  // its last digits are the exponent of 2^n
  const Floats scale = reinterpret_cast<Floats>(reinterpret_cast<FloatBits>(power) << 23);
  x = 1.0F / (1.0F + p * scale);
}

[[gnu::always_inline]] inline void hyperbolic_tangent(Floats& x) {
  x += x;
  sigmoid(x);
  x = (x + x) - 1.0F;
}

// K registers of rows of y += A x, A (stride x columns).
template <std::size_t K>
[[gnu::always_inline]] inline void add_rows(const float* A, int stride, int columns, const float* x, float* y) {
  Floats sums[K];
  for (std::size_t k = 0; k < K; ++k) load_floats(y + k * kFloatLanes, sums[k]);
  for (int j = 0; j < columns; ++j, A += stride)
    for (std::size_t k = 0; k < K; ++k) {
      Floats column;
      load_floats(A + k * kFloatLanes, column);
      sums[k] += column * x[j];
    }
  for (std::size_t k = 0; k < K; ++k) store_floats(sums[k], y + k * kFloatLanes);
}

// y += A x, A (rows x columns) by columns.
[[gnu::always_inline]] inline void add_product(const float* A, int rows, int columns, const float* x, float* y) {
  int row = 0;
  for (; row + 6 * kFloatLanes <= rows; row += 6 * kFloatLanes) add_rows<6>(A + row, rows, columns, x, y + row);
  for (; row + 2 * kFloatLanes <= rows; row += 2 * kFloatLanes) add_rows<2>(A + row, rows, columns, x, y + row);
  for (; row < rows; row += kFloatLanes) add_rows<1>(A + row, rows, columns, x, y + row);
}

[[gnu::always_inline]] inline void set(const float* from, int count, float* to) {
  for (int i = 0; i < count; ++i) to[i] = from[i];
}

[[gnu::always_inline]] inline void gated_recurrent_step_loops(const GatedRecurrentLayers& layers, const float* u,
                                                              float* h, float* heads) {
  const int H = layers.units;
  float encoded[kMostRows], gates[3 * kMostRows], hidden[3 * kMostRows];
  const float* e = u;
  if (layers.encoded > 0) {
    set(layers.encoder_bias, layers.encoded, encoded);
    add_product(layers.encoder, layers.encoded, layers.inputs, u, encoded);
    for (int i = 0; i < layers.encoded; i += kFloatLanes) {
      Floats x;
      load_floats(encoded + i, x);
      hyperbolic_tangent(x);
      store_floats(x, encoded + i);
    }
    e = encoded;
  }
  set(layers.input_bias, 3 * H, gates);
  add_product(layers.input, 3 * H, layers.encoded > 0 ? layers.encoded : layers.inputs, e, gates);
  for (int i = 0; i < 2 * H; ++i) hidden[i] = gates[i];
  set(layers.new_bias, H, hidden + 2 * H);
  add_product(layers.hidden, 3 * H, H, h, hidden);
  for (int i = 0; i < H; i += kFloatLanes) {
    Floats r, z, n, of_hidden, old;
    load_floats(hidden + i, r);
    load_floats(hidden + H + i, z);
    load_floats(hidden + 2 * H + i, of_hidden);
    load_floats(gates + 2 * H + i, n);
    load_floats(h + i, old);
    sigmoid(r);
    sigmoid(z);
    n += r * of_hidden;
    hyperbolic_tangent(n);
    store_floats((1.0F - z) * n + z * old, h + i);
  }
  set(layers.head_bias, layers.heads, heads);
  add_product(layers.head, layers.heads, H, h, heads);
}

}  // namespace

TRUEBEARING_FOR_AVX2(gated_recurrent_step, (const GatedRecurrentLayers& layers, const float* u, float* h, float* heads),
                     (layers, u, h, heads))

}  // namespace truebearing::kernels
