// SPDX-License-Identifier: Apache-2.0
// Tables for people: figures of few digits in columns.
#pragma once

#include <string>
#include <vector>

namespace truebearing {

/// Three or four significant digits, without an exponent below ten million; "-" where there is none.
std::string figure(double value);
/// The same with three significant digits below .2 too, as errors of centimetres want it.
std::string fine_figure(double value);

using Rows = std::vector<std::vector<std::string>>;

/// How a table is written.
struct TableLayout {
  /// Characters of a line. What does not fit goes on below, behind the first column again; "+-" and what begins with "/"
  /// stays with the column that it belongs to. 0: however many it takes.
  std::size_t width = 0;
  bool markdown = false;  ///< for a document, of any width
};

/// Columns padded to the widest cell; the first to the left, the others to the right. The first row is the heading;
/// where rows are indented, those that are not head what follows.
std::string aligned(const Rows& rows, const TableLayout& layout = {});

/// "67.95*", or bold in a document, where it is the best; else with room for the mark.
std::string marked(const std::string& figure, bool is_best, const TableLayout& layout);

}  // namespace truebearing
