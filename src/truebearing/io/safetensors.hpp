// SPDX-License-Identifier: Apache-2.0
// Named arrays of floats in the safetensors format: the length of a header as 8 bytes, the header as JSON (a name, dtype,
// shape and place of each array), the numbers, little-endian, each array by rows. Only F32, of one or two dimensions.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace truebearing {

/// An array of one dimension is a column. `vector`: which of the two it is in the file.
struct Tensor {
  Eigen::MatrixXf values;
  bool vector = false;
};
using Tensors = std::map<std::string, Tensor>;

struct TensorLimits {
  std::size_t max_bytes = std::size_t{1} << 22;
  Eigen::Index max_rows = 4096;
};

/// `name` stands for the file in messages. Throws InputError for another format, arrays that overlap, reach beyond the
/// file or leave a byte unread, other types, more than two dimensions, and numbers that are not finite; before it takes
/// memory for any of them.
Tensors parse_safetensors(std::string_view bytes, const std::string& name, TensorLimits limits = {});

/// The bytes of a file, the arrays in the order of their names.
std::string safetensors_bytes(const Tensors& tensors);

}  // namespace truebearing
