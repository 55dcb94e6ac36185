// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/base64.hpp"

#include <gtest/gtest.h>

namespace truebearing::base64_test {
namespace {

// The examples of RFC 4648, section 10.
TEST(Base64, IsThatOfTheStandard) {
  for (const auto& [bytes, text] : {std::pair{"", ""}, std::pair{"f", "Zg=="}, std::pair{"fo", "Zm8="},
                                    std::pair{"foo", "Zm9v"}, std::pair{"foobar", "Zm9vYmFy"}}) {
    EXPECT_EQ(base64_of(bytes), text);
    EXPECT_EQ(bytes_of_base64(text), bytes);
  }
}

TEST(Base64, EveryByteComesBack) {
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
  for (std::size_t cut = 0; cut < 4; ++cut, bytes.pop_back()) EXPECT_EQ(bytes_of_base64(base64_of(bytes)), bytes);
}

TEST(Base64, OtherTextIsNone) {
  for (const char* text : {"QR==", "Zg=", "Zg", "Z===", "Zm9v!mFy", "Zg==Zm9v", "Zm9\n"})
    EXPECT_EQ(bytes_of_base64(text), std::nullopt) << text;
}

}  // namespace
}  // namespace truebearing::base64_test
