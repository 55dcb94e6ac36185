// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/support/error_message.hpp"
#include "tests/support/markup.hpp"
#include "tests/support/result_texts.hpp"
#include "truebearing/report/sha256.hpp"
#include "truebearing/report/study_plots.hpp"

namespace truebearing::page_test {
namespace {

using testing::between;
using testing::count_of;
using ::testing::HasSubstr;
using testing::Markup;
using ::testing::Not;
using testing::read_markup;
using testing::ResultJson;
using testing::results_json;

Results read(const ResultJson& json, const std::string& file = "r.json") {
  return parse_results(json.dump(), file);
}

TEST(Page, IsWellFormedAndNothingInItComesFromElsewhere) {
  const std::string page = report_page({read(results_json())});
  const Markup markup = read_markup(page);
  EXPECT_EQ(markup.error, "");
  EXPECT_EQ(markup.elements.at("script"), 1);
  EXPECT_EQ(markup.elements.count("link") + markup.elements.count("img"), 0u);
  EXPECT_EQ(markup.attributes.count("style"), 0u) << "which the policy would not allow";
  EXPECT_EQ(count_of(page, "http"), count_of(page, "http://www.w3.org/2000/svg") + 1) << "and http-equiv";
  EXPECT_THAT(page, HasSubstr("default-src 'none'; style-src 'sha256-" +
                              sha256_base64(between(page, "<style>", "</style>")) + "'"));
  EXPECT_THAT(page, HasSubstr("script-src 'sha256-" + sha256_base64(between(page, "<script>", "</script>")) + "'"));
  const std::set<std::string> ids(markup.ids.begin(), markup.ids.end());
  EXPECT_EQ(ids.size(), markup.ids.size()) << "each id stands once";
  for (const std::string& label : markup.labels) {
    EXPECT_EQ(ids.count(label.substr(0, label.find(' '))), 1u) << label;
    EXPECT_EQ(ids.count(label.substr(label.find(' ') + 1)), 1u) << label;
  }
}

TEST(Page, FiguresAreThoseOfTheResults) {
  const std::string page = report_page({read(results_json())});
  EXPECT_THAT(page, HasSubstr("86 <span class=\"se\">± 1.7</span><span class=\"tag\">best</span>"));
  EXPECT_THAT(page, HasSubstr("100 <span class=\"se\">± 2</span>"));
  EXPECT_THAT(page, HasSubstr("2.1 <span class=\"se\">of 2</span>"));
  EXPECT_THAT(page, HasSubstr("−14.4 <span class=\"se\">± 1.6</span></td><td>9</td>"));
  EXPECT_EQ(count_of(page, ">best<"), 1) << "the bound is better and does not count";
  EXPECT_EQ(count_of(page, ">bound<"), 1);
  EXPECT_THAT(page, HasSubstr("<td>70</td>")) << "per cent of the way from tuned to the bound";
}

TEST(Page, SaysWhoForetoldALogBest) {
  ResultJson json = results_json();
  EXPECT_EQ(count_of(report_page({read(json)}), "Who foretells best"), 0);
  json["foretelling"] = {{{"track", 0},
                          {"steps", 1},
                          {"quantity", "bearing_deg"},
                          {"measurements", 20},
                          {"best", "tuned"},
                          {"says", ""},
                          {"trackers",
                           {{"tuned",
                             {{"rmse", 0.5},
                              {"rmse_se", 0.1},
                              {"squared_above_best", 0},
                              {"squared_above_best_se", 0},
                              {"mean_gate", nullptr}}}}},
                          {"left_out", ResultJson::array()}}};
  const std::string page = report_page({read(json)});
  EXPECT_EQ(read_markup(page).error, "");
  EXPECT_THAT(between(page, "<h2>Who foretells best</h2>", "<h2>"), HasSubstr("20 measurements"));
}

TEST(Page, SaysWhatOthersPublishedAndWhere) {
  ResultJson json = results_json();
  EXPECT_EQ(count_of(report_page({read(json)}), "ublished"), 0);
  json["published"] = {{"plain <KF>", {{"source", "A & B, 2001"}, {"position_m", 123.4}}},
                       {"network", {{"source", "C, 2002"}, {"nees", 2.25}}}};
  const std::string page = report_page({read(json)});
  EXPECT_EQ(read_markup(page).error, "");
  EXPECT_THAT(page, HasSubstr("<th scope=\"col\">published</th><th scope=\"col\">position RMSE (m)</th><th "
                              "scope=\"col\">nees</th><th scope=\"col\">printed in</th>"));
  EXPECT_THAT(page, HasSubstr("plain &lt;KF&gt;</th><td>123.4</td><td>-</td><td>A &amp; B, 2001</td>"));
  EXPECT_THAT(page, HasSubstr("network</th><td>-</td><td>2.25</td>"));
  json["published"]["network"].erase("source");
  EXPECT_THAT(testing::error_message([&] { read(json); }), HasSubstr("published.network: has no \"source\""));
}

TEST(Page, HasEveryPlotWithItsMarks) {
  const std::string page = report_page({read(results_json())});
  for (const char* id :
       {"error_position_m", "nees_2", "share_position_m", "pair_0_position_m", "run_median", "run_median_error"})
    EXPECT_EQ(count_of(page, "id=\"" + std::string(id) + "-title\""), 1) << id;
  EXPECT_EQ(count_of(page, "<figure>"), 6);
  EXPECT_EQ(count_of(page, "<summary>Numbers</summary>"), 6);
  const std::string scatter = between(page, "id=\"pair_0_position_m-frame\"", "</svg>");
  EXPECT_EQ(count_of(between(scatter, "class=\"dots s1\" d=\"", "\""), "h0"), 3) << "a dot for each run";
  const std::string errors = between(page, "id=\"error_position_m-frame\"", "</svg>");
  EXPECT_EQ(count_of(errors, "class=\"line "), 3) << "a line for each tracker";
  EXPECT_EQ(count_of(errors, "class=\"band "), 3);
  const std::string run = between(page, "id=\"run_median-frame\"", "</svg>");
  EXPECT_EQ(count_of(run, "<ellipse "), 4);
  EXPECT_EQ(count_of(between(run, "class=\"sight measured\" d=\"", "\""), "M"), 3) << "one bearing is missing";
  EXPECT_THAT(run, HasSubstr("class=\"line truth\""));
  EXPECT_EQ(between(run, "data-times=\"", "\""), "1 3 4") << "the times of the bearings that are there";
  EXPECT_EQ(count_of(run, "data-times=\""), 4 + 4) << "of each ellipse; of bearings, own ship, truth and track";
}

// Two times of three angles; the strongest, and what is 15 dB or more below, which is not drawn.
TEST(Page, DrawsWhatAnArrayHeardBehindItsTracks) {
  ResultJson json = results_json();
  ResultJson& picture = json["pictures"][0];
  for (ResultJson* line : {&picture["truth"][0], &picture["tracks"][0]}) line->erase("x");
  picture["tracks"][0].erase("xx");
  picture["tracks"][0].erase("xy");
  picture.erase("plane");
  picture.erase("own_ship");
  picture["component"] = "angle_deg";
  picture["beam"] = {
      {"time_s", {1.0, 3.0}}, {"angle_deg", {-30.0, 0.0, 30.0}}, {"below_dB", {{0, 4, 15}, {0, 7, nullptr}}}};
  const std::string run = between(report_page({read(json)}), "id=\"run_median-frame\"", "</svg>");
  EXPECT_EQ(count_of(between(run, "class=\"cells level1\" d=\"", "\""), "z"), 1) << "neighbours in time are one";
  EXPECT_EQ(count_of(between(run, "class=\"cells level2\" d=\"", "\""), "z"), 1);
  EXPECT_EQ(count_of(between(run, "class=\"cells level3\" d=\"", "\""), "z"), 1);
  EXPECT_EQ(count_of(run, "level4") + count_of(run, "level5"), 0);
  picture["beam"]["below_dB"][1] = {0};
  EXPECT_THAT(testing::error_message([&] { read(json); }),
              HasSubstr("pictures[0].beam.below_dB[1]: has columns of unequal"));
}

// Two targets 100 m apart, and tracks whose numbers say the wrong one.
TEST(Page, ErrorOfTracksWithoutNumbersIsFromTheNearestTarget) {
  ResultJson json = results_json();
  ResultJson& picture = json["pictures"][0];
  ResultJson second = picture["truth"][0];
  second["track"] = 1;
  for (ResultJson& y : second["y"]) y = y.get<double>() + 100.0;
  picture["truth"].push_back(second);
  picture["tracks"][0]["track"] = 1;
  const auto errors = [&] {
    for (const Plot& plot : picture_plots(read(json), ""))
      if (plot.id == "run_median_error") return plot.series.at(0).y;
    return std::vector<double>{kNaN};  // nothing to draw: no plot
  };
  EXPECT_EQ(errors(), (std::vector<double>{100.0, 100.0, 100.0, 100.0}));
  picture["assigned_within"] = 50.0;
  EXPECT_EQ(errors(), (std::vector<double>{0.0, 0.0, 0.0, 0.0}));
  for (ResultJson& y : picture["tracks"][0]["y"]) y = y.get<double>() + 1000.0;
  for (const double error : errors()) EXPECT_TRUE(std::isnan(error)) << "of no target";
}

TEST(Page, HasNoEmptyPlotWhereResultsHaveLess) {
  const std::string page = report_page({read(results_json(false))});
  EXPECT_EQ(count_of(page, "<figure>"), 1);
  EXPECT_EQ(count_of(page, "script"), 0) << "with nothing to play";
  ResultJson json = results_json(false);
  for (auto& [name, tracker] : json["trackers"].items()) tracker["series"]["rmse"]["position_m"] = {nullptr, nullptr};
  EXPECT_EQ(count_of(report_page({read(json)}), "<figure>"), 0);
}

TEST(Page, HostileNamesStayText) {
  const std::string hostile = "<img src=x onerror=alert(1)>\"'&</style>";
  ResultJson json = results_json();
  json["study"] = hostile;
  json["trackers"][hostile] = json["trackers"]["nfnn"];
  json["trackers"].erase("nfnn");
  json["paired"] = {{hostile + " - tuned", json["paired"]["nfnn - tuned"]}};
  json["pictures"][0]["judged_by"] = json["pictures"][0]["tracks"][0]["tracker"] = hostile;
  const std::string page = report_page({read(json, hostile)});
  const Markup markup = read_markup(page);
  EXPECT_EQ(markup.error, "");
  EXPECT_EQ(markup.elements.count("img"), 0u);
  EXPECT_EQ(markup.elements.at("style"), 1);
  EXPECT_THAT(markup.text, HasSubstr("Does " + hostile + " err less than tuned? " + hostile));
}

TEST(Page, SetsFilesSideBySideAndMarksWhatChanged) {
  ResultJson other = results_json();
  other["trackers"]["nfnn"]["rmse"]["position_m"] = 60.0;
  other["trackers"]["tuned"]["rmse"]["position_m"] = 101.0;
  const std::string page = report_page({read(results_json(), "a.json"), read(other, "b.json")});
  const Markup markup = read_markup(page);
  EXPECT_EQ(markup.error, "");
  EXPECT_EQ(std::set<std::string>(markup.ids.begin(), markup.ids.end()).size(), markup.ids.size());
  EXPECT_THAT(page, HasSubstr("<span class=\"down\">▼ −30 %</span>"));
  EXPECT_THAT(page, HasSubstr("<span class=\"se\">1 %</span>")) << "within its standard errors";
  EXPECT_EQ(count_of(page, "<figure>"), 12);
}

TEST(Page, PlotFilesAreWholeDrawings) {
  const std::vector<PlotFile> files = plot_files({read(results_json())});
  ASSERT_EQ(files.size(), 6u);
  EXPECT_EQ(files[0].name, "small_error_position_m.svg");
  for (const PlotFile& file : files) {
    EXPECT_EQ(read_markup(file.svg).error, "") << file.name;
    EXPECT_THAT(file.svg, HasSubstr("<style>"));
  }
}

TEST(Page, OfAThousandRunsIsSmall) {
  ResultJson json = results_json();
  std::vector<double> runs, time_s, rmse;
  for (int i = 0; i < 1000; ++i) runs.push_back(80.0 + 0.1 * (i * 7919 % 500));
  for (int i = 0; i < 5000; ++i) {
    time_s.push_back(i);
    rmse.push_back(100.0 + i * 31 % 17);
  }
  for (auto& [name, tracker] : json["trackers"].items()) {
    tracker["details"]["run_rmse"]["position_m"] = runs;
    for (const char* column : {"nees", "nees_low", "nees_high"}) tracker["details"][column] = rmse;
    tracker["details"]["series_se"]["position_m"] = rmse;
    tracker["series"] = {{"time_s", time_s}, {"rmse", {{"position_m", rmse}}}};
  }
  EXPECT_LT(report_page({read(json)}).size(), 500000u);
}

}  // namespace
}  // namespace truebearing::page_test
