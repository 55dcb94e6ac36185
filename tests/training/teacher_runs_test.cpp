// SPDX-License-Identifier: Apache-2.0
// Who makes a teacher's runs, threads or ranks on machines of any kind, decides nothing of what they teach.
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "tests/support/fakes.hpp"
#include "tests/support/thread_ranks.hpp"
#include "tests/training/taught_radar.hpp"

namespace truebearing::teacher_runs_test {
namespace {

using testing::FakeScenario;
using testing::taught_correction;
using testing::taught_ensemble;

// All numbers of a set.
std::vector<double> numbers(const TeacherSet& set) {
  std::vector<double> all;
  for (const Eigen::MatrixXd* matrix :
       {&set.X, &set.Y, &set.reference, &set.covariance_factors, &set.reference_factors})
    all.insert(all.end(), matrix->data(), matrix->data() + matrix->size());
  for (const std::vector<bool>* flags : {&set.begins, &set.taught, &set.used})
    all.insert(all.end(), flags->begin(), flags->end());
  return all;
}

TEST(TeacherRuns, RanksShareTheRunsAndTheFirstHasTheSetOfOneProcess) {
  const LineScenario scenario = testing::radar_family(12);
  for (const bool whole_tracks : {false, true}) {
    TeacherOptions options{.seed = 9, .threads = 1, .progress = {}, .whole_tracks = whole_tracks};
    const std::vector<double> one =
        numbers(collect_teacher_set(taught_ensemble(), taught_correction(7), scenario, options));
    ASSERT_GT(one.size(), 84u);
    for (const std::size_t count : {2u, 9u}) {
      const auto sets = testing::at_ranks(count, [&](Ranks& ranks) {
        TeacherOptions shared = options;
        shared.ranks = &ranks;
        std::size_t done = 0;
        shared.progress = [&](std::size_t runs, std::size_t total) {
          EXPECT_EQ(total, 7u);
          done = runs;
        };
        const TeacherSet set = collect_teacher_set(taught_ensemble(), taught_correction(7), scenario, shared);
        EXPECT_EQ(done, ranks.rank() == 0 ? 7u : 0u);
        return numbers(set);
      });
      EXPECT_EQ(sets[0], one);
      for (std::size_t rank = 1; rank < count; ++rank) EXPECT_TRUE(sets[rank].empty());
    }
  }
}

// By one thread eight runs at a time, by sixteen one by one.
TEST(TeacherRuns, RowsAreTheSameForAnyNumberOfThreads) {
  const LineScenario scenario = testing::radar_family(30);
  for (const bool whole_tracks : {false, true}) {
    TeacherOptions options{.threads = 1, .progress = {}, .whole_tracks = whole_tracks};
    std::size_t done = 0;
    options.progress = [&](std::size_t runs, std::size_t total) {
      EXPECT_EQ(total, 20u);
      EXPECT_GT(runs, done);
      done = runs;
    };
    const std::vector<double> one =
        numbers(collect_teacher_set(taught_ensemble(), taught_correction(20), scenario, options));
    EXPECT_EQ(done, 20u);
    options.progress = {};
    for (const int threads : {2, 16}) {
      options.threads = threads;
      EXPECT_EQ(numbers(collect_teacher_set(taught_ensemble(), taught_correction(20), scenario, options)), one);
    }
  }
}

// Ranks on machines of other sizes cut the runs alike.
TEST(TeacherRuns, RanksMayHaveOtherNumbersOfThreads) {
  const LineScenario scenario = testing::radar_family(12);
  const TeacherOptions options{.seed = 9, .threads = 1, .progress = {}};
  const std::vector<double> one =
      numbers(collect_teacher_set(taught_ensemble(), taught_correction(40), scenario, options));
  const auto sets = testing::at_ranks(2, [&](Ranks& ranks) {
    TeacherOptions shared = options;
    shared.ranks = &ranks;
    shared.threads = ranks.rank() == 0 ? 1 : 8;
    return numbers(collect_teacher_set(taught_ensemble(), taught_correction(40), scenario, shared));
  });
  EXPECT_EQ(sets[0], one);
}

// A tracker as it is on a processor whose registers are too short for a pack.
class AloneTracker final : public Tracker {
 public:
  explicit AloneTracker(std::unique_ptr<Tracker> tracker) : tracker_(std::move(tracker)) {}
  std::span<const StepRecord> step(const Measurement& measurement) override { return tracker_->step(measurement); }
  void reset() override { tracker_->reset(); }
  std::unique_ptr<Tracker> fresh() const override { return std::make_unique<AloneTracker>(tracker_->fresh()); }
  const StateSpace& space() const override { return tracker_->space(); }
  RecordBlocks blocks() const override { return tracker_->blocks(); }

 private:
  std::unique_ptr<Tracker> tracker_;
};

TEST(TeacherRuns, RanksMayHaveProcessorsOfWhichSomeGainNothingTogether) {
  const LineScenario scenario = testing::radar_family(12);
  const TeacherOptions options{.seed = 9, .threads = 1, .progress = {}};
  const Ensemble packed = taught_ensemble();
  Ensemble alone;
  for (int member = 0; member < packed.size(); ++member)
    alone.add(packed.name(member), std::make_unique<AloneTracker>(packed.tracker(member).fresh()));
  const std::vector<double> one = numbers(collect_teacher_set(packed, taught_correction(40), scenario, options));
  EXPECT_EQ(numbers(collect_teacher_set(alone, taught_correction(40), scenario, options)), one);
  for (const std::size_t without : {0u, 1u}) {
    const auto sets = testing::at_ranks(2, [&](Ranks& ranks) {
      TeacherOptions shared = options;
      shared.ranks = &ranks;
      return numbers(
          collect_teacher_set(ranks.rank() == without ? alone : packed, taught_correction(40), scenario, shared));
    });
    EXPECT_EQ(sets[0], one) << without;
  }
}

TEST(TeacherRuns, DrawsItsOwnRoleOnly) {
  const LineScenario scenario = testing::radar_family(5);
  const auto keys_of = [&](Role role) {
    std::set<std::vector<std::uint64_t>> keys;
    const FakeScenario watched(scenario.truth_space(), [&](const RunKey& key) {
      keys.insert({static_cast<std::uint64_t>(key.role), key.seed, key.run});
      return scenario.simulate(key);
    });
    collect_teacher_set(taught_ensemble(), taught_correction(10), watched,
                        {.seed = 3, .role = role, .threads = 1, .progress = {}});
    return keys;
  };
  const auto training = keys_of(Role::training), validation = keys_of(Role::validation);
  EXPECT_EQ(training.size(), 10u);
  for (const auto& key : training) {
    EXPECT_EQ(key[0], static_cast<std::uint64_t>(Role::training));
    EXPECT_FALSE(validation.contains(key));
  }
}

}  // namespace
}  // namespace truebearing::teacher_runs_test
