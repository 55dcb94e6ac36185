// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/parameters_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include "tests/support/error_message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/io/table_reader.hpp"

namespace truebearing::parameters_file_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

TEST(ParametersFile, ReadsBackWhatItWrote) {
  const TemporaryFolder folder;
  ParametersFile written;
  written.provenance = {{"study", "a \"quoted\" \\ name"}, {"seed", "1"}};
  written.trackers["tuned"] = {{"motion.variance", {5.0, 1.5e-7}}, {"measurement.variance_m2", {1e7}}};
  written.trackers["with space.and dot"] = {{"motion.sigma_a_mps2", {1.25}}};
  const ParametersFile read = read_parameters_file(folder.write("p.toml", parameters_text(written)));
  EXPECT_EQ(read.trackers, written.trackers);
  EXPECT_EQ(read.provenance, written.provenance);
  EXPECT_EQ(parameters_text(read), parameters_text(written));
}

TEST(ParametersFile, NumbersThatAreNotPositiveAreRefused) {
  const TemporaryFolder folder;
  for (const char* bad : {"0.0", "-1.0", "nan", "inf", "\"5\"", "[1.0, 0.0]"})
    EXPECT_THAT(
        error_message([&] { read_parameters_file(folder.write("p.toml", std::string("[tuned]\n\"a.b\" = ") + bad)); }),
        AllOf(HasSubstr("p.toml"), HasSubstr("a.b")))
        << bad;
}

TEST(NumbersAt, PathLeadsToNumbers) {
  const SharedTable table =
      parse_toml("[motion]\nvariance = [5, 0.1]\nsigma = 2\nname = \"x\"\nzero = [1.0, 0.0]\n", "s.toml");
  EXPECT_EQ(numbers_at(*table, "motion.variance", "here"), (std::vector<double>{5.0, 0.1}));
  EXPECT_EQ(numbers_at(*table, "motion.sigma", "here"), std::vector<double>{2.0});
  for (const char* bad : {"motion", "motion.name", "motion.other", "other.variance", "", "motion.variance.x"})
    EXPECT_THAT(error_message([&] { numbers_at(*table, bad, "here"); }), AllOf(HasSubstr("here"), HasSubstr(bad)))
        << bad;
  EXPECT_THAT(error_message([&] { numbers_at(*table, "motion.zero", "here"); }), HasSubstr("> 0"));
}

TEST(WithNumbers, KeepsArraysArraysAndNumbersNumbers) {
  SharedTable table = parse_toml("[motion]\nvariance = [5, 0.1]\none = [7]\nsigma = 2\n", "s.toml");
  table = with_numbers(*table, "motion.variance", {1.0, 2.0});
  table = with_numbers(*table, "motion.one", {3.0});
  table = with_numbers(*table, "motion.sigma", {4.0});
  table = with_numbers(*table, "start.new.deep", {5.0});
  EXPECT_EQ(numbers_at(*table, "motion.variance", ""), (std::vector<double>{1.0, 2.0}));
  EXPECT_TRUE(table->at_path("motion.one").is_array());
  EXPECT_TRUE(table->at_path("motion.sigma").is_floating_point());
  EXPECT_EQ(numbers_at(*table, "start.new.deep", ""), std::vector<double>{5.0});
}

}  // namespace
}  // namespace truebearing::parameters_file_test
