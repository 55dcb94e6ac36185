// SPDX-License-Identifier: Apache-2.0
// Figures that somebody else printed of the same problem, which tables show beside those of a comparison. They are what
// was printed: nothing is computed from them.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace truebearing {

struct PublishedFigure {
  std::string name;  ///< "position_m" (its RMSE), "nees", or the name of a metric: "mse_db"
  std::string set;   ///< of the comparison that it is of; empty for all sets together, or where there are none
  double value;      ///< in the unit of that figure
};

/// One method of a published table.
struct PublishedRow {
  std::string name;
  std::string source;  ///< where it is printed
  std::vector<PublishedFigure> figures;

  std::optional<double> figure(const std::string& figure_name) const;
};

/// What the rows say of one set, with the name of the set taken off; rows that say nothing of it are left out.
std::vector<PublishedRow> published_of(const std::vector<PublishedRow>& rows, const std::string& set);

/// What tables call a row.
std::string published_title(const PublishedRow& row);

}  // namespace truebearing
