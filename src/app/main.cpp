// SPDX-License-Identifier: Apache-2.0
#include "app/command_line.hpp"

#include <cstdlib>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

int main(int argc, char** argv) {
#if defined(__GLIBC__)
  // Runs take the same memory again and again. Pieces of up to 32 MiB come from the heap, and up to 256 MiB at its end are
  // kept when they are free, in place of a call of the system each time.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
  return truebearing::command_line(argc, argv);
}
