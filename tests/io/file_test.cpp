// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <thread>
#include <vector>

#include "tests/support/error_message.hpp"
#include "tests/support/temporary_folder.hpp"

namespace truebearing::file_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
namespace fs = std::filesystem;

constexpr std::size_t kAny = std::size_t{1} << 30;

class FileTest : public ::testing::Test {
 protected:
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(folder_), {}); }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(FileTest, WrittenTextReadsBack) {
  const std::string text("line\n\0 and \xff", 12);
  write_file_atomically(folder_ / "a", text);
  EXPECT_EQ(read_text_file(folder_ / "a", kAny), text);
  write_file_atomically(folder_ / "a", "shorter");
  EXPECT_EQ(read_text_file(folder_ / "a", kAny), "shorter");
  EXPECT_EQ(files(), 1);
}

TEST_F(FileTest, RelativePathIsWrittenWhereItSays) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  write_file_atomically("a", "text");
  fs::current_path(before);
  EXPECT_EQ(read_text_file(folder_ / "a", kAny), "text");
}

TEST_F(FileTest, SizeLimitIsExact) {
  write_file_atomically(folder_ / "a", std::string(100'000, 'x'));
  EXPECT_EQ(read_text_file(folder_ / "a", 100'000).size(), 100'000u);
  EXPECT_THAT(error_message([&] { read_text_file(folder_ / "a", 99'999); }), HasSubstr("too large"));
  EXPECT_THAT(error_message([] { read_text_file("/dev/zero", 1000); }), HasSubstr("too large"));
}

TEST_F(FileTest, UnreadableFileIsAnErrorThatSaysWhy) {
  EXPECT_THAT(error_message([&] { read_text_file(folder_ / "none", kAny); }),
              AllOf(HasSubstr((folder_ / "none").string()), HasSubstr("No such file")));
  EXPECT_THAT(error_message([&] { read_text_file(folder_, kAny); }), HasSubstr("Is a directory"));
}

TEST_F(FileTest, MissingFolderIsAnErrorThatSaysWhy) {
  EXPECT_THAT(error_message([&] { write_file_atomically(folder_ / "none" / "a", "text"); }),
              AllOf(HasSubstr((folder_ / "none" / "a").string()), HasSubstr("No such file")));
  EXPECT_EQ(files(), 0);
}

TEST_F(FileTest, DeviceAndFolderAreNotReplaced) {
  EXPECT_THAT(error_message([&] { write_file_atomically("/dev/null", "text"); }), HasSubstr("not a regular file"));
  EXPECT_THAT(error_message([&] { write_file_atomically(folder_, "text"); }), HasSubstr("not a regular file"));
}

TEST_F(FileTest, SymbolicLinkStaysOne) {
  write_file_atomically(folder_ / "a", "old");
  fs::create_symlink("a", folder_ / "link");
  write_file_atomically(folder_ / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(read_text_file(folder_ / "a", kAny), "new");
}

TEST_F(FileTest, SymbolicLinkToWhatIsNotThereYetStaysOne) {
  fs::create_directory(folder_ / "inner");
  fs::create_symlink("inner/middle", folder_ / "link");
  fs::create_symlink("a", folder_ / "inner/middle");
  write_file_atomically(folder_ / "link", "text");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "inner/middle"));
  EXPECT_EQ(read_text_file(folder_ / "inner/a", kAny), "text");
  fs::create_symlink("circle", folder_ / "circle");
  EXPECT_THAT(error_message([&] { write_file_atomically(folder_ / "circle", "text"); }), HasSubstr("symbolic links"));
}

TEST_F(FileTest, ModeOfTheOldFileIsKept) {
  for (const mode_t mode : {0600u, 0640u, 0755u}) {
    write_file_atomically(folder_ / "a", "old");
    ASSERT_EQ(::chmod((folder_ / "a").c_str(), mode), 0);
    write_file_atomically(folder_ / "a", "new");
    struct stat now {};
    ASSERT_EQ(::stat((folder_ / "a").c_str(), &now), 0);
    EXPECT_EQ(now.st_mode & 07777u, mode);
    EXPECT_EQ(read_text_file(folder_ / "a", kAny), "new");
  }
  const mode_t mask = ::umask(0027);
  write_file_atomically(folder_ / "b", "text");
  ::umask(mask);
  struct stat made {};
  ASSERT_EQ(::stat((folder_ / "b").c_str(), &made), 0);
  EXPECT_EQ(made.st_mode & 07777u, 0640u) << "a new one has the mode that the user's mask leaves";
}

TEST_F(FileTest, WhatAKilledWriterLeftIsRemovedByTheNextRun) {
  const fs::path left = temporary_.write(".truebearing-1-0.tmp", "half a te");
  const fs::path at_work = temporary_.write(".truebearing-1-1.tmp", "half a te");
  const fs::path of_others = temporary_.write(".other-1-0.tmp", "");
  const int lock = ::open(at_work.c_str(), O_WRONLY);
  ASSERT_EQ(::flock(lock, LOCK_EX), 0);
  write_file_atomically(folder_ / "a", "text");
  ::close(lock);
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(at_work)) << "whoever writes it holds its lock";
  EXPECT_TRUE(fs::exists(of_others));
}

TEST_F(FileTest, WriteThatRunsOutOfSpaceLeavesTheOldFile) {
  write_file_atomically(folder_ / "a", "old");
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  const std::string message = error_message([&] { write_file_atomically(folder_ / "a", std::string(10'000, 'x')); });
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);

  EXPECT_THAT(message, HasSubstr("File too large"));
  EXPECT_EQ(read_text_file(folder_ / "a", kAny), "old");
  EXPECT_EQ(files(), 1);
}

TEST_F(FileTest, OfTwoWritersOneWinsWhole) {
  const auto write_often = [&](char letter) {
    for (int i = 0; i < 20; ++i) write_file_atomically(folder_ / "a", std::string(200'000, letter));
  };
  write_often('x');
  std::thread other(write_often, 'y');
  std::thread reader([&] {
    for (int i = 0; i < 200; ++i) {
      const std::string text = read_text_file(folder_ / "a", kAny);
      ASSERT_EQ(text, std::string(200'000, text[0]));
    }
  });
  write_often('z');
  other.join();
  reader.join();
  EXPECT_EQ(files(), 1);
}

TEST_F(FileTest, WriterLeavesNothingBehindWithoutCommit) {
  const std::filesystem::path path = folder_ / "pieces.txt";
  {
    FileWriter writer(path);
    writer.write("one ");
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
  FileWriter writer(path);
  writer.write("one ");
  writer.write("two");
  EXPECT_FALSE(std::filesystem::exists(path)) << "not before it is whole";
  writer.commit();
  EXPECT_EQ(read_text_file(path, 100), "one two");
}

TEST_F(FileTest, NameLeftOverFromAKilledWriterIsPassedOver) {
  const auto leftover = [&](int i) {
    return folder_ / (".truebearing-" + std::to_string(::getpid()) + "-" + std::to_string(i) + ".tmp");
  };
  // The names that this process would use next are all taken.
  for (int i = 0; i < 2000; ++i) fs::create_symlink("nowhere", leftover(i));
  write_file_atomically(folder_ / "a", "text");
  EXPECT_EQ(read_text_file(folder_ / "a", kAny), "text");
  EXPECT_TRUE(fs::is_symlink(leftover(1999)));
}

TEST(MatchingFiles, StarIsAnyTextInTheFilesName) {
  const TemporaryFolder folder;
  for (const char* name : {"run_10.csv", "run_02.csv", "run_1.txt", "other.csv", ".run_3.csv"}) folder.write(name, "");
  const auto names = [&](const std::string& pattern) {
    std::vector<std::string> found;
    for (const auto& path : matching_files(folder.path() / pattern)) {
      EXPECT_EQ(path.parent_path(), folder.path());
      found.push_back(path.filename().string());
    }
    return found;
  };
  EXPECT_EQ(names("run_*.csv"), (std::vector<std::string>{"run_02.csv", "run_10.csv"}));
  EXPECT_EQ(names("*_1*"), (std::vector<std::string>{"run_1.txt", "run_10.csv"}));
  EXPECT_EQ(names("*"), (std::vector<std::string>{"other.csv", "run_02.csv", "run_1.txt", "run_10.csv"}));
  EXPECT_EQ(names("r*n*0*2.csv"), (std::vector<std::string>{"run_02.csv"}));
  EXPECT_EQ(names("nowhere.csv"), (std::vector<std::string>{"nowhere.csv"})) << "who opens it will say";
}

TEST(MatchingFiles, NoMatchIsAnError) {
  const TemporaryFolder folder;
  folder.write("run.csv", "");
  for (const char* pattern : {"run*x", "run.csv*run.csv", "nowhere/*.csv"})
    EXPECT_THAT(error_message([&] { matching_files(folder.path() / pattern); }), HasSubstr("matches no file"))
        << pattern;
  EXPECT_THAT(error_message([&] { matching_files(folder.path() / "*/run.csv"); }), HasSubstr("name of a folder"));
}

}  // namespace
}  // namespace truebearing::file_test
