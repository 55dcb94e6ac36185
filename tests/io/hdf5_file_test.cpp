// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/hdf5_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/stat.h>

#include <algorithm>
#include <thread>
#include <vector>

#include "tests/support/error_message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/io/hdf5_server.hpp"

namespace truebearing::hdf5_file_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::error_message;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::TemporaryFolder;

std::string two_rows() {
  Hdf5Writer writer("two rows");
  writer.add("data", {2, 3});
  writer.write_row("data", 1, std::vector{4.0, 5.0, 6.0});
  writer.write_row("data", 0, std::vector{1.0, 2.0, 3.0});
  writer.add_attribute("data", "scale", 0.1);
  return writer.str();
}

TEST(Hdf5File, WhatIsWrittenReadsBack) {
  const TemporaryFolder folder;
  const Hdf5Reader reader(folder.write("a.h5", two_rows()));
  EXPECT_TRUE(reader.has("data"));
  EXPECT_FALSE(reader.has("other"));
  EXPECT_THAT(reader.shape("data"), ElementsAre(2, 3));
  std::vector<double> values(6);
  reader.read("data", values);
  EXPECT_THAT(values, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_EQ(reader.attribute("data", "scale"), 0.1);
  EXPECT_EQ(reader.attribute("data", "offset"), std::nullopt);
}

TEST(Hdf5File, SameNumbersGiveTheSameBytesOnAnyThread) {
  const std::string expected = two_rows();
  std::vector<std::string> bytes(4);
  std::vector<std::thread> threads;
  for (std::string& one : bytes) threads.emplace_back([&one] { one = two_rows(); });
  for (std::thread& thread : threads) thread.join();
  for (const std::string& one : bytes) EXPECT_TRUE(one == expected);
}

TEST(Hdf5File, WritingTouchesNoFile) {
  const TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  two_rows();
  std::filesystem::current_path(before);
  EXPECT_EQ(folder.files(), 0);
}

TEST(Hdf5File, IsKnownByItsSignature) {
  const TemporaryFolder folder;
  EXPECT_TRUE(is_hdf5_file(folder.write("a", two_rows())));
  EXPECT_FALSE(is_hdf5_file(folder.write("b", "text")));
  EXPECT_FALSE(is_hdf5_file(folder.path()));
  EXPECT_FALSE(is_hdf5_file(folder.path() / "none"));
  const std::filesystem::path pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_FALSE(is_hdf5_file(pipe)) << "and does not wait for it";
}

TEST(Hdf5File, ErrorsNameFileAndDataset) {
  const TemporaryFolder folder;
  const Hdf5Reader reader(folder.write("a.h5", two_rows()));
  EXPECT_THAT(error_message([&] { reader.shape("other"); }), AllOf(HasSubstr("a.h5: other"), HasSubstr("cannot be")));
  std::vector<double> values(5);
  EXPECT_THAT(error_message([&] { reader.read("data", values); }), HasSubstr("a.h5: data: holds 6 numbers"));
  EXPECT_THAT(error_message([&] { Hdf5Reader none(folder.path() / "none.h5"); }), HasSubstr("No such file"));
  EXPECT_THAT(error_message([&] { Hdf5Reader folder_of_files(folder.path()); }), HasSubstr("not a regular file"));
}

std::vector<double> read_all(const std::filesystem::path& path, const std::string& dataset = "snapshots") {
  const Hdf5Reader reader(path);
  std::size_t size = 1;
  for (const std::uint64_t length : reader.shape(dataset)) size *= length;
  reader.check_holds(dataset, size);
  std::vector<double> values(size);
  reader.read(dataset, values);
  reader.attribute(dataset, "spacing_wavelengths");
  return values;
}

// In the first libhdf5 itself runs into a fault, in the second it reads past the end of a block.
TEST(Hdf5File, FilesThatTheLibraryDoesNotSurviveAreErrors) {
  const std::filesystem::path folder = std::filesystem::path(TRUEBEARING_SOURCE_DIR) / "tests/io/hostile";
  EXPECT_THAT(error_message([&] { read_all(folder / "segmentation_fault.h5", "time_s"); }),
              HasSubstr("segmentation_fault.h5: time_s"));
  EXPECT_THAT(error_message([&] { read_all(folder / "heap_over_read.h5"); }), HasSubstr("heap_over_read.h5"));
}

TEST(Hdf5File, RoomWithoutNumbersIsRefusedBeforeItTakesMemory) {
  const std::filesystem::path folder = std::filesystem::path(TRUEBEARING_SOURCE_DIR) / "tests/io/hostile";
  EXPECT_THAT(error_message([&] { read_all(folder / "two_gigabytes_of_nothing.h5"); }),
              AllOf(HasSubstr("snapshots: has room for"), HasSubstr("of which the file holds fewer")));
}

// A file whose dataset `snapshots` is 4 numbers made by `make`.
template <typename Make>
std::filesystem::path file_with(const TemporaryFolder& folder, const Make& make) {
  const std::filesystem::path path = folder.path() / "log.h5";
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t size = 4;
  const hid_t space = H5Screate_simple(1, &size, nullptr);
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  make(file, space, properties);
  H5Pclose(properties);
  H5Sclose(space);
  H5Fclose(file);
  return path;
}

hid_t add_snapshots(hid_t file, hid_t space, hid_t properties) {
  return H5Dcreate2(file, "snapshots", H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT);
}

TEST(Hdf5File, NumbersInOtherFilesAreRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path other = folder.write("other.h5", two_rows());
  const std::filesystem::path pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::filesystem::path& external : {other, pipe}) {
    const auto path = file_with(folder, [&](hid_t file, hid_t space, hid_t properties) {
      H5Pset_external(properties, external.c_str(), 0, 32);
      H5Dclose(add_snapshots(file, space, properties));
    });
    EXPECT_THAT(error_message([&] { read_all(path); }), HasSubstr("snapshots: is stored in other files"));
  }
  const auto linked = file_with(folder, [&](hid_t file, hid_t, hid_t) {
    H5Lcreate_external(other.c_str(), "data", file, "snapshots", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_THAT(error_message([&] { read_all(linked); }), AllOf(HasSubstr("log.h5: snapshots"), HasSubstr("external")));
  const auto softly = file_with(folder, [&](hid_t file, hid_t, hid_t) {
    H5Lcreate_external(other.c_str(), "/", file, "outside", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/outside/data", file, "snapshots", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_THAT(error_message([&] { read_all(softly); }), HasSubstr("log.h5: snapshots"));
}

TEST(Hdf5File, VirtualDatasetIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path other = folder.write("other.h5", two_rows());
  const auto path = file_with(folder, [&](hid_t file, hid_t space, hid_t properties) {
    H5Pset_virtual(properties, space, other.c_str(), "data", space);
    H5Dclose(add_snapshots(file, space, properties));
  });
  EXPECT_THAT(error_message([&] { read_all(path); }), HasSubstr("snapshots: is stored in other files"));
}

// What other programs write: in chunks, compressed, behind a link within the file.
TEST(Hdf5File, ChunksCompressionAndLinksWithinTheFileAreRead) {
  const TemporaryFolder folder;
  const std::vector<double> numbers{1, 2, 3, 4};
  const auto path = file_with(folder, [&](hid_t file, hid_t space, hid_t properties) {
    const hsize_t chunk = 3;
    H5Pset_chunk(properties, 1, &chunk);
    H5Pset_deflate(properties, 9);
    const hid_t data = H5Dcreate2(file, "elsewhere", H5T_IEEE_F32BE, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
    H5Dclose(data);
    H5Lcreate_soft("/elsewhere", file, "snapshots", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_EQ(read_all(path), numbers);
}

TEST(Hdf5File, MoreNumbersThanOneBufferHolds) {
  const TemporaryFolder folder;
  Hdf5Writer writer("many");
  constexpr std::uint64_t kRows = 5, kColumns = 600'000;
  writer.add("snapshots", {kRows, kColumns});
  std::vector<double> row(kColumns);
  for (std::uint64_t k = 0; k < kRows; ++k) {
    for (std::uint64_t i = 0; i < kColumns; ++i) row[i] = static_cast<double>(k * kColumns + i);
    writer.write_row("snapshots", k, row);
  }
  const std::vector<double> values = read_all(folder.write("many.h5", writer.str()));
  ASSERT_EQ(values.size(), kRows * kColumns);
  for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(values[i], static_cast<double>(i));
}

// A process that a damaged file has made say anything.
class Astray final : public Hdf5Respondent {
 public:
  explicit Astray(const Hdf5Answer& answer) : answer_(answer) {}

  void ask(const Hdf5Question&) override { is_asked_ = true; }
  bool receive(std::span<std::byte> bytes) override {
    const Hdf5Answer opened;
    const auto answer = std::as_bytes(std::span(is_asked_ ? &answer_ : &opened, 1));
    if (bytes.size() != answer.size()) return false;
    std::copy(answer.begin(), answer.end(), bytes.begin());
    return true;
  }
  std::string end() override { return "went astray"; }

 private:
  Hdf5Answer answer_;
  bool is_asked_ = false;
};

TEST(Hdf5File, WhatTheLibraryAnswersIsNotBelieved) {
  const auto message = [](const Hdf5Answer& answer, const auto& ask) {
    return error_message([&] { ask(Hdf5Reader("a.h5", std::make_unique<Astray>(answer))); });
  };
  Hdf5Answer answer;
  answer.rank = kHdf5MaxRank + 1;
  EXPECT_THAT(message(answer, [](const Hdf5Reader& reader) { reader.shape("data"); }),
              AllOf(HasSubstr("a.h5: data: is said to have 33 dimensions"), HasSubstr("at most 32")));
  answer = {};
  answer.failed = 2;
  answer.found.fill('x');
  answer.valid.fill('y');
  EXPECT_THAT(message(answer, [](const Hdf5Reader& reader) { reader.has("data"); }),
              AllOf(HasSubstr("a.h5: data: xxx"), Not(HasSubstr(std::string(answer.found.size() + 1, 'x')))));
  EXPECT_THAT(message({},
                      [](const Hdf5Reader& reader) {
                        std::vector<double> values(5);
                        reader.read("data", values);
                      }),
              HasSubstr("a.h5: data: cannot be read: the HDF5 library went astray"));
}

TEST(Hdf5File, AlteredBytesGiveNumbersOrAnError) {
  const TemporaryFolder folder;
  const std::string whole = two_rows();
  for (std::size_t i = 0; i < whole.size(); i += 21) {
    std::string altered = whole;
    altered[i] = static_cast<char>(altered[i] ^ 0x55);
    const std::filesystem::path path = folder.write("a.h5", altered);
    error_message([&] {
      const Hdf5Reader reader(path);
      if (reader.shape("data") != std::vector<std::uint64_t>{2, 3}) return;
      std::vector<double> values(6);
      reader.read("data", values);
      reader.attribute("data", "scale");
    });
  }
}

}  // namespace
}  // namespace truebearing::hdf5_file_test
