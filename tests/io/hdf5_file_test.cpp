#include "truebearing/io/hdf5_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <thread>
#include <vector>

#include "tests/support/error_message.hpp"
#include "tests/support/temporary_folder.hpp"

namespace truebearing::hdf5_file_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::error_message;
using ::testing::HasSubstr;
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

// HDF5 1.10 may complain at exit that it cannot close what it found damaged.
TEST(Hdf5File, AlteredBytesGiveNumbersOrAnError) {
  const TemporaryFolder folder;
  const std::string whole = two_rows();
  for (std::size_t i = 0; i < whole.size(); i += 5) {
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
