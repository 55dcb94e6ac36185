// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/log_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/support/error_message.hpp"
#include "tests/support/markup.hpp"
#include "tests/support/result_texts.hpp"

namespace truebearing::log_page_test {
namespace {

using testing::between;
using testing::count_of;
using testing::error_message;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::read_markup;

using Json = nlohmann::ordered_json;

// Twelve innovations, of which the eleventh is gated; the mean NIS is that of a consistent tracker.
Json tracker(double nis_ratio) {
  Json innovations{{"time_s", Json::array()},
                   {"sigmas", Json::array()},
                   {"nis", Json::array()},
                   {"freedom", Json::array()},
                   {"used", Json::array()}};
  for (int i = 0; i < 12; ++i) {
    innovations["time_s"].push_back(1e9 + i);
    innovations["sigmas"].push_back(i == 10 ? 7.0 : i % 2 == 0 ? 1.0 : -1.0);
    innovations["nis"].push_back(i == 10 ? 49.0 : 1.0);
    innovations["freedom"].push_back(1.0);
    innovations["used"].push_back(i != 10);
  }
  return {{"steps", 12},
          {"nis", {{"steps", 11}, {"ratio", nis_ratio}, {"low", 0.35}, {"high", 2.0}}},
          {"correlation", {{"value", -0.5}, {"limit", 0.6}}},
          {"counts", {{"missing", 1}, {"repeated", 0}, {"late", 0}, {"gated", 1}, {"failed", 0}}},
          {"last", Json::array({{{"track", 0},
                                 {"time_s", 1e9 + 11.0},
                                 {"status", "ok"},
                                 {"estimate", {{"east_m", 110.0}, {"north_m", 20.0}}},
                                 {"standard_deviation", {{"east_m", 5.0}, {"north_m", 6.0}}}}})},
          {"innovations", innovations},
          {"not_used", Json::array({{{"time_s", 1e9 + 3.5}, {"why", "missing"}, {"nis", nullptr}},
                                    {{"time_s", 1e9 + 10.0}, {"why", "gated"}, {"nis", 49.0}}})}};
}

Json log_of(const std::string& log = "log.csv") {
  Json json{{"study", "a study"},
            {"log", log},
            {"version", "0.1.0"},
            {"measurements", 13},
            {"missing", 1},
            {"repeated", 0},
            {"warnings", {"plain: too large"}}};
  json["trackers"]["tuned"] = tracker(1.0);
  json["trackers"]["plain"] = tracker(3.0);
  json["events"] =
      Json::array({{{"tracker", "tuned"}, {"time_s", 1e9 + 5.0}, {"event", "turn_began"}, {"value", nullptr}}});
  const Json line{
      {"track", 0}, {"time_s", {1e9, 1e9 + 4.0, 1e9 + 11.0}}, {"x", {0.0, 40.0, 110.0}}, {"y", {0.0, 10.0, 20.0}}};
  Json track{{"tracker", "tuned"}};
  track.update(line);
  for (const char* column : {"xx", "xy", "yy"}) track[column] = {25.0, 25.0, 25.0};
  json["picture"] = {
      {"which", ""}, {"run", 0},      {"judged_by", ""},        {"quantity", ""},   {"rmse", 0},
      {"every", 1},  {"plane", true}, {"truth", Json::array()}, {"measured", line}, {"tracks", Json::array({track})}};
  return json;
}

TEST(LogPage, ShowsTracksInnovationsEventsAndWhatWasNotUsed) {
  const std::string page = log_page(log_of().dump(), "a.json");
  EXPECT_EQ(read_markup(page).error, "");
  EXPECT_EQ(count_of(page, "<figure>"), 1 + 2 * 2);
  const std::string plane = between(page, "id=\"tracks-frame\"", "</svg>");
  EXPECT_EQ(count_of(between(plane, "class=\"dots measured\" d=\"", "\""), "h0"), 3);
  EXPECT_EQ(count_of(between(plane, "class=\"dots event\" d=\"", "\""), "h0"), 1);
  EXPECT_THAT(plane, HasSubstr("data-times=\"0 4 11\"")) << "counted from the first";
  const std::string innovations = between(page, "id=\"innovations_0-frame\"", "</svg>");
  EXPECT_EQ(count_of(between(innovations, "class=\"dots s0\" d=\"", "\""), "h0"), 11);
  EXPECT_EQ(count_of(between(innovations, "class=\"dots s1\" d=\"", "\""), "h0"), 1) << "the gated one";
  EXPECT_EQ(count_of(between(innovations, "class=\"line event\" d=\"", "\""), "M"), 1);
  EXPECT_EQ(count_of(between(page, "id=\"innovations_1-frame\"", "</svg>"), "line event"), 0) << "it noticed nothing";
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\">tuned</th><td>turn began</td>"));
  EXPECT_THAT(page, HasSubstr("<td>gated</td><td>outside the gate</td><td>49</td>"));
  EXPECT_THAT(page, HasSubstr("<td>missing</td><td>holds no value</td><td>-</td>"));
  EXPECT_THAT(page, HasSubstr("plain: too large"));
  EXPECT_THAT(page, HasSubstr("110 <span class=\"se\">± 5</span>"));
  EXPECT_THAT(
      page,
      HasSubstr("<td>1</td><td>0.35 to 2</td><td class=\"words\">consistent</td><td>−0.5</td><td>−0.6 to 0.6</td>"));
}

