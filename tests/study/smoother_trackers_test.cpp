// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/smoother_trackers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "tests/support/radar_study.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/study/study.hpp"
#include "truebearing/tracker/smoothing_tracker.hpp"

namespace truebearing::smoother_trackers_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::error_message;
using ::testing::HasSubstr;
using testing::kStudy;
using testing::radar_log;
using testing::replaced;
using testing::TemporaryFolder;
using testing::write_study;

const std::string kSmoother = "\n[trackers.smooth]\nkind = \"smoother\"\nof = \"tuned\"\n";

std::string refusal(const std::string& study) {
  const TemporaryFolder folder;
  const std::filesystem::path path = write_study(folder, study);
  return error_message([&] { Study::load(path); });
}

std::vector<StepRecord> records_of(Tracker& tracker, const std::vector<Measurement>& log) {
  std::vector<StepRecord> records;
  tracker.reset();
  tracker.foresee(log);
  for (const Measurement& measurement : log) records.push_back(tracker.step(measurement).front());
  return records;
}

TEST(SmootherTrackers, IsOfTheFilterWithItsTunedNumbers) {
  const TemporaryFolder folder;
  const Study study = Study::load(write_study(folder, kStudy + kSmoother + "lag_s = 4.0\n"));
  const auto made = study.make_tracker("smooth");
  auto filter = study.make_tracker("tuned");
  SmoothingTracker expected(std::unique_ptr<FilterTracker>(dynamic_cast<FilterTracker*>(filter.release())), 4.0);
  const std::vector<Measurement> log = radar_log(0, 20);
  const std::vector<StepRecord> records = records_of(*made, log), wanted = records_of(expected, log);
  for (std::size_t k = 0; k < log.size(); ++k) EXPECT_EQ(records[k].x, wanted[k].x);
  EXPECT_THAT(study.configuration_line("smooth"),
              AllOf(HasSubstr("smoother"), HasSubstr("lag_s"), HasSubstr("of kalman"), HasSubstr("53000")));
  EXPECT_TRUE(study.looks_back());
  EXPECT_FALSE(Study::load(write_study(folder)).looks_back());
}

TEST(SmootherTrackers, WhatCannotBeIsRefusedWhenTheStudyIsRead) {
  EXPECT_THAT(refusal(kStudy + kSmoother), "no error");
  const auto with = [](const std::string& from, const std::string& to) {
    return refusal(kStudy + replaced(kSmoother, from, to));
  };
  EXPECT_THAT(with("\"tuned\"", "\"tund\""), AllOf(HasSubstr("trackers.smooth.of"), HasSubstr("\"tuned\"")));
  EXPECT_THAT(with("of = \"tuned\"", ""), HasSubstr("of"));
  EXPECT_THAT(with("\"tuned\"", "\"nfnn\""), HasSubstr("is no filter"));
  EXPECT_THAT(with("\"tuned\"", "\"smooth\""), HasSubstr("is no filter"));
  EXPECT_THAT(with("\"tuned\"", "\"tuned\"\nlag_s = 0"), HasSubstr("lag_s"));
  EXPECT_THAT(with("\"tuned\"", "\"tuned\"\nlags = 1"), HasSubstr("did you mean \"lag_s\""));
  EXPECT_THAT(with("\"tuned\"", "\"tuned\"\nlag_s = 1.0\ntune = [\"lag_s\"]"), HasSubstr("`tune` of that"));
  EXPECT_THAT(refusal(kStudy + replaced(kSmoother, "\"tuned\"", "\"ahead\"") +
                      "\n[trackers.ahead]\nlike = \"plain\"\nahead_s = 1.0\n"),
              AllOf(HasSubstr("trackers.smooth.of"), HasSubstr("no smoother of"), HasSubstr("ahead_s")));
}

TEST(SmootherTrackers, NoCorrectionLooksAtOne) {
  const std::string looking = replaced(kStudy, "companion = \"wide\"", "companion = \"smooth\"");
  EXPECT_THAT(refusal(looking + kSmoother), AllOf(HasSubstr("trackers.nfnn"), HasSubstr("yet to be measured")));
}

TEST(SmootherTrackers, OneTeachesInPlaceOfTheTruth) {
  const std::string taught = replaced(kStudy, "rules = 4", "rules = 4\nteacher = \"smooth\"");
  EXPECT_EQ(refusal(taught + kSmoother), "no error");
  EXPECT_THAT(refusal(taught), AllOf(HasSubstr("training.teacher"), HasSubstr("no smoother")));
  EXPECT_THAT(refusal(replaced(taught, "\"smooth\"", "\"smoth\"") + kSmoother), HasSubstr("\"smooth\""));
  EXPECT_THAT(refusal(replaced(taught, "rules = 4", "rules = 4\nleave_out_beyond = { position_m = 1.0 }") + kSmoother),
              HasSubstr("leave_out_beyond"));
}

TEST(SmootherTrackers, SmoothAllShowsTheSmoothersOfWhatHasOne) {
  const TemporaryFolder folder;
  Study study = Study::load(write_study(folder, kStudy + kSmoother));
  std::vector<std::string> left_out;
  study.smooth_all(kInfinity, [&](const std::string& name) { left_out.push_back(name); });
  std::vector<std::string> shown;
  for (const TrackerSpec& spec : study.trackers())
    if (spec.shown) shown.push_back(spec.name);
  EXPECT_THAT(shown, ElementsAre("smooth", "plain_smoothed", "tuned_smoothed"));
  EXPECT_THAT(left_out, ElementsAre("nfnn"));
  EXPECT_TRUE(study.pairs().empty());
  EXPECT_EQ(study.make_tracker_set().size(), 3);
}

}  // namespace
}  // namespace truebearing::smoother_trackers_test
