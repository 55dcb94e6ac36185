// SPDX-License-Identifier: Apache-2.0
#include "app/terminal.hpp"

#include <cstdlib>
#include <string_view>
#include <unistd.h>

namespace truebearing {
namespace {

constexpr const char* kGreen = "\033[32m";
constexpr const char* kBold = "\033[1m";
constexpr const char* kPlain = "\033[0m";

}  // namespace

void add_table_arguments(const Subcommand& command, TableArguments& arguments) {
  command.flag("--wide", arguments.wide, "tables as wide as they come, not of 100 columns");
  command.flag("--markdown", arguments.markdown, "tables for a document");
}

bool is_coloured() {
  const char* objection = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  return (!objection || *objection == '\0') && terminal && std::string_view(terminal) != "dumb" &&
         isatty(STDOUT_FILENO) != 0;
}

std::string with_best_coloured(const std::string& table) {
  if (!is_coloured()) return table;
  constexpr std::string_view kOfFigure = "0123456789.e+-";
  std::string text;
  for (std::size_t i = 0; i < table.size(); ++i) {
    text += table[i];
    if (table[i] != '*') continue;
    std::size_t begin = text.size() - 1;
    while (begin > 0 && kOfFigure.find(text[begin - 1]) != std::string_view::npos) --begin;
    if (begin + 1 == text.size()) continue;  // no figure stands before it
    text.insert(begin, kGreen);
    text += kPlain;
  }
  return text;
}

std::string emphasised(const std::string& text) {
  return is_coloured() ? kBold + text + kPlain : text;
}

}  // namespace truebearing
