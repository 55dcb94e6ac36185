// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "tests/fuzz/readers.hpp"

namespace truebearing::corpus_test {
namespace {

// Files called valid_... are read, those called hostile_... refused; of any_... rounding decides, whether a track begins
// of noise. The sanitizers see how.
TEST(Corpus, IsReadOrRefused) {
  std::set<char> readers;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(TRUEBEARING_SOURCE_DIR) / "tests/fuzz/corpus")) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::vector<std::uint8_t> bytes((std::istreambuf_iterator<char>(file)), {});
    const std::string name = entry.path().filename().string();
    const bool valid = name.starts_with("valid_"), read = testing::read_hostile(bytes);
    EXPECT_TRUE(read == valid || name.starts_with("any_")) << entry.path();
    if (valid) readers.insert(static_cast<char>(bytes.front()));
  }
  EXPECT_EQ(readers, (std::set<char>{'c', 'd', 'e', 'f', 'g', 'h', 'm', 'p', 'r', 's', 't', 'w', 'y'}))
      << "each reads something";
}

}  // namespace
}  // namespace truebearing::corpus_test
