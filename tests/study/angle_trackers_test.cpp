// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/angle_trackers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/angle_runs.hpp"
#include "tests/support/angle_trackers.hpp"
#include "tests/support/error_message.hpp"
#include "truebearing/study/tracker_registry.hpp"

namespace truebearing::angle_trackers_test {
namespace {

using testing::array_run;
using testing::error_message;
using ::testing::HasSubstr;
using testing::joint_options;
using testing::paper_options;
using testing::track;

const std::string kPaper = "targets = 5\nq_deg2ps3 = 1.0\nsigma_deg = 2.0\n";
const std::string kMotion =
    "motion = { q_deg2ps3 = 0.001, q_low_deg2ps3 = 0.001, q_high_deg2ps3 = 1.0, log_power_variance_per_s = 0.001 }\n";
const std::string kJoint = "targets = 5\nnoise_power = 1.0\nrate_sigma_degps = 2.0\n" + kMotion;

std::unique_ptr<Tracker> make(const std::string& kind, const std::string& text) {
  const SharedTable table = parse_toml(text, "study.toml");
  TableReader reader(table, "study.toml", "trackers.mine");
  return make_tracker(kind, reader);
}

// That a tracker of a study does the same, bit for bit, as one with these options.
void expect_same(const std::unique_ptr<Tracker>& of_study, Tracker&& expected, const Recording& recording,
                 const std::string& what) {
  const testing::Published one = track(*of_study, recording.measurements),
                           two = track(expected, recording.measurements);
  for (std::size_t k = 0; k < one.size(); ++k) {
    ASSERT_EQ(one[k].size(), two[k].size()) << what;
    for (std::size_t n = 0; n < one[k].size(); ++n) {
      EXPECT_EQ(one[k][n].x, two[k][n].x) << what;
      EXPECT_EQ(one[k][n].P, two[k][n].P) << what;
    }
  }
}

Recording short_run() {
  Recording recording = array_run("array_a_10db");
  recording.measurements.resize(12);
  return recording;
}

TEST(AngleTrackersOfStudies, SubspaceAnglesReadAllTheirKeys) {
  const Recording recording = short_run();
  SubspaceAngleOptions options = paper_options();
  expect_same(make("subspace_angles", kPaper), SubspaceAngleTracker(options), recording, "paper");
  options.beta = 0.93;
  options.innovation = SubspaceAngleOptions::Innovation::ryu;
  options.lag_intervals = 0.27;
  expect_same(make("subspace_angles",
                   kPaper + "subspace = \"past\"\nbeta = 0.93\ninnovation = \"ryu\"\nlag_intervals = 0.27\n"),
              SubspaceAngleTracker(options), recording, "lag");
  options = paper_options();
  options.subspace = SubspaceAngleOptions::Subspace::orthogonal_iteration;
  options.innovation = SubspaceAngleOptions::Innovation::projection;
  options.inflate_within_rad = radians(3.0);
  expect_same(make("subspace_angles", kPaper + "subspace = \"orthogonal_iteration\"\ninnovation = \"projection\"\n"
                                               "inflate_within_deg = 3.0\n"),
              SubspaceAngleTracker(options), recording, "inflated");
  options = paper_options();
  options.subspace = SubspaceAngleOptions::Subspace::eigenvectors;
  options.sigma_from_subspace = true;
  expect_same(make("subspace_angles", kPaper + "subspace = \"eigenvectors\"\nsigma_from_subspace = true\n"),
              SubspaceAngleTracker(options), recording, "eigenvectors");
}

TEST(AngleTrackersOfStudies, JointAnglesReadAllTheirKeys) {
  const Recording recording = short_run();
  JointAngleOptions options = joint_options();
  expect_same(make("joint_angles", kJoint), JointAngleTracker(options), recording, "joint");
  options.hypotheses.update.iterations = 2;
  options.hypotheses.beam = 1;
  options.moving_blocks = 3;
  expect_same(make("joint_angles", kJoint + "iterations = 2\nbeam = 1\nmoving_blocks = 3\n"),
              JointAngleTracker(options), recording, "blocks");
  options = joint_options();
  options.noise_power.reset();
  options.noise_alpha = 0.2;
  options.hypotheses.motion.q_low = options.hypotheses.motion.q_high = options.hypotheses.motion.q0;
  expect_same(make("joint_angles",
                   "targets = 5\nrate_sigma_degps = 2.0\nnoise_alpha = 0.2\n"
                   "motion = { q_deg2ps3 = 0.001, log_power_variance_per_s = 0.001 }\n"),
              JointAngleTracker(options), recording, "constant q");
  options = joint_options(2);
  options.lifetimes = JointAngleOptions::Lifetimes{20.0, 1, 5.0, 3};
  expect_same(make("joint_angles", "targets = 2\nnoise_power = 1.0\nrate_sigma_degps = 2.0\n" + kMotion +
                                       "lifetimes = { begin_presence = 20.0, begin_hits = 1, end_presence = 5.0, "
                                       "end_misses = 3 }\n"),
              JointAngleTracker(options), recording, "lifetimes");
}

TEST(AngleTrackersOfStudies, CountTargetsByEitherCriterion) {
  const Recording recording = short_run();
  for (const auto& [name, criterion] :
       {std::pair("mdl", OrderCriterion::minimum_description_length), std::pair("aic", OrderCriterion::akaike)}) {
    const std::string targets = "targets = \"" + std::string(name) + "\"\n";
    SubspaceAngleOptions paper = paper_options();
    paper.targets = criterion;
    expect_same(make("subspace_angles", targets + "q_deg2ps3 = 1.0\nsigma_deg = 2.0\n"), SubspaceAngleTracker(paper),
                recording, name);
    JointAngleOptions joint = joint_options();
    joint.targets = criterion;
    expect_same(make("joint_angles", targets + "noise_power = 1.0\nrate_sigma_degps = 2.0\n" + kMotion),
                JointAngleTracker(joint), recording, name);
  }
}

TEST(AngleTrackersOfStudies, RefuseWhatTheyDoNotKnow) {
  const auto refusal = [](const std::string& kind, const std::string& text) {
    return error_message([&] { make(kind, text); });
  };
  const auto subspace = [&](const std::string& text) { return refusal("subspace_angles", text); };
  const auto joint = [&](const std::string& text) { return refusal("joint_angles", text); };
  EXPECT_EQ(subspace(kPaper), "no error");
  EXPECT_EQ(joint(kJoint), "no error");
  EXPECT_THAT(refusal("joint_angle", kJoint), HasSubstr("joint_angles"));
  EXPECT_THAT(subspace(kPaper + "lag_interval = 0.3\n"), HasSubstr("lag_intervals"));
  EXPECT_THAT(subspace("q_deg2ps3 = 1.0\nsigma_deg = 2.0\n"), HasSubstr("trackers.mine.targets"));
  EXPECT_THAT(subspace("targets = 0\nq_deg2ps3 = 1.0\nsigma_deg = 2.0\n"), HasSubstr("targets"));
  EXPECT_THAT(subspace("targets = \"mld\"\nq_deg2ps3 = 1.0\nsigma_deg = 2.0\n"), HasSubstr("mdl"));
  EXPECT_THAT(subspace(kPaper + "subspace = \"music\"\n"), HasSubstr("orthogonal_iteration"));
  EXPECT_THAT(subspace(kPaper + "innovation = \"literal\"\n"), HasSubstr("projection"));
  EXPECT_THAT(subspace(kPaper + "beta = 1.5\n"), HasSubstr("beta"));
  // A forgetting factor is PAST's alone.
  EXPECT_THAT(subspace(kPaper + "subspace = \"eigenvectors\"\nbeta = 0.9\n"), HasSubstr("beta"));
  EXPECT_THAT(subspace("targets = 5\nq_deg2ps3 = 0.0\nsigma_deg = 2.0\n"), HasSubstr("q_deg2ps3"));
  EXPECT_THAT(joint("targets = 5\nrate_sigma_degps = 2.0\n"), HasSubstr("motion"));
  EXPECT_THAT(joint("targets = 13\nrate_sigma_degps = 2.0\n" + kMotion), HasSubstr("targets"));
  EXPECT_THAT(joint("targets = 0\nrate_sigma_degps = 2.0\n" + kMotion), HasSubstr("targets"));
  EXPECT_EQ(joint("targets = 0\nrate_sigma_degps = 2.0\n" + kMotion + "lifetimes = {}\n"), "no error");
  EXPECT_THAT(joint(kJoint + "iterations = 1\n"), HasSubstr("iterations"));
  EXPECT_THAT(joint(kJoint + "beam = 0\n"), HasSubstr("beam"));
  EXPECT_THAT(joint(kJoint + "lifetimes = { begin_hit = 2 }\n"), HasSubstr("begin_hits"));
  EXPECT_THAT(joint(kJoint + "lifetimes = { begin_hits = 4 }\n"), HasSubstr("begin_hits"));
  EXPECT_THAT(joint("targets = 5\nrate_sigma_degps = 2.0\n"
                    "motion = { q_deg2ps3 = 0.1, q_low_deg2ps3 = 1.0, q_high_deg2ps3 = 0.5 }\n"),
              HasSubstr("q_low_deg2ps3"));
  EXPECT_THAT(joint("targets = 5\nrate_sigma_degps = 2.0\nmotion = { q_deg2ps3 = 0.1, q_low_deg2ps3 = 1.0 }\n"),
              HasSubstr("q_high_deg2ps3"));
  EXPECT_THAT(joint("targets = 5\nrate_sigma_degps = 2.0\nmotion = { q_degps3 = 0.1 }\n"), HasSubstr("q_deg2ps3"));
}

}  // namespace
}  // namespace truebearing::angle_trackers_test
