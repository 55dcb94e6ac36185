// SPDX-License-Identifier: Apache-2.0
// One step of a gated recurrent network, in SIMD instructions where the processor has them: the same bits with them and
// without.
#pragma once

namespace truebearing::kernels {

inline constexpr int kFloatLanes = 8;
inline constexpr int kMostRows = 128;  ///< of an encoder, of a gate, of the heads

/// Matrices by columns of `units`, 3 `units`, `encoded` or `heads` rows, each count a multiple of kFloatLanes, rows that
/// fill up zero. Gates in the order r, z, n.
struct GatedRecurrentLayers {
  int inputs, encoded, units, heads;  ///< encoded 0: no encoder
  const float* encoder;               ///< (encoded x inputs)
  const float* encoder_bias;
  const float* input;       ///< (3 units x encoded, or inputs)
  const float* input_bias;  ///< (3 units), that of the hidden part of r and z added
  const float* hidden;      ///< (3 units x units)
  const float* new_bias;    ///< (units), of the hidden part of n
  const float* head;        ///< (heads x units)
  const float* head_bias;
};

/// h (units) one step on for inputs u, and the heads of the new h.
void gated_recurrent_step(const GatedRecurrentLayers& layers, const float* u, float* h, float* heads);

}  // namespace truebearing::kernels
