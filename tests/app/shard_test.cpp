// SPDX-License-Identifier: Apache-2.0
// compare --shard and merge, as the jobs of a batch system call them.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <fstream>

#include "tests/app/program_tests.hpp"
#include "tests/app/without_timings.hpp"

namespace truebearing::app_test::shard_test {
namespace {

using testing::without_timings;

void write_shards(const TemporaryFolder& folder, int count, const std::string& options) {
  for (int i = 1; i <= count; ++i) {
    const Outcome outcome = run(
        folder, fmt::format("compare small.toml --shard {}/{} --json part{}.json --quiet {}", i, count, i, options));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    ASSERT_EQ(outcome.out, "");
  }
}

TEST(Shards, MergeToTheResultsOfOneProcessByteForByte) {
  const TemporaryFolder folder;
  write_study(folder, tuned_study());
  for (const char* runs : {"--runs 3", "--runs 301"}) {
    ASSERT_EQ(run(folder, fmt::format("compare small.toml {} --json one.json --report one.html", runs)).status, 0);
    write_shards(folder, 5, fmt::format("{} --details --threads 1", runs));
    const Outcome merged =
        run(folder, "merge part3.json part1.json part5.json part2.json part4.json -o all.json --report all.html");
    ASSERT_EQ(merged.status, 0) << merged.err;
    EXPECT_EQ(without_timings(folder.read("all.json")), without_timings(folder.read("one.json")));
    EXPECT_EQ(last_line(merged.out), last_line(run(folder, fmt::format("compare small.toml {}", runs)).out));
    EXPECT_THAT(folder.read("all.html"), HasSubstr("<figure>"));
  }
}

TEST(Shards, OfAStudyWhosePathIsNoTextAreRefused) {
  const TemporaryFolder folder;
  write_study(folder, tuned_study());
  const Outcome outcome = run(folder, "compare \"$here/small.toml\" --shard 1/2 --json part1.json",
                              "here=$(printf 'K\\344se'); mkdir \"$here\"; cp *.toml \"$here\";");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("K\\xe4se/small.toml: is a path in no UTF-8, which a shard's header is; valid: "
                                     "a folder of another name"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "part1.json"));
}

TEST(Shards, OfWhatDoesNotBelongTogetherAreRefused) {
  const TemporaryFolder folder;
  write_study(folder, tuned_study());
  write_shards(folder, 3, "--runs 12");
  const auto other = [&](const std::string& options) {
    ASSERT_EQ(run(folder, "compare small.toml --json other.json --quiet " + options).status, 0);
  };
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Outcome outcome = run(folder, "merge -o all.json " + arguments);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "all.json"));
  };
  refused("part1.json part3.json", "merge: shard 2/3 is missing");
  refused("part1.json part2.json", "merge: shard 3/3 is missing");
  refused("part2.json part3.json", "merge: shard 1/3 is missing");
  refused("part1.json part2.json part2.json part3.json", "part2.json: is shard 2/3, as part2.json is");
  refused("part1.json part2.json nothing.json", "nothing.json: cannot be read");
  refused("part1.json small.toml", "small.toml: is no shard of a comparison");
  refused("part1.json part2.json part3.json --report page.html", "part1.json: has nothing for the plots of a page");
  other("--shard 3/3 --runs 12 --seed 99");
  refused("part1.json part2.json other.json", "other.json: is of seed 99, and part1.json of seed 5");
  other("--shard 3/3 --runs 13");
  refused("part1.json part2.json other.json", "other.json: is of 13 runs, and part1.json of 12 runs");
  other("--shard 3/4 --runs 12");
  refused("part1.json part2.json other.json", "other.json: is of 4 shards, and part1.json of 3 shards");
  other("--shard 3/3 --runs 12 --details");
  refused("part1.json part2.json other.json", "other.json: is of a comparison with --details");
  other("--shard 3/3 --runs 12 --all");
  refused("part1.json part2.json other.json", "other.json: is of a comparison with --all");
  other("--runs 12");
  refused("part1.json part2.json other.json", "other.json: is no shard of a comparison");

  const std::string whole = folder.read("part2.json");
  folder.write("cut.json", whole.substr(0, whole.rfind('[')));
  refused("part1.json cut.json part3.json", "cut.json: ends at block 7");
  folder.write("cut.json", whole.substr(0, whole.size() - 30));
  refused("part1.json cut.json part3.json", "cut.json: is damaged at block 7");
  folder.write("cut.json", replaced(whole, "AAAA", ""));
  refused("part1.json cut.json part3.json", "tally of runs");
  folder.write("cut.json", whole + "\n");
  refused("part1.json cut.json part3.json", "cut.json: goes on behind its last block");
  folder.write("cut.json", replaced(whole, "\"runs\":", "\"runs\":-"));
  refused("part1.json cut.json part3.json", "cut.json: is no shard of a comparison");
  folder.write("cut.json", replaced(whole, "\"version\":\"", "\"version\":\"9"));
  refused("part1.json cut.json part3.json", "cut.json: is of version \"9");

  write_study(folder, tuned_study() + "# changed\n");
  refused("part1.json part2.json part3.json", "has changed since part1.json was written");
  other("--shard 3/3 --runs 12");
  refused("part1.json part2.json other.json", "other.json: was made with another text of the study");
  std::filesystem::remove(folder.path() / "small.toml");
  refused("part1.json part2.json part3.json", "which is not there");
}

// As mpirun starts it, where the program has not been built with MPI.
TEST(Ranks, NeedAProgramThatWasBuiltWithMpi) {
  if (std::filesystem::exists(std::filesystem::path(TRUEBEARING_PROGRAM).parent_path() / "truebearing_mpi.so"))
    GTEST_SKIP() << "tests/mpi runs it";
  const TemporaryFolder folder;
  write_study(folder, tuned_study());
  const Outcome outcome = run(folder, "compare small.toml --json one.json", "export OMPI_COMM_WORLD_SIZE=2;");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("this build of truebearing knows nothing of MPI"));
  EXPECT_EQ(run(folder, "compare small.toml --runs 2", "export OMPI_COMM_WORLD_SIZE=1;").status, 0);
}

TEST(Shards, OptionsThatMakeNoShardAreRefused) {
  const TemporaryFolder folder;
  write_study(folder, tuned_study());
  const auto refused = [&](const std::string& options, const std::string& message) {
    const Outcome outcome = run(folder, "compare small.toml " + options);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(message));
  };
  for (const char* shard : {"0/2", "3/2", "1", "1/", "/2", "a/b", "1/2/3", "1/-2", "1/99999999999999999999"})
    refused(fmt::format("--json part.json --shard {}", shard), "--shard: is \"");
  refused("--shard 1/2", "--shard: has no file to be written to");
  refused("--shard 1/2 --json part.json --report page.html", "--shard: is no whole comparison to be drawn");
  refused("--shard 1/2 --json part.json --retrain", "--retrain: would train in every shard");
  refused("--shard 1/2 --json part.json --truth log.csv", "--truth: is of one process");
  refused("--details", "--details: is of a shard");
}

}  // namespace
}  // namespace truebearing::app_test::shard_test
