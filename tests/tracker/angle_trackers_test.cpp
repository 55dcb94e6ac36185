// SPDX-License-Identifier: Apache-2.0
// What trackers of angles have in common: what they make of missing and broken intervals, and symmetries.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <functional>

#include "tests/support/allocation_count.hpp"
#include "tests/support/angle_runs.hpp"
#include "tests/support/angle_trackers.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::angle_trackers_test {
namespace {

using testing::angle_errors;
using testing::array_run;
using testing::ArrayScene;
using testing::changed;
using testing::joint_options;
using testing::paper_options;
using testing::Published;
using testing::recording_of;
using testing::scene_of;
using testing::track;

struct Kind {
  const char* name;
  std::function<std::unique_ptr<Tracker>(int targets)> make;
  double bar_deg2;  // mean squared error on A at 10 dB, of the problem's tables
};

std::unique_ptr<Tracker> subspace(int targets, SubspaceAngleOptions::Subspace kind) {
  SubspaceAngleOptions options = paper_options(targets);
  options.subspace = kind;
  return std::make_unique<SubspaceAngleTracker>(options);
}

const std::vector<Kind>& kinds() {
  using Subspace = SubspaceAngleOptions::Subspace;
  static const std::vector<Kind> all{
      {"joint", [](int targets) { return std::make_unique<JointAngleTracker>(joint_options(targets)); }, 0.0062},
      {"past", [](int targets) { return subspace(targets, Subspace::projection_approximation); }, 0.136},
      {"orthogonal iteration", [](int targets) { return subspace(targets, Subspace::orthogonal_iteration); }, 0.04},
      {"eigenvectors", [](int targets) { return subspace(targets, Subspace::eigenvectors); }, 0.04},
  };
  return all;
}

Recording three_targets(int intervals, std::uint64_t run = 0) {
  Recording recording = recording_of(intervals, run, [](int k) { return scene_of({-40.0 + 0.5 * k, 0.0, 40.0}); });
  for (int n = 0; n < 3; ++n) {
    recording.truth.push_back({.track = n, .x = {}, .phase = {}});
    for (int k = 0; k < intervals; ++k)
      recording.truth.back().x.emplace_back(
          Eigen::Vector2d(radians(n == 0 ? -40.0 + 0.5 * k : 40.0 * (n - 1)), n == 0 ? radians(0.5) : 0.0));
  }
  return recording;
}

void expect_same(const std::vector<StepRecord>& a, const std::vector<StepRecord>& b, const std::string& where) {
  ASSERT_EQ(a.size(), b.size()) << where;
  for (std::size_t n = 0; n < a.size(); ++n) {
    EXPECT_EQ(a[n].track, b[n].track) << where;
    EXPECT_EQ(a[n].x, b[n].x) << where;
    EXPECT_EQ(a[n].P, b[n].P) << where;
    EXPECT_EQ(a[n].status, b[n].status) << where;
  }
}

TEST(AngleTrackers, FollowFiveTargetsThatCross) {
  for (const Kind& kind : kinds()) {
    double mse_deg2 = 0.0;
    constexpr std::uint64_t kRuns = 5;
    for (std::uint64_t run = 0; run < kRuns; ++run) {
      const Recording recording = array_run("array_a_10db", run);
      const auto tracker = kind.make(5);
      const Published published = track(*tracker, recording.measurements);
      for (std::size_t k = 3; k < published.size(); ++k) {
        ASSERT_EQ(published[k].size(), 5u) << kind.name;
        for (const StepRecord& record : published[k]) {
          EXPECT_EQ(record.status, StepStatus::ok) << kind.name;
          EXPECT_TRUE(is_covariance(record.P)) << kind.name;
          ASSERT_TRUE(record.innovation && record.gain && record.prediction && record.neighbour);
          EXPECT_GT(record.innovation->S(0, 0), 0.0);
        }
      }
      const testing::AngleErrors errors = angle_errors(published, recording);
      EXPECT_LT(errors.last_deg, 3.0) << kind.name << ", swapped in run " << run;
      mse_deg2 += errors.mse_deg2 / kRuns;
    }
    EXPECT_LT(mse_deg2, 1.5 * kind.bar_deg2) << kind.name;
    EXPECT_GT(mse_deg2, 0.3 * kind.bar_deg2) << kind.name << ": is it the same problem?";
  }
}

TEST(AngleTrackers, MissingBlockIsCoastedAndLeavesNoTrace) {
  const Recording whole = three_targets(20);
  const auto without_snapshots = [](std::span<std::complex<double>>) {};
  const auto nan = [](std::span<std::complex<double>> values) { std::fill(values.begin(), values.end(), kNaN); };
  const auto zero = [](std::span<std::complex<double>> values) { std::fill(values.begin(), values.end(), 0.0); };
  const auto one_sensor = [](std::span<std::complex<double>> values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (i % 15 != 4) values[i] = kNaN;
  };
  const std::vector<std::function<void(std::span<std::complex<double>>)>> losses{without_snapshots, nan, zero,
                                                                                 one_sensor};
  for (const Kind& kind : kinds())
    for (std::size_t loss = 0; loss < losses.size(); ++loss) {
      const std::string where = std::string(kind.name) + ", loss " + std::to_string(loss);
      Recording recording = changed(whole, [&](std::size_t k, std::span<std::complex<double>> values) {
        if (k == 10 || k == 11) losses[loss](values);
      });
      if (loss == 0)
        for (const std::size_t k : {10u, 11u}) recording.measurements[k].snapshots.reset();
      std::vector<Measurement> skipping = whole.measurements;
      skipping.erase(skipping.begin() + 10, skipping.begin() + 12);
      const auto tracker = kind.make(3), other = kind.make(3);
      const Published with = track(*tracker, recording.measurements), without = track(*other, skipping);
      EXPECT_EQ(tracker->counts().missing, 2) << where;
      for (const std::size_t k : {10u, 11u}) {
        ASSERT_EQ(with[k].size(), 3u) << where;
        for (std::size_t n = 0; n < 3; ++n) {
          const StepRecord& record = with[k][n];
          EXPECT_EQ(record.status, StepStatus::coasted) << where;
          EXPECT_EQ(record.time_s, static_cast<double>(k)) << where;
          EXPECT_FALSE(record.innovation || record.gain) << where;
          EXPECT_GT(record.P(0, 0), with[k - 1][n].P(0, 0)) << where;
          EXPECT_NEAR(record.x[0], with[9][n].x[0] + static_cast<double>(k - 9) * with[9][n].x[1], 1e-12) << where;
          EXPECT_TRUE(is_covariance(record.P)) << where;
        }
      }
      for (std::size_t k = 12; k < 20; ++k) expect_same(with[k], without[k - 2], where);
    }
}

TEST(AngleTrackers, RepeatedAndLateBlocksAreRejectedAndLeaveNoTrace) {
  const Recording recording = three_targets(20);
  for (const Kind& kind : kinds()) {
    const auto tracker = kind.make(3), other = kind.make(3);
    for (std::size_t k = 0; k < 20; ++k) {
      const auto expected = other->step(recording.measurements[k]);
      const std::vector<StepRecord> plain(expected.begin(), expected.end());
      auto records = tracker->step(recording.measurements[k]);
      expect_same({records.begin(), records.end()}, plain, kind.name);
      if (k < 5) continue;
      Measurement late = recording.measurements[k - 3], timeless = recording.measurements[k];
      timeless.time_s = kNaN;
      for (const Measurement& bad : {recording.measurements[k], late, timeless}) {
        records = tracker->step(bad);
        ASSERT_EQ(records.size(), 3u) << kind.name;
        for (std::size_t n = 0; n < 3; ++n) {
          EXPECT_EQ(records[n].status, StepStatus::rejected) << kind.name;
          EXPECT_FALSE(records[n].innovation || records[n].gain) << kind.name;
          EXPECT_EQ(records[n].x, plain[n].x) << kind.name;
          EXPECT_EQ(records[n].P, plain[n].P) << kind.name;
        }
      }
    }
    EXPECT_EQ(tracker->counts().repeated, 15) << kind.name;
    EXPECT_EQ(tracker->counts().out_of_order, 30) << kind.name;
    EXPECT_EQ(other->counts().repeated + other->counts().out_of_order, 0) << kind.name;
  }
}

TEST(AngleTrackers, BadBlocksBeforeTheStartBeginNothing) {
  const Recording recording = three_targets(12);
  for (const Kind& kind : kinds()) {
    const auto tracker = kind.make(3);
    Measurement nothing;
    nothing.time_s = -5.0;
    EXPECT_TRUE(tracker->step(nothing).empty()) << kind.name;
    const Recording broken = changed(recording, [](std::size_t, std::span<std::complex<double>> values) {
      std::fill(values.begin(), values.end(), kNaN);
    });
    for (const Measurement& measurement : broken.measurements) {
      Measurement early = measurement;
      early.time_s -= 50.0;
      EXPECT_TRUE(kind.make(3)->step(early).empty()) << kind.name;
    }
    EXPECT_EQ(tracker->counts().missing, 1) << kind.name;
    EXPECT_LT(angle_errors(track(*tracker, recording.measurements), recording).last_deg, 1.0) << kind.name;
  }
}

TEST(AngleTrackers, LostSnapshotsAndDeadSensorsAreBorne) {
  const Recording whole = three_targets(40);
  const Recording lossy = changed(whole, [](std::size_t k, std::span<std::complex<double>> values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t t = i / 15, m = i % 15;
      if ((t + k) % 4 == 0 && m == 6) values[i] = {kNaN, 1.0};  // a quarter of the snapshots
    }
  });
  const Recording dead_from_the_start = changed(whole, [](std::size_t, std::span<std::complex<double>> values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (i % 15 == 0 || i % 15 == 9) values[i] = i % 15 == 0 ? 0.0 : kNaN;
  });
  const Recording dead_on_the_way = changed(whole, [](std::size_t k, std::span<std::complex<double>> values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (k > 15 && (i % 15 == 3 || i % 15 == 9)) values[i] = 0.0;
  });
  for (const Kind& kind : kinds()) {
    const auto plain = kind.make(3);
    const double bar_deg2 = angle_errors(track(*plain, whole.measurements), whole).mse_deg2;
    for (const Recording* recording : {&lossy, &dead_from_the_start, &dead_on_the_way}) {
      const auto tracker = kind.make(3);
      const Published published = track(*tracker, recording->measurements);
      for (const StepRecord& record : published.back()) EXPECT_EQ(record.status, StepStatus::ok) << kind.name;
      const testing::AngleErrors errors = angle_errors(published, whole);
      EXPECT_LT(errors.mse_deg2, 3.0 * bar_deg2) << kind.name;
      EXPECT_EQ(tracker->counts().missing, 0) << kind.name;
    }
  }
}

