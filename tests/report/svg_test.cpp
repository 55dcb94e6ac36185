// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "tests/support/markup.hpp"
#include "truebearing/report/plot.hpp"

namespace truebearing::svg_test {
namespace {

using testing::between;
using testing::count_of;
using ::testing::HasSubstr;
using testing::Markup;
using testing::read_markup;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

Plot plot_of(std::vector<PlotSeries> series) {
  Plot plot;
  plot.id = "p";
  plot.title = "Errors";
  plot.caption = "What is drawn.";
  plot.summary = "What is to be seen.";
  plot.x_label = "time (s)";
  plot.y_label = "error (m)";
  plot.series = std::move(series);
  return plot;
}

std::string marks_of(const std::string& svg) {
  return between(svg, "<g class=\"marks\"", "</g>");
}

TEST(Svg, IsWellFormedAndSaysWhatItShows) {
  const std::string svg = svg_text(plot_of({{"plain", tracker_look(0), Shape::line, {1, 2, 3}, {4, 5, 6}}}), true);
  const Markup markup = read_markup(svg);
  EXPECT_EQ(markup.error, "");
  EXPECT_THAT(markup.text, HasSubstr("Errors"));
  EXPECT_THAT(markup.text, HasSubstr("What is drawn. What is to be seen."));
  EXPECT_THAT(markup.text, HasSubstr("plain"));
  ASSERT_EQ(markup.labels.size(), 1u);
  EXPECT_EQ(markup.labels[0], "p-title p-desc");
  EXPECT_NE(read_markup("<svg><g></svg>").error, "") << "the checker can fail";
  EXPECT_NE(read_markup("<svg>a & b</svg>").error, "");
}

TEST(Svg, EveryPointHasItsMark) {
  const std::string svg = svg_text(plot_of({{"line", tracker_look(0), Shape::line, {1, 2, 3, 4}, {4, kMissing, 6, 5}},
                                            {"dots", tracker_look(1), Shape::dots, {1, 2, 3}, {4, 5, kMissing}},
                                            {"band", tracker_look(2), Shape::band, {1, 2}, {3, 4}, {5, 6}}}));
  const std::string marks = marks_of(svg);
  const std::string line = between(marks, "class=\"line s0\" d=\"", "\"");
  EXPECT_EQ(count_of(line, "M"), 2) << "broken where a value is missing: " << line;
  EXPECT_EQ(count_of(between(marks, "class=\"dots s1\" d=\"", "\""), "h0"), 2);
  EXPECT_EQ(count_of(between(marks, "class=\"band s2\" d=\"", "\""), "Z"), 1);
}

TEST(Svg, CellsAreRectanglesAndAloneNoPlot) {
  PlotSeries cells{"power", {"level1"}, Shape::cells, {1, 2}, {4, 5}, {5, 6}};
  cells.x2 = {2, kMissing};
  EXPECT_TRUE(plot_of({cells}).empty()) << "what is behind the lines says nothing by itself";
  const Plot plot = plot_of({cells, {"line", tracker_look(0), Shape::line, {1, 3}, {4, 6}}});
  const std::string path = between(marks_of(svg_text(plot)), "class=\"cells level1\" d=\"", "\"");
  EXPECT_EQ(count_of(path, "z"), 1) << path;
  EXPECT_EQ(count_of(number_tables(plot), "power"), 0);
}

TEST(Svg, PlaneHasOneScale) {
  Plot plot = plot_of({{"truth", {"truth"}, Shape::line, {0, 1000}, {0, 500}},
                       {"", tracker_look(0), Shape::ellipses, {500}, {250}, {}, {1e4}, {0}, {1e4}}});
  plot.equal = true;
  const std::string svg = svg_text(plot);
  std::smatch found;
  const std::string line = between(svg, "class=\"line truth\" d=\"M", "\"").empty() ? "" : marks_of(svg);
  ASSERT_TRUE(std::regex_search(line, found, std::regex("d=\"M([0-9.]+) ([0-9.]+)L([0-9.]+) ([0-9.]+)\"")));
  const double across = std::stod(found[3]) - std::stod(found[1]), up = std::stod(found[2]) - std::stod(found[4]);
  EXPECT_NEAR(across, 2.0 * up, 0.3) << "to the tenth of a pixel that is written";
  const std::string ellipse = between(svg, "<ellipse", "/>");
  EXPECT_EQ(between(ellipse, "rx=\"", "\""), between(ellipse, "ry=\"", "\""));
  EXPECT_NEAR(std::stod(between(ellipse, "rx=\"", "\"")), 0.2 * across, 0.2) << "two standard deviations of 100 m";
}

TEST(Svg, EllipseAtTheEdgeIsWhollyThere) {
  Plot plot = plot_of({{"course", tracker_look(0), Shape::line, {0, 1000}, {0, 500}},
                       {"", tracker_look(0), Shape::ellipses, {1000}, {500}, {}, {1e4}, {0}, {1e4}}});
  plot.equal = true;
  const std::string ellipse = between(svg_text(plot), "<ellipse", "/>");
  const double right = std::stod(between(ellipse, "translate(", " ")) + std::stod(between(ellipse, "rx=\"", "\""));
  EXPECT_LT(right, 544.0) << "where the frame ends";
  plot.series[1].xx = plot.series[1].yy = {1e8};
  const std::string svg = svg_text(plot);
  const double x = std::stod(between(between(svg, "<ellipse", "/>"), "translate(", " "));
  EXPECT_GT(x, 500.0) << "one that is larger than all else leaves the rest as it is";
}

TEST(Svg, EllipseLiesAlongItsCovariance) {
  Plot plot = plot_of({{"truth", {"truth"}, Shape::line, {0, 1000}, {0, 1000}},
                       {"", tracker_look(0), Shape::ellipses, {500}, {500}, {}, {1e4}, {9e3}, {1e4}}});
  plot.equal = true;
  const std::string ellipse = between(svg_text(plot), "<ellipse", "/>");
  EXPECT_EQ(between(ellipse, "rotate(", ")"), "-45.0") << "to the upper right, and SVG turns clockwise";
  EXPECT_GT(std::stod(between(ellipse, "rx=\"", "\"")), std::stod(between(ellipse, "ry=\"", "\"")));
}

TEST(Svg, LostTrackLeavesTheTruthToBeSeen) {
  Plot plot = plot_of({{"truth", {"truth"}, Shape::line, {0, 1000}, {0, 1000}},
                       {"lost", tracker_look(0), Shape::line, {0, 1e7}, {0, 1e7}}});
  plot.equal = true;
  std::smatch found;
  const std::string svg = svg_text(plot);
  ASSERT_TRUE(std::regex_search(svg, found, std::regex("line truth\" d=\"M([0-9.]+) [0-9.]+L([0-9.]+) ")));
  EXPECT_GT(std::stod(found[2]) - std::stod(found[1]), 50.0) << "pixels";
}

TEST(Svg, LongLineKeepsItsPeaksInFewPoints) {
  std::vector<double> x, y;
  for (int i = 0; i < 100000; ++i) {
    x.push_back(i);
    y.push_back(i == 54321 ? 50.0 : 1.0 + 0.5 * std::sin(i));
  }
  const std::string svg = svg_text(plot_of({{"long", tracker_look(0), Shape::line, x, y}}));
  EXPECT_LT(svg.size(), 50000u);
  EXPECT_EQ(count_of(marks_of(svg), " 28.0"), 1) << "the peak, at the upper edge";
}

// A step without a value breaks it now and then, as of a log with outages.
TEST(Svg, LongLineAndBandThatAreBrokenHaveFewPointsToo) {
  std::vector<double> x, low, high;
  for (int i = 0; i < 100000; ++i) {
    x.push_back(i);
    low.push_back(i % 90 == 0 ? kMissing : 1.0 + 0.5 * std::sin(i));
    high.push_back(i == 54322 ? 50.0 : low.back() + 1.0);
  }
  const std::string line = svg_text(plot_of({{"long", tracker_look(0), Shape::line, x, low}}));
  const std::string whole = svg_text(plot_of({{"long", tracker_look(0), Shape::line, x, high}}));
  EXPECT_LT(line.size(), 100000u);
  EXPECT_GE(count_of(marks_of(line), "M"), 1000) << "gaps are kept";
  EXPECT_EQ(count_of(marks_of(whole), " 28.0"), 1) << "the peak, at the upper edge";
  const std::string band = svg_text(plot_of({{"wide", tracker_look(0), Shape::band, x, low, high}}));
  EXPECT_LT(band.size(), 200000u);
  EXPECT_EQ(count_of(marks_of(band), " 28.0"), 1) << "the peak of the upper edge";
}

TEST(Svg, HostileNamesStayText) {
  const std::string hostile = "</text><script>alert(1)</script>\" onload=\"x\x01";
  Plot plot = plot_of({{hostile, tracker_look(0), Shape::line, {1, 2}, {1, 2}}});
  plot.title = plot.x_label = plot.y_label = plot.caption = plot.summary = hostile;
  for (const std::string& text : {svg_text(plot), "<div>" + number_tables(plot) + "</div>"}) {
    const Markup markup = read_markup(text);
    EXPECT_EQ(markup.error, "");
    EXPECT_EQ(markup.elements.count("script"), 0u);
    EXPECT_EQ(markup.attributes.count("onload"), 0u);
    EXPECT_THAT(markup.text, HasSubstr("<script>alert(1)</script>"));
  }
}

TEST(Svg, OfNothingIsEmpty) {
  EXPECT_TRUE(plot_of({}).empty());
  EXPECT_TRUE(plot_of({{"a", tracker_look(0), Shape::line, {1, 2}, {kMissing, kMissing}}}).empty());
  EXPECT_FALSE(plot_of({{"a", tracker_look(0), Shape::line, {1, 2}, {kMissing, 1}}}).empty());
}

TEST(PlotTable, HoldsTheNumbersOfSeriesThatShareTheirTimes) {
  const Plot plot = plot_of({{"a", tracker_look(0), Shape::line, {1, 2}, {10.5, kMissing}},
                             {"b", tracker_look(1), Shape::line, {1, 2}, {30, 40}}});
  const std::string table = number_tables(plot);
  EXPECT_EQ(count_of(table, "<table>"), 1);
  EXPECT_THAT(table, HasSubstr("<tr><td>1</td><td>10.5</td><td>30</td></tr>"));
  EXPECT_THAT(table, HasSubstr("<tr><td>2</td><td>-</td><td>40</td></tr>"));
}

}  // namespace
}  // namespace truebearing::svg_test
