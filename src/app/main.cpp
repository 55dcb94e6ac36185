// SPDX-License-Identifier: Apache-2.0
#include "app/command_line.hpp"

#include <cstdlib>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

int main(int argc, char** argv) {
#if defined(__GLIBC__)
  // Runs take the same memory again and again: what they leave is kept, up to these bytes, and not given back to the
  // system each time.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
  return truebearing::command_line(argc, argv);
}
