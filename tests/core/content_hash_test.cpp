// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/content_hash.hpp"

#include <gtest/gtest.h>

#include <string>

namespace truebearing::content_hash_test {
namespace {

std::uint64_t hash_of(const std::string& bytes) {
  ContentHash hash;
  for (const char byte : bytes) hash.take(static_cast<unsigned char>(byte));
  return hash.value();
}

// The vectors that its authors publish.
TEST(ContentHash, OfBytesIsFnv1a) {
  EXPECT_EQ(hash_of(""), 0xcbf29ce484222325U);
  EXPECT_EQ(hash_of("a"), 0xaf63dc4c8601ec8cU);
  EXPECT_EQ(hash_of("foobar"), 0x85944171f73967e8U);
}

}  // namespace
}  // namespace truebearing::content_hash_test
