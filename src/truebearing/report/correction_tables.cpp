// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/correction_tables.hpp"

#include <cmath>
#include <fmt/format.h>

#include "truebearing/report/markup.hpp"

namespace truebearing {
namespace {

constexpr double kInPercent = 100.0;

std::string percent(double share, int digits = 3) {
  return fmt::format("<td>{}</td>", shown(kInPercent * share, digits));
}

std::string number_cell(double value) {
  return fmt::format("<td>{}</td>", shown(value));
}

std::string table_with(const std::string& head, const std::string& rows) {
  return fmt::format(
      "<div class=\"wide\" tabindex=\"0\"><table><thead><tr>{}</tr></thead><tbody>\n{}</tbody></table></div>\n", head,
      rows);
}

std::string heads(std::initializer_list<const char*> names) {
  std::string text;
  for (const char* name : names) text += fmt::format("<th scope=\"col\">{}</th>", name);
  return text;
}

}  // namespace

std::string correction_sentence(const ResultCorrection& correction) {
  std::string text;
  if (!correction.size.empty())
    text = fmt::format("{} ({}) correct {}, trusted is {}; {}. ", capitalised(correction.size), correction.network,
                       correction.base, correction.reference, correction.bounds);
  text += fmt::format("The network was asked in {} % of {} steps",
                      shown(kInPercent * correction.asked / correction.steps, 3), shown(correction.steps, 9));
  if (correction.outside_intervals > 0.0)
    text += fmt::format("; in {} % of these measurements came at intervals that it was not taught",
                        shown(kInPercent * correction.outside_intervals, 3));
  if (correction.outside_disagreement > 0.0)
    text += fmt::format("; in {} % it contradicted what is trusted more than ever in training",
                        shown(kInPercent * correction.outside_disagreement, 3));
  return fmt::format("<p class=\"note\">{}.</p>\n", escaped(text));
}

std::string rule_table(const ResultCorrection& correction) {
  std::string rows;
  for (std::size_t i = 0; i < correction.rules.size(); ++i) {
    const ResultCorrection::Rule& rule = correction.rules[i];
    rows +=
        fmt::format("<tr><th scope=\"row\">{}</th>{}{}{}<td class=\"prose\">IF {} THEN add {}</td><td>{}</td></tr>\n",
                    i + 1, percent(rule.fired), percent(rule.strongest), percent(rule.usage), escaped(rule.conditions),
                    escaped(rule.adds), escaped(rule.taught));
  }
  if (rows.empty()) return {};
  return table_with(heads({"rule", "fired (%)", "strongest (%)", "in training (%)", "what it says",
                           "what its teacher said on average"}),
                    rows);
}

std::string feature_table(const ResultCorrection& correction) {
  std::string rows;
  for (const ResultCorrection::Feature& feature : correction.features) {
    const std::string box = std::isfinite(feature.low)
                                ? fmt::format("<td>{} to {}</td>", shown(feature.low), shown(feature.high))
                                : "<td>-</td>";
    rows += fmt::format(
        "<tr><th scope=\"row\">{}</th>{}{}{}<td>{} <span class=\"se\">± {}</span></td><td>{} to {}</td>{}</tr>\n",
        escaped(feature.name), number_cell(feature.mean), number_cell(feature.scale), box, shown(feature.seen_mean),
        shown(feature.seen_deviation, 3), shown(feature.least), shown(feature.greatest), percent(feature.outside));
  }
  if (rows.empty()) return {};
  return table_with(heads({"feature", "mean in training", "scale", "box of the gate", "seen, with its deviation",
                           "from, to", "outside the box (%)"}),
                    rows);
}

}  // namespace truebearing
