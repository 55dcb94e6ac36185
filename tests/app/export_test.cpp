// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/app/program_tests.hpp"

namespace truebearing::app_test::export_test {
namespace {

const std::string kModels = TRUEBEARING_SOURCE_DIR "/models/";

TEST(Export, WritesARecurrentNetworkAsOnnx) {
  const TemporaryFolder folder;
  const Outcome outcome = run(folder, "export " + kModels + "radar_2d.gru.json --to onnx -o radar.onnx");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "written: radar.onnx\n");
  const std::string bytes = folder.read("radar.onnx");
  EXPECT_THAT(bytes, AllOf(HasSubstr("radar_2d.gru"), HasSubstr("linear_before_reset")));
  EXPECT_EQ(run(folder, "export " + kModels + "radar_2d.gru.json --to onnx -o -").out, bytes);
}

TEST(Export, NamesTheFileAfterTheModel) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "copy");
  for (const auto& entry : std::filesystem::directory_iterator(kModels))
    if (entry.path().filename().string().rfind("radar_2d.gru", 0) == 0)
      std::filesystem::copy(entry.path(), folder.path() / "copy");
  ASSERT_EQ(run(folder, "export copy/radar_2d.gru.json --to onnx").status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "copy/radar_2d.gru.onnx"));
}

TEST(Export, RefusesRulesAndOtherFormats) {
  const TemporaryFolder folder;
  const std::string rules = kModels + "radar_2d.nfnn.json", network = kModels + "radar_2d.gru.json";
  for (const auto& [arguments, says] :
       {std::pair{rules + " --to onnx -o x", "holds rules (nfnn); valid: a recurrent network (gru)"},
        {network + " --to torchscript -o x", "--to: is \"torchscript\"; valid: onnx"},
        {network + " --to onnx -o " + network, "is read by this command"}}) {
    const Outcome outcome = run(folder, "export " + arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(says)) << arguments;
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "x"));
}

}  // namespace
}  // namespace truebearing::app_test::export_test
