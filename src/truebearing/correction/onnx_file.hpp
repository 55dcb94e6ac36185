// SPDX-License-Identifier: Apache-2.0
// A recurrent network as ONNX (operator set 13), for programs that run networks but not this library. Standardisation
// and clipping are inside, so that what goes in are features in their units:
//     features (T x 1 x d), memory (1 x 1 x H), zero where a track begins
//     correction (T x n) in the units of the network's outputs, factor (T x n (n + 1) / 2): rows of the Cholesky factor
//     of the covariance, its diagonal as logarithms, and memory_after (1 x 1 x H)
// All are float. What stands around a network (frame, gate, referee, kappa) is not in the file. The bytes are protocol
// buffers, written by hand: https://onnx.ai/onnx/intro, onnx.proto3.
#pragma once

#include <string>

#include "truebearing/correction/gated_recurrent.hpp"

namespace truebearing {

/// The bytes of the file. name: the graph's.
std::string onnx_bytes(const GatedRecurrent::Parameters& parameters, const std::string& name);

}  // namespace truebearing
