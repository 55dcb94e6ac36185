// SPDX-License-Identifier: Apache-2.0
// How results look on standard output: within 100 columns, and with colour where a person looks at a terminal.
#pragma once

#include <string>

#include "app/arguments.hpp"
#include "truebearing/evaluation/text_table.hpp"

namespace truebearing {

struct TableArguments {
  bool wide = false;
  bool markdown = false;

  TableLayout layout() const { return {wide ? std::size_t{0} : std::size_t{100}, markdown}; }
};

/// --wide and --markdown.
void add_table_arguments(const Subcommand& command, TableArguments& arguments);

/// Is standard output a terminal that is not dumb, and does nobody object (https://no-color.org)?
bool is_coloured();

/// With the figures that are marked as the best in green, where is_coloured().
std::string with_best_coloured(const std::string& table);
/// In bold, where is_coloured().
std::string emphasised(const std::string& text);

}  // namespace truebearing
