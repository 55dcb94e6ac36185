// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/page_parts.hpp"

#include <fmt/format.h>

#include "truebearing/report/markup.hpp"
#include "truebearing/report/player.hpp"
#include "truebearing/report/sha256.hpp"
#include "truebearing/report/style.hpp"

namespace truebearing {
namespace {

std::string figure_of(const Plot& plot) {
  return fmt::format(
      "<figure>\n<figcaption><strong>{}</strong><span>{}</span></figcaption>\n{}<details><summary>Numbers</summary>\n{}"
      "</details>\n</figure>\n",
      escaped(plot.title), escaped(plot.caption), svg_text(plot), number_tables(plot));
}

}  // namespace

std::string html_page(const std::string& title, const std::string& body) {
  const std::string &style = page_style(), &script = player_script();
  const bool plays = body.find(" data-times=\"") != std::string::npos;
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'sha256-{}'; {}base-uri "
      "'none'; form-action 'none'\"/>\n",
      sha256_base64(style), plays ? fmt::format("script-src 'sha256-{}'; ", sha256_base64(script)) : "");
  page += fmt::format(
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>{}</title>\n"
      "<style>{}</style>\n</head>\n<body>\n<main>\n{}</main>\n",
      escaped(title), style, body);
  if (plays) page += fmt::format("<script>{}</script>\n", script);
  return page + "</body>\n</html>\n";
}

std::string figures_markup(const std::vector<Plot>& plots) {
  if (plots.empty()) return {};
  std::string text = "<div class=\"plots\">\n";
  for (const Plot& plot : plots) text += figure_of(plot);
  return text + "</div>\n";
}

std::string heading(const std::string& title, int level) {
  return fmt::format("<h{}>{}</h{}>\n", level, escaped(title), level);
}

std::string section(const std::string& title, const std::vector<Plot>& plots, int level) {
  return plots.empty() ? "" : heading(title, level) + figures_markup(plots);
}

std::string folded(const std::string& title, const std::string& markup) {
  return markup.empty() ? "" : fmt::format("<details><summary>{}</summary>\n{}</details>\n", escaped(title), markup);
}

}  // namespace truebearing