// Two targets that come from 8 degrees apart to the same place and stay there.
TEST(AngleTrackers, CoincidentTargetsAreFlaggedAndNothingBreaks) {
  const auto angle_deg = [](int k, int side) { return 10.0 + side * std::max(0.0, 4.0 - 0.4 * k); };
  const Recording recording = recording_of(40, 0, [&](int k) {
    return scene_of({angle_deg(k, -1), angle_deg(k, 1), -40.0});
  });
  for (const Kind& kind : kinds()) {
    const auto tracker = kind.make(3);
    const Published published = track(*tracker, recording.measurements);
    int merged_before = 0, merged_then = 0;
    for (std::size_t k = 2; k < published.size(); ++k) {
      ASSERT_EQ(published[k].size(), 3u) << kind.name;
      for (const StepRecord& record : published[k]) {
        EXPECT_TRUE(record.x.allFinite()) << kind.name;
        EXPECT_TRUE(is_covariance(record.P)) << kind.name;
        ASSERT_TRUE(record.neighbour) << kind.name;
        EXPECT_GT(record.neighbour->closeness, 0.0);
        EXPECT_LE(record.neighbour->closeness, 1.0);
        if (record.innovation) {
          EXPECT_TRUE(std::isfinite(record.innovation->nis)) << kind.name;
          EXPECT_GT(record.innovation->S(0, 0), 0.0) << kind.name;
        }
        if (std::abs(record.x[0] - radians(-40.0)) < radians(3.0)) {
          EXPECT_FALSE(record.neighbour->merged) << kind.name;
        } else if (record.neighbour->merged) {
          (k < 5 ? merged_before : merged_then) += 1;
        }
      }
    }
    EXPECT_EQ(merged_before, 0) << kind.name;
    EXPECT_GT(merged_then, 10) << kind.name;
  }
}

