// SPDX-License-Identifier: Apache-2.0
// For libFuzzer: `./run fuzz SECONDS`. What it finds belongs into corpus/, where the tests replay it.
#include <cstddef>

#include "tests/fuzz/readers.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  truebearing::testing::read_hostile({data, size});
  return 0;
}

// All but the first byte: what came from a reader's corpus is for that reader.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned) {
  if (size < 1 || max_size < 2) return size;
  return 1 + LLVMFuzzerMutate(data + 1, size - 1, max_size - 1);
}
