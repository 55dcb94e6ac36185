// SPDX-License-Identifier: Apache-2.0
// --report and `truebearing report`, as a user calls them.
#include <gtest/gtest.h>

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/app/program_tests.hpp"
#include "tests/support/markup.hpp"

namespace truebearing::app_test::report_test {
namespace {

using testing::count_of;
using testing::read_markup;

// Without what varies.
nlohmann::json results_of(const TemporaryFolder& folder, const std::string& file) {
  nlohmann::json json = nlohmann::json::parse(folder.read(file));
  for (auto& [name, tracker] : json["trackers"].items()) tracker.erase("ns_per_step");
  return json;
}

TEST(Report, CompareDrawsItsResults) {
  const TemporaryFolder folder;
  write_study(folder, tuned_study());
  ASSERT_EQ(run(folder, "compare small.toml --json plain.json --quiet").status, 0);
  const Outcome outcome = run(folder, "compare small.toml --json all.json --report page.html --svg plots --quiet");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string page = folder.read("page.html");
  EXPECT_EQ(read_markup(page).error, "");
  // Two quantities: errors against time, shares of runs and a pair of each; NEES; three runs with their errors.
  EXPECT_EQ(count_of(page, "<figure>"), 13);
  int plots = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "plots")) {
    EXPECT_EQ(read_markup(folder.read("plots/" + entry.path().filename().string())).error, "") << entry.path();
    ++plots;
  }
  EXPECT_EQ(plots, 13);

  nlohmann::json with_details = results_of(folder, "all.json");
  ASSERT_EQ(with_details["pictures"].size(), 3u);
  EXPECT_LE(with_details["pictures"][0]["rmse"], with_details["pictures"][1]["rmse"]) << "best, median, worst";
  EXPECT_LE(with_details["pictures"][1]["rmse"], with_details["pictures"][2]["rmse"]);
  EXPECT_EQ(with_details["trackers"]["tuned"]["details"]["run_rmse"]["position_m"].size(), 20u);
  with_details.erase("pictures");
  for (auto& [name, tracker] : with_details["trackers"].items()) tracker.erase("details");
  EXPECT_EQ(with_details, results_of(folder, "plain.json")) << "a report changes no result";
}

TEST(Report, ResultsThatWereKeptAreDrawnLikeNewOnes) {
  const TemporaryFolder folder;
  write_study(folder, tuned_study());
  ASSERT_EQ(run(folder, "compare small.toml --json small.json --report page.html --quiet").status, 0);
  ASSERT_EQ(run(folder, "report small.json -o again.html").status, 0);
  EXPECT_EQ(folder.read("again.html"), replaced(folder.read("page.html"), "from small (", "from small.json ("));
  const Outcome both = run(folder, "report small.json small.json -o -");
  EXPECT_EQ(both.status, 0) << both.err;
  EXPECT_THAT(both.out, HasSubstr("Side by side"));
}

