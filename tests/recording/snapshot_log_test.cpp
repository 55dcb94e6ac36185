// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/snapshot_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/array_recording.hpp"
#include "tests/support/error_message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"

namespace truebearing::snapshot_log_test {
namespace {

using ::testing::AllOf;
using testing::array_recording;
using ::testing::ElementsAre;
using testing::error_message;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using Complex = std::complex<double>;
using Shape = std::vector<hsize_t>;

bool same_bits(std::span<const Complex> a, std::span<const Complex> b) {
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](Complex x, Complex y) {
    return bits(x.real()) == bits(y.real()) && bits(x.imag()) == bits(y.imag());
  });
}

// A file as another program writes it: 3 intervals of 2 snapshots of 2 sensors, to be changed before it is written.
struct ForeignLog {
  struct Dataset {
    Shape shape;
    std::vector<double> values;
    hid_t type = H5T_IEEE_F64LE;
  };
  std::vector<std::pair<std::string, Dataset>> datasets{
      {"snapshots",
       {{3, 2, 2, 2}, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24}}}};
  std::vector<std::pair<std::string, double>> attributes{{"interval_s", 0.5}, {"spacing_wavelengths", 0.5}};

  Dataset& snapshots() { return datasets[0].second; }
  void write(const std::filesystem::path& path) const {
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    for (const auto& [name, dataset] : datasets) {
      const hid_t space = H5Screate_simple(static_cast<int>(dataset.shape.size()), dataset.shape.data(), nullptr);
      // In chunks, so that a huge one takes no place.
      const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
      const Shape chunk(dataset.shape.size(), 1);
      if (dataset.values.empty()) H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
      const hid_t data = H5Dcreate2(file, name.c_str(), dataset.type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
      if (!dataset.values.empty())
        H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, dataset.values.data());
      const hid_t scalar = H5Screate(H5S_SCALAR);
      if (name == "snapshots")
        for (const auto& [key, value] : attributes) {
          const hid_t attribute = H5Acreate2(data, key.c_str(), H5T_IEEE_F32LE, scalar, H5P_DEFAULT, H5P_DEFAULT);
          H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value);
          H5Aclose(attribute);
        }
      H5Sclose(scalar);
      H5Dclose(data);
      H5Pclose(properties);
      H5Sclose(space);
    }
    H5Fclose(file);
  }
};

