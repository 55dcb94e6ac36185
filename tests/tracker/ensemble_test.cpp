#include "truebearing/tracker/ensemble.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"

namespace truebearing {
namespace {

using testing::error_message;
using testing::position;
using testing::RadarFilter;

// Publishes two tracks in an order of its own.
class TwoTracks final : public Tracker {
 public:
  explicit TwoTracks(bool swapped) : swapped_(swapped) { reset(); }
  std::span<const StepRecord> step(const Measurement& measurement) override {
    for (StepRecord& record : records_) {
      record.time_s = measurement.time_s;
      record.x = BoundedVector::Constant(2, 10.0 * record.track + (swapped_ ? 1.0 : 0.0));
      record.P = BoundedMatrix::Identity(2, 2);
    }
    return records_;
  }
  void reset() override {
    records_.assign(2, StepRecord{});
    records_[swapped_ ? 0 : 1].track = 1;
  }
  std::unique_ptr<Tracker> fresh() const override { return std::make_unique<TwoTracks>(swapped_); }
  const StateSpace& space() const override { return line_space(); }

 private:
  bool swapped_;
  std::vector<StepRecord> records_;
};

TEST(Ensemble, RecordsAreAlignedByTrackNotByPlace) {
  Ensemble ensemble;
  ensemble.add("a", std::make_unique<TwoTracks>(false));
  ensemble.add("b", std::make_unique<TwoTracks>(true));
  ensemble.step(position(1.0, 0.0));
  for (const int track : {0, 1}) {
    ASSERT_NE(ensemble.record(0, track), nullptr);
    ASSERT_NE(ensemble.record(1, track), nullptr);
    EXPECT_EQ(ensemble.record(0, track)->x[0], 10.0 * track);
    EXPECT_EQ(ensemble.record(1, track)->x[0], 10.0 * track + 1.0);
  }
  EXPECT_EQ(ensemble.record(0, 2), nullptr);
}

TEST(Ensemble, BeforeTheFirstStepThereAreNoRecords) {
  Ensemble ensemble;
  ensemble.add("a", RadarFilter{}.tracker());
  EXPECT_TRUE(ensemble.records(0).empty());
  EXPECT_EQ(ensemble.record(0, 0), nullptr);
}

TEST(Ensemble, SecondMemberOfOneNameIsRefused) {
  Ensemble ensemble;
  EXPECT_EQ(ensemble.add("plain", RadarFilter{}.tracker()), 0);
  EXPECT_EQ(ensemble.add("tuned", RadarFilter{}.tracker()), 1);
  EXPECT_THAT(error_message([&] { ensemble.add("plain", RadarFilter{}.tracker()); }), ::testing::HasSubstr("plain"));
  EXPECT_EQ(ensemble.size(), 2);
  EXPECT_EQ(ensemble.index("tuned"), 1);
  EXPECT_EQ(ensemble.index("other"), -1);
}

TEST(Ensemble, EveryMemberSeesEveryMeasurement) {
  Ensemble ensemble;
  RadarFilter wide;
  wide.variance = {1e6, 5e4};
  ensemble.add("plain", RadarFilter{}.tracker());
  ensemble.add("wide", wide.tracker());
  const auto plain_alone = RadarFilter{}.tracker();
  const auto wide_alone = wide.tracker();
  for (const Measurement& measurement : testing::radar_log(2, 30)) {
    ensemble.step(measurement);
    EXPECT_EQ(ensemble.record(0, 0)->x, plain_alone->step(measurement)[0].x);
    EXPECT_EQ(ensemble.record(1, 0)->x, wide_alone->step(measurement)[0].x);
  }
}

TEST(Ensemble, CloneBeginsAnewAndIsIndependent) {
  Ensemble ensemble;
  ensemble.add("plain", RadarFilter{}.tracker());
  for (const Measurement& measurement : testing::radar_log(2, 30)) ensemble.step(measurement);
  Ensemble copy = ensemble.fresh();
  EXPECT_EQ(copy.name(0), "plain");
  EXPECT_TRUE(copy.records(0).empty());
  const BoundedVector before = ensemble.record(0, 0)->x;
  copy.step(position(1.0, 100.0));
  EXPECT_EQ(copy.record(0, 0)->x, RadarFilter{}.tracker()->step(position(1.0, 100.0))[0].x);
  EXPECT_EQ(ensemble.record(0, 0)->x, before);
  ensemble.reset();
  EXPECT_TRUE(ensemble.records(0).empty());
  ensemble.step(position(1.0, 100.0));
  EXPECT_EQ(ensemble.record(0, 0)->x, copy.record(0, 0)->x);
}

}  // namespace
}  // namespace truebearing
