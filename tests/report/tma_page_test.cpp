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