TEST(AngleTrackers, NeighbourIsTheNearestOther) {
  const Recording recording = recording_of(10, 0, [](int) { return scene_of({-40.0, 0.0, 12.0}); });
  for (const Kind& kind : kinds()) {
    const auto tracker = kind.make(3);
    const std::vector<StepRecord> records = track(*tracker, recording.measurements).back();
    EXPECT_EQ(records[0].neighbour->track, 1) << kind.name;
    EXPECT_EQ(records[1].neighbour->track, 2) << kind.name;
    EXPECT_EQ(records[2].neighbour->track, 1) << kind.name;
    EXPECT_EQ(records[2].neighbour->difference, records[1].x - records[2].x) << kind.name;
    const double resolutions = (std::sin(records[2].x[0]) - std::sin(records[1].x[0])) * 0.5 * 15.0;
    EXPECT_NEAR(records[2].neighbour->closeness, 1.0 / (1.0 + resolutions * resolutions), 1e-12) << kind.name;
    const auto alone = kind.make(1);
    const std::vector<StepRecord> of_one = track(*alone, recording.measurements).back();
    ASSERT_EQ(of_one.size(), 1u) << kind.name;
    EXPECT_FALSE(of_one[0].neighbour) << kind.name;
  }
}

TEST(AngleTrackers, ResetAndFreshAreAsNew) {
  const Recording first = three_targets(15, 1), second = three_targets(15, 2);
  for (const Kind& kind : kinds()) {
    const auto fresh = kind.make(3), used = kind.make(3);
    const Published expected = track(*fresh, second.measurements);
    track(*used, first.measurements);
    used->step(first.measurements.front());  // out of order
    const auto another = used->fresh();
    used->reset();
    EXPECT_EQ(used->counts().out_of_order, 0) << kind.name;
    EXPECT_TRUE(used->events().empty()) << kind.name;
    const Published after_reset = track(*used, second.measurements), of_another = track(*another, second.measurements);
    for (std::size_t k = 0; k < expected.size(); ++k) {
      expect_same(after_reset[k], expected[k], kind.name);
      expect_same(of_another[k], expected[k], kind.name);
    }
    EXPECT_EQ(&used->space(), &angle_space());
  }
}

