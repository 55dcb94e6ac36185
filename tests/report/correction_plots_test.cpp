// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/correction_plots.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_message.hpp"
#include "tests/support/markup.hpp"
#include "tests/support/result_texts.hpp"
#include "truebearing/report/correction_tables.hpp"
#include "truebearing/report/page.hpp"

namespace truebearing::correction_plots_test {
namespace {

using testing::between;
using testing::correction_json;
using testing::count_of;
using ::testing::ElementsAre;
using testing::error_message;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::read_markup;
using testing::ResultJson;

ResultJson corrected() {
  ResultJson json = testing::results_json();
  json["trackers"]["nfnn"]["details"]["correction"] = correction_json();
  return json;
}

Results read(const ResultJson& json) {
  return parse_results(json.dump(), "r.json");
}

const PlotSeries& series(const Plot& plot, const std::string& name) {
  for (const PlotSeries& one : plot.series)
    if (one.name == name) return one;
  ADD_FAILURE() << plot.id << " has no " << name;
  return plot.series.front();
}

TEST(CorrectionPlots, SayWhoHeldItBackInPerCent) {
  const Results results = read(corrected());
  EXPECT_TRUE(correction_time_plots(results.all, 0, "").empty()) << "tuned is no correction";
  const std::vector<Plot> plots = correction_time_plots(results.all, 1, "");
  ASSERT_EQ(plots.size(), 2u);
  EXPECT_THAT(series(plots[0], "box gate").x, ElementsAre(2.0, 3.0, 4.0));
  EXPECT_THAT(series(plots[0], "box gate").y, ElementsAre(0.0, 50.0, ::testing::DoubleNear(10.0, 1e-9)));
  EXPECT_THAT(series(plots[0], "kappa").y, ElementsAre(0.0, 25.0, 0.0));
  EXPECT_THAT(plots[0].summary, HasSubstr("box gate 20 %, kappa 8.33 %."));
  for (const PlotSeries& one : plots[0].series)
    EXPECT_TRUE(one.name != "fallback" && one.name != "referee") << "there is none";
  EXPECT_THAT(series(plots[1], "what the network wants").y, ElementsAre(1.0, 4.0, 2.0));
  EXPECT_THAT(series(plots[1], "kappa").y, ElementsAre(3.0, 3.0));
}

TEST(CorrectionPlots, ShowTermsOverTheValuesThatWereSeen) {
  const Results results = read(corrected());
  const std::vector<Plot> plots = feature_plots(results.all, 1, "");
  ASSERT_EQ(plots.size(), 2u);
  // Bins of 1 from -1 to 3, the second and the third of which hold something.
  const PlotSeries& seen = series(plots[0], "values seen");
  EXPECT_THAT(seen.x, ElementsAre(0.0, 1.0, 1.0, 2.0));
  EXPECT_THAT(seen.y2, ElementsAre(0.5, 0.5, 1.0, 1.0));
  const PlotSeries& shared = series(plots[0], "rule 2 and 1 more");
  const auto peak = std::max_element(shared.y.begin(), shared.y.end()) - shared.y.begin();
  EXPECT_NEAR(shared.x[static_cast<std::size_t>(peak)], 0.5, 0.05) << "the centre of both";
  EXPECT_THAT(plots[0].summary, HasSubstr("outside the box in 12.5 %"));
  for (std::size_t i = 0; i < series(plots[1], "rule 2").x.size(); ++i) {
    const double e = (series(plots[1], "rule 2").x[i] - 0.3) / 0.3;
    EXPECT_NEAR(series(plots[1], "rule 2").y[i], std::exp(-0.5 * e * e), 1e-12);
  }
}

TEST(CorrectionPlots, OfANetworkWithoutRulesShowItsScale) {
  ResultJson json = corrected();
  json["trackers"]["nfnn"]["details"]["correction"].erase("rules");
  const Results results = read(json);
  EXPECT_TRUE(rule_plots(results.all, 1, "").empty());
  EXPECT_EQ(rule_table(*results.all.trackers[1].correction), "");
  EXPECT_THAT(series(feature_plots(results.all, 1, "")[0], "mean and scale").x, ElementsAre(0.5, 1.0, 1.5));
  EXPECT_THAT(feature_table(*results.all.trackers[1].correction),
              HasSubstr("<td>1</td><td>0.5</td><td>0 to 2</td><td>1.25 <span class=\"se\">± 0.5</span></td>"
                        "<td>0.1 to 2.5</td><td>12.5</td>"));
}

TEST(CorrectionPlots, PageHasRulesWithHowOftenTheyFired) {
  const std::string page = report_page({read(corrected())});
  EXPECT_EQ(read_markup(page).error, "");
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\">2</th><td>60</td><td>60</td><td>30</td><td class=\"prose\">IF gain is "
                              "LARGE THEN add +12 m</td>"));
  EXPECT_THAT(page, HasSubstr("asked in 75 % of 12 steps; in 25 % of these"));
  EXPECT_EQ(count_of(page, "<figure>"), 6 + 2 + 1 + 2);
  const std::string fired = between(page, "id=\"correction_1_fired-frame\"", "</svg>");
  EXPECT_EQ(count_of(between(fired, "class=\"dots s0\" d=\"", "\""), "h0"), 2) << "a dot for each rule";
}

TEST(CorrectionPlots, OfOneSetAreThoseOfItsSteps) {
  ResultJson json = corrected(), steps = correction_json();
  for (const char* key : {"network", "size", "base", "reference", "bounds", "kappa", "features", "rules"})
    steps.erase(key);
  ResultJson set = testing::results_json(false);
  set["trackers"]["nfnn"]["details"]["correction"] = steps;
  json["sets"]["family"] = {{"trackers", set["trackers"]}};
  const std::string page = report_page({read(json)});
  EXPECT_EQ(read_markup(page).error, "");
  EXPECT_EQ(count_of(page, "id=\"correction_1_held_back-title\""), 0) << "steps of several sets";
  EXPECT_EQ(count_of(page, "id=\"correction_1_fired-title\""), 1);
  EXPECT_EQ(count_of(page, "id=\"set1_correction_1_held_back-title\""), 1);
}

TEST(CorrectionPlots, HostileWordsStayText) {
  const std::string hostile = "<script>alert(1)</script>";
  ResultJson json = corrected();
  ResultJson& correction = json["trackers"]["nfnn"]["details"]["correction"];
  correction["features"][0]["name"] = correction["rules"][0]["if"] = correction["rules"][0]["add"] = hostile;
  correction["rules"][0]["taught"] = correction["bounds"] = correction["base"] = hostile;
  const std::string page = report_page({read(json)});
  EXPECT_EQ(read_markup(page).error, "");
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(read_markup(page).text, HasSubstr("IF " + hostile + " THEN add " + hostile));
}

TEST(CorrectionPlots, TermsThatAreNotOnePerFeatureAreRefused) {
  ResultJson json = corrected();
  json["trackers"]["nfnn"]["details"]["correction"]["rules"][1]["width"] = {1.0};
  EXPECT_THAT(error_message([&] { read(json); }),
              HasSubstr("trackers.nfnn.details.correction.rules[1]: has terms that are not one per feature"));
}

}  // namespace
}  // namespace truebearing::correction_plots_test
