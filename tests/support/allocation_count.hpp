// SPDX-License-Identifier: Apache-2.0
#pragma once

// How often this thread has taken memory from the heap. Every allocation goes through malloc in the end: operator new,
// Eigen, the library's own code however it was compiled. So that is where they are counted, for the whole program: a
// test program that includes this header does so in one file, and in no program that counts in another way.
#include <cstddef>
#include <cstdlib>

namespace truebearing::testing {
// Volatile, since a compiler may take for granted that malloc changes no variable of ours.
inline thread_local volatile long allocations = 0;
inline void count_allocation() {
  allocations = allocations + 1;
}
}  // namespace truebearing::testing

#ifdef __SANITIZE_ADDRESS__
// The sanitizer's allocator cannot be replaced; it tells of every allocation instead.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*, std::size_t),
                                                         void (*free_hook)(const volatile void*));
namespace {
[[maybe_unused]] const int allocation_hooks = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { truebearing::testing::count_allocation(); }, [](const volatile void*) {});
}
#else
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);

void* malloc(std::size_t size) {
  truebearing::testing::count_allocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  truebearing::testing::count_allocation();
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  truebearing::testing::count_allocation();
  return __libc_realloc(memory, size);
}
}
#endif

namespace truebearing::testing {

template <typename Action>
long allocations_of(const Action& action) {
  const long before = allocations;
  action();
  return allocations - before;
}

}  // namespace truebearing::testing