TEST(LogPage, SaysWhoForetellsBest) {
  EXPECT_THAT(log_page(log_of().dump(), "a.json"), Not(HasSubstr("Who foretells best"))) << "nothing was foretold";
  Json json = log_of();
  const Json best{
      {"rmse", 40.5}, {"rmse_se", 1.25}, {"squared_above_best", 0}, {"squared_above_best_se", 0}, {"mean_gate", 0.01}},
      other{{"rmse", 50.0},
            {"rmse_se", 2.0},
            {"squared_above_best", 860.0},
            {"squared_above_best_se", 215.0},
            {"mean_gate", nullptr}};
  json["foretelling"] = Json::array({{{"track", 4},
                                      {"steps", 3},
                                      {"quantity", "position_m"},
                                      {"measurements", 66},
                                      {"best", "tuned"},
                                      {"says", "tuned <foretells> best"},
                                      {"trackers", {{"tuned", best}, {"plain", other}}},
                                      {"left_out", {"raw"}}}});
  const std::string page = log_page(json.dump(), "a.json");
  EXPECT_EQ(read_markup(page).error, "");
  const std::string told = between(page, "<h2>Who foretells best</h2>", "<h2>");
  EXPECT_THAT(told, HasSubstr("<p>tuned &lt;foretells&gt; best.</p>"));
  EXPECT_THAT(
      told, HasSubstr("<th scope=\"col\">position RMSE (m)</th><th scope=\"col\">squared, above the best (m^2)</th>"));
  EXPECT_THAT(told,
              HasSubstr("tuned<span class=\"tag\">best</span></th><td>40.5 <span class=\"se\">± 1.2</span></td>"));
  EXPECT_THAT(told, HasSubstr("<td>860 <span class=\"se\">± 220</span></td><td>4</td>"));
  EXPECT_THAT(told, HasSubstr("66 measurements, each 3 of the trackers' steps ahead"));
  EXPECT_THAT(told, HasSubstr("raw has no estimate where measurements are hidden."));
  EXPECT_THAT(told, HasSubstr("tuned: its gate is shut"));
  EXPECT_EQ(count_of(told, "its gate is shut"), 1) << "the other is no correction";
  EXPECT_EQ(count_of(told, "<h3>"), 0) << "of the one track";
  json["foretelling"].push_back(json["foretelling"][0]);
  EXPECT_EQ(count_of(log_page(json.dump(), "a.json"), "<h3>Track 4</h3>"), 2);
  json["foretelling"][0]["trackers"]["plain"].erase("rmse");
  EXPECT_THAT(error_message([&] { log_page(json.dump(), "a.json"); }),
              HasSubstr("a.json: foretelling[0].trackers.plain: has no \"rmse\""));
}

TEST(LogPage, SaysWhoIsConsistentByItsNis) {
  EXPECT_EQ(log_answer(parse_log_results(log_of().dump(), "a.json")),
            "Innovations as large as claimed: tuned. Innovations larger than claimed: plain.");
  Json json = log_of();
  json["trackers"].erase("plain");
  json["trackers"]["tuned"]["nis"] = {{"steps", 0}, {"ratio", nullptr}, {"low", nullptr}, {"high", nullptr}};
  json["trackers"]["tuned"]["no_track"] = "its start <needs> a guess";
  EXPECT_EQ(log_answer(parse_log_results(json.dump(), "a.json")),
            "No tracker has innovations by which it could be judged.");
  EXPECT_THAT(log_page(json.dump(), "a.json"), HasSubstr("tuned began no track: its start &lt;needs&gt; a guess"));
}

