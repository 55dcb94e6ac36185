// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/printable.hpp"

#include <gtest/gtest.h>

#include "truebearing/core/error.hpp"

namespace truebearing::printable_test {
namespace {

TEST(Printable, EscapesWhatUpsetsATerminal) {
  EXPECT_EQ(printable("a\x1b[2J\n\t\r\x7f"), "a\\x1b[2J\\n\\t\\r\\x7f");
  EXPECT_EQ(printable("\xC2\x9B"), "\\xc2\\x9b") << "a control sequence in one character";
  EXPECT_EQ(printable("\xE2\x80\xAE"), "\\xe2\\x80\\xae") << "right to left from here";
  EXPECT_EQ(printable("\xFF\xE2\x80"), "\\xff\\xe2\\x80") << "no UTF-8";
  EXPECT_EQ(printable("Gr\u00F6\u00DFe \u2192"), "Gr\u00F6\u00DFe \u2192");
}

TEST(Printable, CutsBetweenCharacters) {
  EXPECT_EQ(shortened("abcdefgh", 6), "abc...");
  EXPECT_EQ(shortened("abcdef", 6), "abcdef");
  EXPECT_EQ(shortened("ab\u00F6\u00F6\u00F6", 6), "ab...");
  EXPECT_EQ(shortened_from_front("abcdefgh", 6), "...fgh");
}

TEST(Printable, ErrorsAreOneLineThatNamesTheRow) {
  const std::string path(300, 'p'), text(1000, '\x1b');
  const std::string message = InputError(path + ":17: a", "is " + text, text).what();
  EXPECT_LE(message.size() + std::string("truebearing: ").size(), 200u);
  EXPECT_NE(message.find(":17: a"), message.npos);
  EXPECT_EQ(message.find('\x1b'), message.npos);
}

}  // namespace
}  // namespace truebearing::printable_test