TEST(Report, TrackAndTmaDrawTheirLogs) {
  const TemporaryFolder folder;
  write_study(folder, tuned_study());
  std::string log = "time_s,position_m,truth_position_m,truth_velocity_mps\n";
  std::string with_sigma = "time_s,position_m,position_sigma_m,truth_position_m,truth_velocity_mps\n";
  std::string bearings = "time_s,bearing_deg,bearing_sigma_deg,sensor_east_m,sensor_north_m\n";
  for (int k = 1; k <= 40; ++k) {
    log += fmt::format("{},{},{},10\n", k, 10 * k + 500 * (k % 3 - 1), 10 * k);
    with_sigma += fmt::format("{},{},400,{},10\n", k, 10 * k, 10 * k);
    const double own_north = k <= 20 ? 50.0 * k : 1000.0, own_east = k <= 20 ? 0.0 : 50.0 * (k - 20);
    const double bearing = std::atan2(8000.0 - 20.0 * k - own_east, 5000.0 - own_north) * 180.0 / std::numbers::pi;
    bearings += fmt::format("{},{:.6f},0.5,{},{}\n", 10 * k, bearing + 0.3 * (k % 3 - 1), own_east, own_north);
  }
  folder.write("log.csv", log);
  folder.write("with_sigma.csv", with_sigma);
  folder.write("bearings.csv", bearings);
  const Outcome tracked = run(folder, "track small.toml log.csv --report track.html");
  ASSERT_EQ(tracked.status, 0) << tracked.err;
  EXPECT_EQ(read_markup(folder.read("track.html")).error, "");
  EXPECT_THAT(folder.read("track.html"), HasSubstr("id=\"run_median-title\""));
  // What the log says without its truth stands beside the errors: innovations and NIS of plain and tuned.
  for (const char* shown : {"id=\"innovations_0-title\"", "id=\"nis_1-title\"", "What the log says without its truth",
                            "40 measurements, of which 0 miss", "Last estimates", "What was not used"})
    EXPECT_THAT(folder.read("track.html"), HasSubstr(shown));

  // A recorded truth is measured afresh; the page tells of the median run, and is made of the JSON alone.
  const Outcome afresh = run(folder,
                             "compare small.toml --truth with_sigma.csv --runs 5 --report truth.html --json truth.json "
                             "--svg truth --quiet");
  ASSERT_EQ(afresh.status, 0) << afresh.err;
  const std::string measured = folder.read("truth.html");
  EXPECT_EQ(read_markup(measured).error, "");
  const nlohmann::json truth = nlohmann::json::parse(folder.read("truth.json"));
  EXPECT_EQ(truth["on_log"]["run"], truth["pictures"][1]["run"]) << "the median";
  EXPECT_THAT(measured, HasSubstr(fmt::format("Of run {}: ", truth["on_log"]["run"].get<int>())));
  EXPECT_THAT(measured, HasSubstr("id=\"innovations_1-title\""));
  EXPECT_EQ(read_markup(folder.read("truth/small_nis_0.svg")).error, "");
  ASSERT_EQ(run(folder, "report truth.json -o again.html").status, 0);
  EXPECT_EQ(folder.read("again.html"), replaced(measured, "from small (", "from truth.json ("));

  // Without its truth there is something to be said too, and the page is made of the JSON alone.
  std::string blind;
  for (std::size_t at = 0; at < log.size(); at = log.find('\n', at) + 1) {
    const std::string row = log.substr(at, log.find('\n', at) - at);
    blind += row.substr(0, row.find(',', row.find(',') + 1)) + "\n";
  }
  folder.write("blind.csv", blind);
  const Outcome blinded = run(folder, "track small.toml blind.csv --report blind.html --json blind.json --svg blind");
  ASSERT_EQ(blinded.status, 0) << blinded.err;
  const std::string page = folder.read("blind.html");
  EXPECT_EQ(read_markup(page).error, "");
  EXPECT_THAT(page, HasSubstr("id=\"tracks-title\""));
  EXPECT_EQ(count_of(page, "<figure>"), 1 + 2 * 2) << "the tracks; innovations and NIS of plain and tuned";
  EXPECT_EQ(read_markup(folder.read("blind/log_tracks.svg")).error, "");
  ASSERT_EQ(run(folder, "report blind.json -o again.html").status, 0);
  EXPECT_EQ(folder.read("again.html"), replaced(page, "from blind.csv (", "from blind.json ("));

  const Outcome solved = run(folder, "tma bearings.csv --report tma.html --svg plots");
  ASSERT_EQ(solved.status, 0) << solved.err;
  EXPECT_EQ(read_markup(folder.read("tma.html")).error, "");
  EXPECT_EQ(count_of(folder.read("tma.html"), "<figure>"), 3);
  EXPECT_EQ(read_markup(folder.read("plots/tma_plane.svg")).error, "");
}

TEST(Report, InputAtFaultIsOneLineThatNamesTheFile) {
  const TemporaryFolder folder;
  folder.write("other.json", "{\"format\": \"other\"}");
  folder.write("broken.json", "{");
  for (const char* file : {"other.json", "broken.json", "nowhere.json"}) {
    const Outcome outcome = run(folder, std::string("report ") + file + " -o page.html");
    EXPECT_EQ(outcome.status, 1) << file;
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(file));
  }
  EXPECT_EQ(run(folder, "report other.json -o other.json").status, 1);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "page.html"));
}

}  // namespace
}  // namespace truebearing::app_test::report_test