TEST(AngleTrackers, TakeNothingFromTheHeapAfterTheFirstIntervals) {
  Eigen::VectorXd vector;
  EXPECT_GT(testing::allocations_of([&] { vector.resize(100); }), 0);  // that it is counted
  Recording recording = array_run("array_c_0db");
  recording = changed(recording, [](std::size_t k, std::span<std::complex<double>> values) {
    if (k % 9 == 0) values[17] = {kNaN, 0.0};
    if (k % 13 == 0) std::fill(values.begin(), values.end(), kNaN);
  });
  for (const Kind& kind : kinds()) {
    if (kind.name == std::string("eigenvectors")) continue;  // which allocates, as its header says
    const auto tracker = kind.make(5);
    for (std::size_t k = 1; k < 6; ++k) tracker->step(recording.measurements[k]);
    const long count = testing::allocations_of([&] {
      for (std::size_t k = 6; k < recording.measurements.size(); ++k) {
        tracker->step(recording.measurements[k]);
        tracker->step(recording.measurements[k]);
        tracker->step(recording.measurements[k - 2]);
      }
    });
    EXPECT_EQ(count, 0) << kind.name;
    EXPECT_EQ(tracker->counts().failed, 0) << kind.name;
  }
}

// The array turned round: its sensors in the other order, every angle negative. Of the joint filter: the paper's
// innovation knows which sensor is the first, since b^H P_perp a changes with the phase that a is written with, where a
// does not lie in the subspace.
TEST(AngleTrackers, MirroredArrayGivesMirroredAngles) {
  const Recording recording = array_run("array_a_10db");
  const Recording mirrored = changed(recording, [](std::size_t, std::span<std::complex<double>> values) {
    for (std::size_t begin = 0; begin < values.size(); begin += 15)
      std::reverse(values.begin() + static_cast<std::ptrdiff_t>(begin),
                   values.begin() + static_cast<std::ptrdiff_t>(begin + 15));
  });
  const auto tracker = kinds()[0].make(5), other = kinds()[0].make(5);
  const Published one = track(*tracker, recording.measurements), two = track(*other, mirrored.measurements);
  for (std::size_t k = 20; k < one.size(); ++k) {  // spectra find the first angles to no more than 1e-8
    ASSERT_EQ(one[k].size(), 5u);
    for (std::size_t n = 0; n < 5; ++n)
      EXPECT_LT((one[k][n].x + two[k][4 - n].x).cwiseAbs().maxCoeff(), 1e-9) << "interval " << k;
  }
}

TEST(AngleTrackers, PhaseOfAllSnapshotsChangesNothing) {
  const Recording recording = array_run("array_a_10db");
  const Recording turned = changed(recording, [](std::size_t, std::span<std::complex<double>> values) {
    for (std::complex<double>& value : values) value *= std::polar(1.0, 1.234);
  });
  for (const Kind& kind : kinds()) {
    const auto tracker = kind.make(5), other = kind.make(5);
    const Published one = track(*tracker, recording.measurements), two = track(*other, turned.measurements);
    for (std::size_t k = 20; k < one.size(); ++k)
      for (std::size_t n = 0; n < 5; ++n)
        EXPECT_LT((one[k][n].x - two[k][n].x).cwiseAbs().maxCoeff(), 1e-9) << kind.name << ", interval " << k;
  }
}