class SnapshotLogTest : public ::testing::Test {
 protected:
  Recording read(const ForeignLog& log) const {
    log.write(path_);
    return read_snapshot_log(path_);
  }
  std::string error_of(const std::function<void(ForeignLog&)>& change) const {
    ForeignLog log;
    change(log);
    std::string message = error_message([&] { read(log); });
    EXPECT_THAT(message, HasSubstr(path_.string()));
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  std::string error_with(const char* name, double value) const {
    return error_of([&](ForeignLog& log) {
      std::erase_if(log.attributes, [&](const auto& attribute) { return attribute.first == name; });
      log.attributes.emplace_back(name, value);
    });
  }

  const TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.path() / "log.h5";
};

TEST_F(SnapshotLogTest, TargetsAreNumberedByFirstAngleWhateverTheirColumns) {
  Recording written = array_recording();  // target 1 comes later
  written.truth.insert(written.truth.begin(), written.truth[0]);
  for (BoundedVector& x : written.truth[0].x) x[0] += 0.5;
  write_snapshot_log(path_, written);
  const Recording recording = read_snapshot_log(path_);
  EXPECT_EQ(recording.truth[0].track, 1);
  EXPECT_EQ(recording.truth[1].track, 0);
  EXPECT_EQ(recording.truth[2].track, 2);
}

TEST_F(SnapshotLogTest, WrittenRecordingReadsBackToTheBit) {
  const Recording written = array_recording();
  write_snapshot_log(path_, written);
  const Recording recording = read_snapshot_log(path_);
  EXPECT_THAT(recording.measured, ElementsAre("snapshots"));
  ASSERT_EQ(recording.measurements.size(), 4u);
  EXPECT_TRUE(same_bits(*recording.snapshots, *written.snapshots));
  for (std::size_t k = 0; k < 4; ++k) {
    const SnapshotBlock& a = *recording.measurements[k].snapshots;
    const SnapshotBlock& b = *written.measurements[k].snapshots;
    EXPECT_EQ(recording.measurements[k].time_s, written.measurements[k].time_s);
    EXPECT_EQ(recording.measurements[k].z.size(), 0);
    EXPECT_EQ(a.sensors, b.sensors);
    EXPECT_EQ(a.spacing_wavelengths, b.spacing_wavelengths);
    EXPECT_EQ(a.interval_s, b.interval_s);
    EXPECT_TRUE(same_bits(a.values, b.values));
    EXPECT_EQ(a.values.data(), recording.snapshots->data() + k * 6) << "a view";
  }
  EXPECT_EQ(recording.truth_space, &angle_space());
  ASSERT_EQ(recording.truth.size(), 2u);
  EXPECT_EQ(recording.truth[1].track, 1);
  for (std::size_t target = 0; target < 2; ++target)
    for (std::size_t k = 0; k < 4; ++k)
      for (const Eigen::Index i : {0, 1}) {
        const double expected = written.truth[target].x[k](i), x = recording.truth[target].x[k](i);
        EXPECT_TRUE(std::isnan(expected) ? std::isnan(x) : std::abs(x - expected) <= 4e-16 * std::abs(expected));
      }
  EXPECT_EQ(recording.counts.missing, 1);
  EXPECT_TRUE(is_unusable(recording, recording.measurements[2]));
  EXPECT_FALSE(is_unusable(recording, recording.measurements[0])) << "one of its snapshots is whole";
}

TEST_F(SnapshotLogTest, SameRecordingGivesTheSameBytes) {
  write_snapshot_log(path_, array_recording());
  write_snapshot_log(folder_.path() / "later.h5", array_recording());
  write_snapshot_log(folder_.path() / "again.h5", read_snapshot_log(path_));
  EXPECT_EQ(folder_.read("log.h5"), folder_.read("later.h5"));
  EXPECT_EQ(folder_.read("log.h5").size(), folder_.read("again.h5").size());
  EXPECT_EQ(folder_.files(), 3);
}

TEST_F(SnapshotLogTest, IntervalWithoutSnapshotsIsWrittenAsMissing) {
  Recording recording = array_recording();
  recording.measurements[0].snapshots.reset();
  EXPECT_TRUE(is_unusable(recording, recording.measurements[0]));
  write_snapshot_log(path_, recording);
  const Recording read = read_snapshot_log(path_);
  EXPECT_EQ(read.counts.missing, 2);
  EXPECT_TRUE(is_unusable(read, read.measurements[0]));
  EXPECT_EQ(read.measurements[0].snapshots->snapshots(), 2);
}

TEST_F(SnapshotLogTest, TimesFollowTheIntervalWhereTheFileHasNone) {
  ForeignLog log;
  EXPECT_EQ(read(log).measurements[2].time_s, 1.0);
  log.attributes.emplace_back("first_time_s", -10.0);
  const Recording recording = read(log);
  EXPECT_EQ(recording.measurements[0].time_s, -10.0);
  EXPECT_EQ(recording.measurements[2].time_s, -9.0);
  EXPECT_EQ(recording.measurements[2].snapshots->snapshot(1)[0], Complex(21, 22));
}

TEST_F(SnapshotLogTest, FloatsAndIntegersOfOtherWidthsAreRead) {
  for (const hid_t type : {H5T_IEEE_F32LE, H5T_IEEE_F32BE, H5T_STD_I16LE}) {
    ForeignLog log;
    log.snapshots().type = type;
    EXPECT_EQ(read(log).measurements[2].snapshots->snapshot(1)[1], Complex(23, 24));
  }
}

TEST_F(SnapshotLogTest, SpacingInMetresIsTakenInWavelengths) {
  ForeignLog log;
  log.attributes = {{"interval_s", 0.5}, {"spacing_m", 0.75}, {"frequency_hz", 1000.0}};
  EXPECT_DOUBLE_EQ(read(log).measurements[0].snapshots->spacing_wavelengths, 0.5) << "at 1500 m/s";
  log.attributes.emplace_back("sound_mps", 3000.0);
  EXPECT_DOUBLE_EQ(read(log).measurements[0].snapshots->spacing_wavelengths, 0.25);
}

TEST_F(SnapshotLogTest, TruthMayBeAbsentOrWithoutRates) {
  ForeignLog log;
  const Recording without = read(log);
  EXPECT_EQ(without.truth_space, nullptr);
  EXPECT_TRUE(without.truth.empty());
  log.datasets.push_back({"truth_angle_deg", {{3, 2}, {10, kNaN, 11, 30, 12, kInfinity}}});
  const Recording recording = read(log);
  ASSERT_EQ(recording.truth.size(), 2u);
  EXPECT_DOUBLE_EQ(recording.truth[0].x[1](0), radians(11.0));
  EXPECT_NEAR(recording.truth[0].x[1](1), radians(2.0), 1e-15) << "the slope: 1 degree in half a second";
  EXPECT_DOUBLE_EQ(recording.truth[1].x[1](0), radians(30.0));
  EXPECT_TRUE(std::isnan(recording.truth[1].x[1](1)));
  EXPECT_TRUE(recording.truth[1].x[0].array().isNaN().all());
  EXPECT_TRUE(recording.truth[1].x[2].array().isNaN().all()) << "infinite is unknown";
  log.datasets.push_back({"truth_rate_degps", {{3, 2}, {1, 2, 3, 4, 5, 6}}});
  EXPECT_DOUBLE_EQ(read(log).truth[1].x[2](1), radians(6.0));
}

TEST_F(SnapshotLogTest, ValuesThatAreNotFiniteAreMissing) {
  ForeignLog log;
  log.snapshots().values[0] = kInfinity;
  log.snapshots().values[9] = kNaN;
  log.snapshots().values[15] = kNaN;
  const Recording recording = read(log);
  EXPECT_TRUE(std::isnan(recording.measurements[0].snapshots->values[0].real()));
  EXPECT_FALSE(recording.measurements[0].snapshots->is_finite(0));
  EXPECT_TRUE(recording.measurements[0].snapshots->is_finite(1));
  EXPECT_EQ(recording.counts.missing, 1) << "neither snapshot of interval 1 is whole";
}

TEST(SnapshotBlock, ASensorThatGivesNothingDoesNotSpoilTheOthers) {
  const std::complex<double> nothing(kNaN, kNaN);
  const std::vector<std::complex<double>> dead{1.0, nothing, 2.0, 3.0, nothing, 4.0};
  const std::vector<std::complex<double>> holes{1.0, nothing, 2.0, 3.0, 4.0, nothing};
  const std::vector<std::complex<double>> empty(6, nothing);
  const auto is_usable = [](const std::vector<std::complex<double>>& values) {
    return SnapshotBlock{values, 3}.has_usable_snapshot();
  };
  EXPECT_TRUE(is_usable(dead));
  EXPECT_FALSE(is_usable(holes)) << "two sensors give something, and never both";
  EXPECT_FALSE(is_usable(empty));
  const std::vector<std::complex<double>> zeros{1.0, 0.0, 2.0, 3.0, nothing, 4.0};
  EXPECT_TRUE(is_usable(zeros)) << "a sensor that gives zeros gives nothing";
  EXPECT_FALSE(is_usable(std::vector<std::complex<double>>(6, 0.0)));
}

TEST_F(SnapshotLogTest, RepeatedIntervalIsDroppedAndCounted) {
  ForeignLog log;
  log.snapshots().values = {1, 2, 3, kNaN, 5, 6, 7, 8, 1, 2, 3, kNaN, 5, 6, 7, 8, 1, 2, 3, kNaN, 5, 6, 7, 8};
  log.datasets.push_back({"time_s", {{3}, {1, 1, 2}}});
  log.datasets.push_back({"truth_angle_deg", {{3, 1}, {10, 11, 12}}});
  const Recording recording = read(log);
  EXPECT_EQ(recording.counts.repeated, 1);
  ASSERT_EQ(recording.measurements.size(), 2u);
  ASSERT_EQ(recording.truth[0].x.size(), 2u);
  EXPECT_EQ(recording.measurements[1].time_s, 2.0);
  EXPECT_DOUBLE_EQ(recording.truth[0].x[1](0), radians(12.0));
}

TEST_F(SnapshotLogTest, IsKnownByItsNameOrItsSignature) {
  ForeignLog().write(folder_.path() / "log.dat");
  EXPECT_TRUE(is_snapshot_log(folder_.path() / "log.dat"));
  EXPECT_TRUE(is_snapshot_log("nowhere.h5"));
  EXPECT_TRUE(is_snapshot_log("nowhere.hdf5"));
  EXPECT_FALSE(is_snapshot_log("nowhere.csv"));
  EXPECT_FALSE(is_snapshot_log("-"));
  EXPECT_FALSE(is_snapshot_log(folder_.write("log.csv", "time_s,position_m\n")));
  EXPECT_FALSE(is_snapshot_log(folder_.write("empty.csv", "")));
}

TEST_F(SnapshotLogTest, ShapeThatIsNoneOfSnapshotsIsRefused) {
  const auto shape = [&](const Shape& lengths) {
    return error_of([&](ForeignLog& log) { log.snapshots() = {lengths, {}}; });
  };
  EXPECT_THAT(shape({3, 2, 2}), AllOf(HasSubstr("snapshots: is of shape (3, 2, 2)"), HasSubstr("sensor, 2")));
  EXPECT_THAT(shape({3, 2, 2, 3}), HasSubstr("(3, 2, 2, 3)"));
  EXPECT_THAT(error_of([](ForeignLog& log) { log.datasets.clear(); }), HasSubstr("snapshots: is missing"));
  EXPECT_THAT(error_of([](ForeignLog& log) { log.datasets[0].first = "data"; }), HasSubstr("snapshots: is missing"));
}

TEST_F(SnapshotLogTest, ExcessiveSizeIsRefusedBeforeItIsAllocated) {
  const auto shape = [&](const Shape& lengths) {
    return error_of([&](ForeignLog& log) { log.snapshots() = {lengths, {}}; });
  };
  EXPECT_THAT(shape({1000001, 1, 1, 2}), AllOf(HasSubstr("1000001 intervals"), HasSubstr("1 to 1000000 intervals")));
  EXPECT_THAT(shape({1, 1000001, 1, 2}), HasSubstr("1 to 1000000 snapshots"));
  EXPECT_THAT(shape({1, 1, 4097, 2}), HasSubstr("1 to 4096 sensors"));
  EXPECT_THAT(shape({1000000, 1000000, 4096, 2}), HasSubstr("at most 2147483648"));
  EXPECT_THAT(shape({1ull << 62, 1ull << 62, 1, 2}), ::testing::Not(HasSubstr("no error")));
  EXPECT_THAT(error_of([](ForeignLog& log) {
                log.datasets.push_back({"truth_angle_deg", {{3, 257}, {}}});
              }),
              AllOf(HasSubstr("257 targets"), HasSubstr("1 to 256")));
  EXPECT_THAT(error_of([](ForeignLog& log) {
                log.snapshots() = {{1000000, 1, 1, 2}, {}};
                log.datasets.push_back({"truth_angle_deg", {{1000000, 11}, {}}});
              }),
              HasSubstr("11000000 true states"));
}

TEST_F(SnapshotLogTest, AttributesMustBeThereAndPositive) {
  const std::vector<const char*> names{"interval_s", "spacing_wavelengths"};
  for (const char* name : names)
    for (const double value : {0.0, -1.0, kNaN, kInfinity})
      EXPECT_THAT(error_with(name, value), AllOf(HasSubstr(name), HasSubstr("a finite number > 0"))) << value;
  EXPECT_THAT(error_with("first_time_s", kNaN), AllOf(HasSubstr("first_time_s: is nan"), HasSubstr("a finite number")));
  EXPECT_THAT(error_with("spacing_m", 0.7), HasSubstr("both"));
  const auto attributes = [&](std::vector<std::pair<std::string, double>> given) {
    return error_of([&](ForeignLog& log) { log.attributes = std::move(given); });
  };
  EXPECT_THAT(attributes({{"spacing_wavelengths", 0.5}}), HasSubstr("no attribute interval_s"));
  EXPECT_THAT(attributes({{"interval_s", 1.0}}), HasSubstr("spacing_wavelengths, or spacing_m and frequency_hz"));
  EXPECT_THAT(attributes({{"interval_s", 1.0}, {"spacing_m", 0.7}}), HasSubstr("no attribute frequency_hz"));
  EXPECT_THAT(attributes({{"interval_s", 1.0}, {"spacing_m", 0.7}, {"frequency_hz", -5.0}}),
              HasSubstr("frequency_hz: is -5"));
  EXPECT_THAT(attributes({{"interval_s", 1.0}, {"spacing_m", 0.7}, {"frequency_hz", 1.0}, {"sound_mps", 0.0}}),
              HasSubstr("sound_mps: is 0"));
}

TEST_F(SnapshotLogTest, TimesMustBeFiniteAndNotDecrease) {
  const auto times = [&](const ForeignLog::Dataset& time_s) {
    return error_of([&](ForeignLog& log) { log.datasets.emplace_back("time_s", time_s); });
  };
  EXPECT_THAT(times({{3}, {1, 2, 1.5}}), AllOf(HasSubstr("time_s[2]: is 1.5"), HasSubstr("do not decrease")));
  EXPECT_THAT(times({{3}, {1, kNaN, 2}}), AllOf(HasSubstr("time_s[1]: is nan"), HasSubstr("a finite time")));
  EXPECT_THAT(times({{2}, {1, 2}}), AllOf(HasSubstr("time_s: is of shape (2)"), HasSubstr("(3), one per interval")));
}

TEST_F(SnapshotLogTest, TruthMustFitTheSnapshots) {
  const auto truth = [&](const char* name, const Shape& shape) {
    return error_of([&](ForeignLog& log) {
      if (std::string(name) == "truth_rate_degps") log.datasets.push_back({"truth_angle_deg", {{3, 1}, {10, 11, 12}}});
      log.datasets.push_back({name, {shape, {}}});
    });
  };
  EXPECT_THAT(truth("truth_angle_deg", {2, 1}), AllOf(HasSubstr("(2, 1)"), HasSubstr("(3, targets)")));
  EXPECT_THAT(truth("truth_angle_deg", {3}), HasSubstr("(3, targets)"));
  EXPECT_THAT(truth("truth_rate_degps", {3, 2}), AllOf(HasSubstr("(3, 2)"), HasSubstr("(3, 1), as truth_angle_deg")));
  EXPECT_THAT(error_of([](ForeignLog& log) {
                log.datasets.push_back({"truth_rate_degps", {{3, 1}, {1, 1, 1}}});
              }),
              HasSubstr("truth_rate_degps: stands alone"));
}

TEST_F(SnapshotLogTest, ValuesThatAreNoNumbersAreRefused) {
  const hid_t complex = H5Tcreate(H5T_COMPOUND, 16);
  H5Tinsert(complex, "r", 0, H5T_IEEE_F64LE);
  H5Tinsert(complex, "i", 8, H5T_IEEE_F64LE);
  EXPECT_THAT(error_of([&](ForeignLog& log) {
                log.snapshots() = {{3, 2, 2, 2}, {}, complex};
              }),
              AllOf(HasSubstr("snapshots: holds compound values"), HasSubstr("floats or integers")));
  H5Tclose(complex);
  EXPECT_THAT(error_of([](ForeignLog& log) { log.snapshots() = {{3, 2, 2, 2}, {}, H5T_C_S1}; }), HasSubstr("text"));
}

TEST_F(SnapshotLogTest, FileThatIsNoneOrNotWholeIsRefused) {
  const auto error = [&] { return error_message([&] { read_snapshot_log(path_); }); };
  EXPECT_THAT(error(), AllOf(HasSubstr("log.h5"), HasSubstr("No such file")));
  folder_.write("log.h5", "time_s,position_m\n1,2\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("log.h5"), HasSubstr("is no HDF5 file")));
  folder_.write("log.h5", "");
  EXPECT_THAT(error(), HasSubstr("log.h5"));
  EXPECT_THAT(error_message([&] { read_snapshot_log(folder_.path()); }), HasSubstr("is not a regular file"));
  write_snapshot_log(path_, array_recording());
  const std::string whole = folder_.read("log.h5");
  ::testing::internal::CaptureStderr();
  for (const std::size_t size : {std::size_t{8}, std::size_t{100}, whole.size() / 2, whole.size() - 1}) {
    folder_.write("log.h5", whole.substr(0, size));
    EXPECT_THAT(error(), AllOf(HasSubstr("log.h5"), HasSubstr("cannot be"), HasSubstr("a whole HDF5 file"))) << size;
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "the library is kept quiet";
  EXPECT_EQ(folder_.files(), 1);
}

TEST_F(SnapshotLogTest, RecordingThatIsNoneOfOneArrayIsNotWritten) {
  folder_.write("log.h5", "the old log");
  const auto error_with_change = [&](const std::function<void(Recording&)>& change) {
    Recording recording = array_recording();
    change(recording);
    return error_message([&] { write_snapshot_log(path_, recording); });
  };
  EXPECT_THAT(error_with_change([](Recording& r) { r.measured = {"bearing_deg"}; }),
              AllOf(HasSubstr("log.h5"), HasSubstr("bearing_deg"), HasSubstr("snapshots of a line array")));
  EXPECT_THAT(error_with_change([](Recording& r) { r.measurements[1].snapshots->spacing_wavelengths = 0.5; }),
              HasSubstr("another array"));
  EXPECT_THAT(error_with_change([](Recording& r) {
                SnapshotBlock& block = *r.measurements[1].snapshots;
                block.values = block.values.first(5);
              }),
              HasSubstr("as many snapshots in every interval"));
  EXPECT_THAT(error_with_change([](Recording& r) { r.measurements[1].time_s = -1.0; }), HasSubstr("do not decrease"));
  EXPECT_THAT(error_with_change([](Recording& r) { r.measurements.clear(); }), HasSubstr("no snapshots"));
  EXPECT_THAT(error_with_change([](Recording& r) { r.truth_space = &line_space(); }), HasSubstr("angle_rad"));
  EXPECT_THAT(error_with_change([](Recording& r) {
                for (Measurement& m : r.measurements) m.snapshots->interval_s = 0.0;
              }),
              HasSubstr("finite numbers > 0"));
  EXPECT_EQ(folder_.read("log.h5"), "the old log");
  EXPECT_EQ(folder_.files(), 1);
}

TEST_F(SnapshotLogTest, FullDiskLeavesTheOldFile) {
  folder_.write("log.h5", "the old log");
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1024, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  const std::string message = error_message([&] { write_snapshot_log(path_, array_recording()); });
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(message, AllOf(HasSubstr("log.h5"), HasSubstr("File too large")));
  EXPECT_EQ(folder_.read("log.h5"), "the old log");
  EXPECT_EQ(folder_.files(), 1);
}

}  // namespace
}  // namespace truebearing::snapshot_log_test
