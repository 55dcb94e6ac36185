// SPDX-License-Identifier: Apache-2.0
// A page in a real browser, where Chromium and Python are installed: nothing is logged as an error, every plot has its
// marks, sliders and folds answer, figures are those of the results (tests/look/look.py; `./run look` sees to the rest).
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/result_texts.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/report/page.hpp"

namespace truebearing::browser_test {
namespace {

bool is_installed(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

int look_at(const testing::TemporaryFolder& folder) {
  const std::string at = folder.path().string();
  return std::system(("timeout 120 python3 '" TRUEBEARING_LOOKER "' --page '" + at + "/page.html' '" + at +
                      "/r.json' >'" + at + "/said' 2>&1")
                         .c_str());
}

TEST(Browser, ShowsThePageAsTheResultsSay) {
  if (!is_installed("python3") || !(is_installed("chromium") || is_installed("chromium-browser")))
    GTEST_SKIP() << "there is no Chromium or no Python";
  const testing::TemporaryFolder folder;
  testing::ResultJson json = testing::results_json();
  json["trackers"]["nfnn"]["details"]["correction"] = testing::correction_json();
  folder.write("r.json", json.dump());
  const std::string page = report_page({parse_results(json.dump(), "r.json")});
  folder.write("page.html", page);
  EXPECT_EQ(look_at(folder), 0) << folder.read("said");

  // Another figure in the results than on the page has to be found.
  json["trackers"]["tuned"]["rmse"]["position_m"] = 90.0;
  folder.write("r.json", json.dump());
  EXPECT_NE(look_at(folder), 0) << "a page that says something else";
  EXPECT_NE(folder.read("said").find("of tuned where the results have 90"), std::string::npos) << folder.read("said");
}

}  // namespace
}  // namespace truebearing::browser_test
