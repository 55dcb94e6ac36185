// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/published.hpp"

#include <utility>

namespace truebearing {

std::optional<double> PublishedRow::figure(const std::string& figure_name) const {
  for (const PublishedFigure& figure : figures)
    if (figure.name == figure_name) return figure.value;
  return std::nullopt;
}

std::vector<PublishedRow> published_of(const std::vector<PublishedRow>& rows, const std::string& set) {
  std::vector<PublishedRow> of_set;
  for (const PublishedRow& row : rows) {
    PublishedRow kept{row.name, row.source, {}};
    for (const PublishedFigure& figure : row.figures)
      if (figure.set == set) kept.figures.push_back({figure.name, {}, figure.value});
    if (!kept.figures.empty()) of_set.push_back(std::move(kept));
  }
  return of_set;
}

std::string published_title(const PublishedRow& row) {
  return row.name + " (published)";
}

}  // namespace truebearing
