// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/configuration_text.hpp"

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include "truebearing/io/table_reader.hpp"

namespace truebearing::configuration_text_test {
namespace {

TEST(ConfigurationText, IsTheSameHoweverTheTableWasSpelt) {
  const SharedTable a = parse_toml("b = 1\n[a]\nx = [1, 2.5]\ny = \"text\"\nz = true\n", "a.toml");
  const SharedTable b = parse_toml("a = { z = true, y = \"text\", x = [1.0, 2.50] }\nb = 1.0\n", "b.toml");
  EXPECT_EQ(configuration_text(*a), "{a = {x = [1, 2.5], y = \"text\", z = true}, b = 1}");
  EXPECT_EQ(configuration_text(*a), configuration_text(*b));
}

TEST(ConfigurationText, TellsNumbersApartToTheLastDigit) {
  const SharedTable a = parse_toml("x = 0.1\n", "a.toml");
  const SharedTable b = parse_toml("x = 0.10000000000000002\n", "b.toml");
  EXPECT_NE(configuration_text(*a), configuration_text(*b));
}

TEST(MergedTable, ChildGoesFirstKeyByKey) {
  const SharedTable parent = parse_toml("a = 1\nlist = [1, 2]\n[t]\nx = 1\ny = 2\n[t.u]\nz = 3\n", "p.toml");
  const SharedTable child = parse_toml("b = 2\nlist = [9]\n[t]\ny = 5\n", "c.toml");
  EXPECT_EQ(configuration_text(merged(*parent, *child)), "{a = 1, b = 2, list = [9], t = {u = {z = 3}, x = 1, y = 5}}");
  EXPECT_EQ(configuration_text(*parent), "{a = 1, list = [1, 2], t = {u = {z = 3}, x = 1, y = 2}}") << "untouched";
}

}  // namespace
}  // namespace truebearing::configuration_text_test