TEST(AngleTrackers, MayFindOutHowManyTargetsThereAre) {
  const Recording recording = three_targets(10);
  for (const OrderCriterion criterion : {OrderCriterion::minimum_description_length, OrderCriterion::akaike}) {
    SubspaceAngleOptions paper = paper_options();
    paper.targets = criterion;
    JointAngleOptions joint = joint_options();
    joint.targets = criterion;
    SubspaceAngleTracker of_subspace(paper);
    JointAngleTracker of_joint(joint);
    const std::size_t found = track(of_subspace, recording.measurements).back().size();
    EXPECT_EQ(track(of_joint, recording.measurements).back().size(), found);
    EXPECT_GE(found, 3u);
    // Akaike's is known to count too many of few snapshots, now and then.
    EXPECT_LE(found, criterion == OrderCriterion::akaike ? 5u : 3u);
  }
}

TEST(AngleTrackers, OtherBlockOfTheSameTimeIsUsedAsWell) {
  const Recording recording = three_targets(12), again = three_targets(12, 1);
  for (const Kind& kind : kinds()) {
    const auto tracker = kind.make(3);
    for (std::size_t k = 0; k < 12; ++k) {
      const auto once = tracker->step(recording.measurements[k]);
      const std::vector<StepRecord> before(once.begin(), once.end());
      const auto twice = tracker->step(again.measurements[k]);
      for (std::size_t n = 0; n < before.size(); ++n) {
        EXPECT_EQ(twice[n].status, StepStatus::ok) << kind.name;
        EXPECT_TRUE(is_covariance(twice[n].P)) << kind.name;
        EXPECT_LT(twice[n].P(0, 0), before[n].P(0, 0)) << kind.name;
      }
    }
    EXPECT_EQ(tracker->counts().repeated, 0) << kind.name;
  }
}

TEST(AngleTrackers, HugeGapLeavesFiniteStates) {
  const Recording recording = three_targets(12);
  for (const Kind& kind : kinds())
    for (const double gap_s : {1e3, 1e7}) {
      const auto tracker = kind.make(3);
      for (std::size_t k = 0; k < 12; ++k) {
        Measurement measurement = recording.measurements[k];
        if (k >= 8) measurement.time_s += gap_s;
        for (const StepRecord& record : tracker->step(measurement)) {
          EXPECT_TRUE(record.x.allFinite()) << kind.name << ", " << gap_s;
          EXPECT_TRUE(is_covariance(record.P)) << kind.name << ", " << gap_s;
        }
      }
    }
}

// Values whose squares are beyond all numbers, in one interval.
TEST(AngleTrackers, AbsurdValuesAreFlaggedAndSurvived) {
  const Recording recording = three_targets(30);
  const Recording burst = changed(recording, [](std::size_t k, std::span<std::complex<double>> values) {
    if (k != 10) return;
    for (std::complex<double>& value : values) value *= 1e200;
  });
  for (const Kind& kind : kinds()) {
    const auto tracker = kind.make(3);
    const Published published = track(*tracker, burst.measurements);
    for (const std::vector<StepRecord>& records : published)
      for (const StepRecord& record : records) {
        EXPECT_TRUE(record.x.allFinite()) << kind.name;
        EXPECT_TRUE(is_covariance(record.P)) << kind.name;
      }
    EXPECT_LT(angle_errors(published, recording, 25).last_deg, 1.0) << kind.name;
  }
}

// A log has one array throughout; a stream that turns to another must not break anything.
TEST(AngleTrackers, ArrayOfAnotherSizeOnTheWayBreaksNothing) {
  for (const Kind& kind : kinds())
    for (const int sensors : {16, 14, 40, 3, 2}) {
      const Recording recording = recording_of(12, 0, [&](int k) {
        ArrayScene scene = scene_of({-40.0, 0.0, 40.0});
        if (k >= 6) scene.sensors = sensors;
        return scene;
      });
      const auto tracker = kind.make(3);
      for (const std::vector<StepRecord>& records : track(*tracker, recording.measurements))
        for (const StepRecord& record : records) {
          EXPECT_TRUE(record.x.allFinite()) << kind.name << ", " << sensors;
          EXPECT_TRUE(is_covariance(record.P)) << kind.name << ", " << sensors;
        }
    }
}

}  // namespace
}  // namespace truebearing::angle_trackers_test