// As results hold it: without a picture of tracks, which stand beside their truth there.
Json results_of_log() {
  Json json = testing::results_json();
  json["on_log"] = log_of();
  json["on_log"].erase("picture");
  return json;
}

TEST(LogPage, OfALogWithTruthShowsTheSameBesideItsErrors) {
  EXPECT_EQ(parse_results(testing::results_json().dump(), "a.json").on_log, nullptr);
  EXPECT_EQ(on_log_section(parse_results(testing::results_json().dump(), "a.json"), ""), "");
  const std::string page = report_page({parse_results(results_of_log().dump(), "a.json")});
  EXPECT_EQ(read_markup(page).error, "");
  EXPECT_THAT(page, HasSubstr("<h2>What the log says without its truth</h2>\n<p>13 measurements, of which 1 miss; 0 "
                              "repeated rows dropped.</p>"));
  for (const char* id : {"innovations_0", "nis_0", "innovations_1", "nis_1"})
    EXPECT_EQ(count_of(page, fmt::format("id=\"{}-frame\"", id)), 1) << id;
  EXPECT_EQ(count_of(page, "id=\"tracks-frame\""), 0);
  EXPECT_THAT(page, HasSubstr("<td>gated</td><td>outside the gate</td><td>49</td>"));
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\">tuned</th><td>turn began</td>"));
  EXPECT_THAT(page, HasSubstr("plain: too large"));
  EXPECT_THAT(page, HasSubstr("<h3>What was not used</h3>"));
}

TEST(LogPage, OfARunSaysWhichAndOfFilesSideBySideIsOfEach) {
  Json json = results_of_log();
  json["on_log"]["run"] = 1;
  const Results results = parse_results(json.dump(), "a.json");
  EXPECT_THAT(on_log_section(results, ""), HasSubstr("<p>Of run 1: 13 measurements"));
  const std::string page = report_page({results, results});
  EXPECT_EQ(count_of(page, "id=\"file1_nis_0-frame\""), 1);
  EXPECT_EQ(count_of(page, "id=\"file2_nis_0-frame\""), 1);
  json["on_log"]["trackers"]["tuned"].erase("counts");
  EXPECT_THAT(error_message([&] { parse_results(json.dump(), "a.json"); }),
              HasSubstr("a.json: on_log.trackers.tuned: has no \"counts\""));
}

TEST(LogPage, WithoutRejectionsSaysSo) {
  Json json = log_of();
  for (auto& [name, one] : json["trackers"].items()) one["not_used"] = Json::array();
  EXPECT_THAT(log_page(json.dump(), "a.json"), HasSubstr("Every measurement was used by every tracker."));
}

TEST(LogPage, LongListsAreScrolled) {
  Json json = log_of();
  EXPECT_THAT(log_page(json.dump(), "a.json"), Not(HasSubstr("class=\"wide long\"")));
  for (int k = 0; k < 20; ++k) json["events"].push_back(json["events"][0]);
  EXPECT_EQ(count_of(log_page(json.dump(), "a.json"), "class=\"wide long\""), 1) << "the events";
}

TEST(LogPage, HostileNamesStayText) {
  const std::string hostile = "<script>alert(1)</script>";
  Json json = log_of(hostile);
  json["study"] = json["events"][0]["event"] = json["warnings"][0] = hostile;
  json["trackers"][hostile] = json["trackers"]["plain"];
  json["trackers"][hostile]["not_used"][0]["why"] = json["trackers"][hostile]["last"][0]["status"] = hostile;
  const std::string page = log_page(json.dump(), hostile);
  EXPECT_EQ(read_markup(page).error, "");
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
}

TEST(LogPage, InputAtFaultSaysWhichFileAndWhere) {
  Json json = log_of();
  json["trackers"]["tuned"]["innovations"]["nis"] = {1.0};
  EXPECT_THAT(error_message([&] { log_page(json.dump(), "a.json"); }),
              HasSubstr("a.json: trackers.tuned.innovations: has columns of unequal length"));
  json = log_of();
  json["trackers"]["tuned"]["innovations"]["used"][0] = 3;
  EXPECT_THAT(error_message([&] { log_page(json.dump(), "a.json"); }), HasSubstr("is neither true nor false"));
  EXPECT_TRUE(is_log_results(log_of().dump(), "a.json"));
  EXPECT_FALSE(is_log_results("{\"study\": \"s\"}", "a.json"));
}

}  // namespace
}  // namespace truebearing::log_page_test
