// SPDX-License-Identifier: Apache-2.0
// For libFuzzer: `./run fuzz SECONDS`. What it finds belongs into corpus/, where the tests replay it.
#include <cstddef>

#include "tests/fuzz/readers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  truebearing::testing::read_hostile({data, size});
  return 0;
}
