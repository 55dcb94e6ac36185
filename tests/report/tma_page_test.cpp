// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/tma_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/error_message.hpp"
#include "tests/support/markup.hpp"

namespace truebearing::tma_page_test {
namespace {

using testing::between;
using testing::count_of;
using testing::error_message;
using ::testing::HasSubstr;
using testing::read_markup;

using Json = nlohmann::ordered_json;

Json motion(double east_m) {
  return {{"range_m", 5000.0}, {"bearing_deg", 10.0}, {"course_deg", 90.0}, {"speed_mps", 5.0},
          {"east_m", east_m},  {"north_m", 4000.0},   {"east_mps", 5.0},    {"north_mps", 0.0}};
}

Json answer() {
  return {{"verdict", "range 5000 m <of> 1"},
          {"causes", Json::array({{{"kind", "manoeuvre"}, {"says", "it turned"}}})},
          {"log", "log.csv"},
          {"method", "ml"},
          {"bearings", 3},
          {"from_s", 0.0},
          {"time_s", 100.0},
          {"estimate", motion(3000.0)},
          {"standard_deviation", {{"range_m", 210.0}}},
          {"covariance", {{1e4, 0, 0, 0}, {0, 4e4, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}},
          {"outliers", {{"bearings", Json::array({{{"time_s", 50.0}}})}}},
          {"ambiguities", Json::array()},
          {"hypotheses", Json::array()},
          {"details",
           {{"time_s", {0.0, 50.0, 100.0}},
            {"own_east_m", {0.0, 200.0, 400.0}},
            {"own_north_m", {0.0, 0.0, 100.0}},
            {"bearing_deg", {8.0, 9.0, 10.0}},
            {"residual_sigmas", {0.1, 6.0, -0.3}}}}};
}

TEST(TmaPage, ShowsGeometryAndResiduals) {
  const std::string page = tma_page(answer().dump(), "a.json");
  EXPECT_EQ(read_markup(page).error, "");
  EXPECT_THAT(read_markup(page).text, HasSubstr("range 5000 m <of> 1"));
  EXPECT_THAT(page, HasSubstr("<td>5000 <span class=\"se\">± 210</span></td><td>m</td>"));
  EXPECT_THAT(page, HasSubstr("<li>it turned</li>"));
  EXPECT_EQ(count_of(page, "<figure>"), 2);
  const std::string plane = between(page, "id=\"plane-frame\"", "</svg>");
  EXPECT_EQ(count_of(between(plane, "class=\"sight measured\" d=\"", "\""), "M"), 3);
  EXPECT_EQ(count_of(plane, "<ellipse "), 1);
  const std::string residuals = between(page, "id=\"residuals-frame\"", "</svg>");
  EXPECT_EQ(count_of(between(residuals, "class=\"dots s0\" d=\"", "\""), "h0"), 3);
  EXPECT_EQ(count_of(between(residuals, "class=\"dots s1\" d=\"", "\""), "h0"), 1) << "the outlier";
}

// Twenty bearings: the first ten err twice as much as they claim.
TEST(TmaPage, HoldsResidualsToWhatTheyClaim) {
  Json json = answer();
  Json columns{{"time_s", Json::array()},
               {"own_east_m", Json::array()},
               {"own_north_m", Json::array()},
               {"bearing_deg", Json::array()},
               {"residual_sigmas", Json::array()}};
  for (int i = 0; i < 20; ++i) {
    columns["time_s"].push_back(i);
    columns["own_east_m"].push_back(10.0 * i);
    columns["own_north_m"].push_back(0.0);
    columns["bearing_deg"].push_back(8.0);
    columns["residual_sigmas"].push_back((i % 2 == 0 ? 1.0 : -1.0) * (i < 10 ? 2.0 : 1.0));
  }
  json["details"] = columns;
  json["residuals"] = {{"chi_square", 50.0}, {"degrees_of_freedom", 16}, {"lag_one_sigmas", -4.4}};
  const std::vector<Plot> plots = tma_plots(json.dump(), "a.json");
  ASSERT_EQ(plots.size(), 3u);
  EXPECT_EQ(plots[2].series.back().y, (std::vector<double>{4.0, 4.0, 1.0, 1.0})) << "means over five";
  EXPECT_EQ(plots[2].summary, "2 of 4 means are inside.");
  const std::string page = tma_page(json.dump(), "a.json");
  EXPECT_THAT(page, HasSubstr("<td>3.125</td><td>0.4317 to 1.803</td><td>too large</td>"));
  EXPECT_THAT(page, HasSubstr("<td>−4.4</td><td>−1.96 to 1.96</td><td>not white</td>"));
}

TEST(TmaPage, SaysWhatWasRejectedAndWhatHappened) {
  Json json = answer();
  json["missing"] = 2;
  json["outliers"]["bearings"] = Json::array({{{"time_s", 50.0}, {"line", 7}, {"sigmas", 6.25}, {"or_line", 8}}});
  json["manoeuvre"] = {{"detected", true},
                       {"time_s", 60.0},
                       {"earliest_s", 55.0},
                       {"latest_s", 65.0},
                       {"stretches", Json::array({{{"from_s", 0.0}, {"to_s", 60.0}, {"estimate", motion(1.0)}},
                                                  {{"from_s", 60.0}, {"to_s", 100.0}, {"estimate", nullptr}}})}};
  const std::string page = tma_page(json.dump(), "a.json");
  EXPECT_EQ(read_markup(page).error, "");
  EXPECT_THAT(page,
              HasSubstr("<td>7</td><td>6.25 standard deviations off what the others say; or line 8 in its stead</td>"));
  EXPECT_THAT(page, HasSubstr("2 rows hold no bearing."));
  EXPECT_THAT(page, HasSubstr("<td>between 55 and 65 s</td>"));
  EXPECT_THAT(page, HasSubstr("<td>5000 m, course 90 deg, 5 m/s</td>"));
  EXPECT_THAT(page, HasSubstr("<td>range not determined</td>"));
  json["outliers"]["bearings"] = Json::array();
  json["manoeuvre"]["detected"] = false;
  const std::string quiet = tma_page(json.dump(), "a.json");
  EXPECT_THAT(quiet, HasSubstr("No bearing stands out from the others."));
  EXPECT_EQ(count_of(quiet, "What happened"), 0);
}

TEST(TmaPage, DrawsWhatIsPossibleWhereTheRangeIsOpen) {
  Json open = answer();
  for (auto& [key, value] : open["estimate"].items()) value = nullptr;
  for (Json& row : open["covariance"]) row = {nullptr, nullptr, nullptr, nullptr};
  open["hypotheses"] = {motion(1000.0), motion(2000.0)};
  const std::string plane = between(tma_page(open.dump(), "a.json"), "id=\"plane-frame\"", "</svg>");
  EXPECT_EQ(count_of(plane, "class=\"line s1\""), 2);
  EXPECT_EQ(count_of(plane, "<ellipse "), 0);
}

TEST(TmaPage, InputAtFaultSaysWhichFile) {
  Json json = answer();
  json.erase("details");
  EXPECT_THAT(error_message([&] { tma_page(json.dump(), "a.json"); }), HasSubstr("a.json: has no \"details\""));
  json = answer();
  json["details"]["bearing_deg"] = {1.0};
  EXPECT_THAT(error_message([&] { tma_page(json.dump(), "a.json"); }), HasSubstr("unequal length"));
}

}  // namespace
}  // namespace truebearing::tma_page_test
