// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/safetensors.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>

#include "tests/support/error_message.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::safetensors_test {
namespace {

using testing::error_message;

std::string file_of(const std::string& header, std::size_t data_bytes) {
  std::string bytes(8, '\0');
  const std::uint64_t size = header.size();
  std::memcpy(bytes.data(), &size, 8);
  return bytes + header + std::string(data_bytes, '\0');
}

std::string refusal(const std::string& header, std::size_t data_bytes) {
  return error_message([&] { parse_safetensors(file_of(header, data_bytes), "w.safetensors"); });
}

Tensors some_tensors() {
  Tensors tensors;
  tensors["b"] = {Eigen::MatrixXf{{1.5F}, {-2.0F}}, true};
  tensors["a.weight"] = {Eigen::MatrixXf{{1.0F, 2.0F, 3.0F}, {4.0F, 5.0F, 6.0F}}, false};
  return tensors;
}

TEST(Safetensors, AreReadAsTheyWereWritten) {
  const std::string bytes = safetensors_bytes(some_tensors());
  const Tensors read = parse_safetensors(bytes, "w");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read.at("b").values, some_tensors().at("b").values);
  EXPECT_TRUE(read.at("b").vector);
  EXPECT_EQ(read.at("a.weight").values, some_tensors().at("a.weight").values);
  EXPECT_FALSE(read.at("a.weight").vector);
  EXPECT_EQ(safetensors_bytes(read), bytes);
}

// As the format's description has it: eight bytes of length, JSON, numbers by rows, little-endian.
TEST(Safetensors, AreLaidOutAsOthersReadThem) {
  const std::string bytes = safetensors_bytes(some_tensors());
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data(), 8);
  EXPECT_EQ(length % 8, 0u);
  EXPECT_EQ(bytes.substr(8, length).substr(0, 70),
            R"({"a.weight":{"dtype":"F32","shape":[2,3],"data_offsets":[0,24]},"b":{")");
  ASSERT_EQ(bytes.size(), 8 + length + 8 * sizeof(float));
  float third = 0.0F;
  std::memcpy(&third, bytes.data() + 8 + length + 2 * sizeof(float), sizeof third);
  EXPECT_EQ(third, 3.0F) << "the end of the first row";
}

TEST(Safetensors, ThatAreNotAreRefusedByName) {
  const auto entry = [](const char* dtype, const char* shape, const char* offsets) {
    return std::string(R"({"x":{"dtype":")") + dtype + R"(","shape":)" + shape + R"(,"data_offsets":)" + offsets + "}}";
  };
  EXPECT_EQ(refusal(entry("F32", "[2]", "[0,8]"), 8), "no error");
  EXPECT_EQ(refusal(R"({"__metadata__":{"by":"hand"}})", 0), "no error");
  EXPECT_NE(refusal(entry("F64", "[1]", "[0,8]"), 8).find("x.dtype: is \"F64\""), std::string::npos);
  EXPECT_NE(refusal(entry("F32", "[2]", "[0,4]"), 4).find("x.data_offsets"), std::string::npos);
  EXPECT_NE(refusal(entry("F32", "[2]", "[4,12]"), 12).find("x.data_offsets"), std::string::npos) << "a hole";
  EXPECT_NE(refusal(entry("F32", "[2]", "[0,8]"), 4).find("x.data_offsets"), std::string::npos) << "beyond the file";
  EXPECT_NE(refusal(entry("F32", "[2]", "[0,8]"), 12).find("4 bytes of no tensor"), std::string::npos);
  EXPECT_NE(refusal(entry("F32", "[1,1,2]", "[0,8]"), 8).find("x.shape"), std::string::npos);
  EXPECT_NE(refusal(entry("F32", "[0]", "[0,0]"), 0).find("x.shape"), std::string::npos);
  EXPECT_NE(refusal(entry("F32", "[-1]", "[0,8]"), 8).find("a count"), std::string::npos);
  EXPECT_NE(refusal(entry("F32", "[9223372036854775807,4]", "[0,8]"), 8).find("x.shape"), std::string::npos);
  EXPECT_NE(refusal("[]", 0).find("is no object"), std::string::npos);
  EXPECT_NE(error_message([] { parse_safetensors("short", "w"); }).find("is no safetensors file"), std::string::npos);
  EXPECT_NE(error_message([] { parse_safetensors(std::string(16, '\xff'), "w"); }).find("is cut off"),
            std::string::npos);
}

TEST(Safetensors, NumbersThatAreNoneAreRefused) {
  for (const float value : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    Tensors tensors = some_tensors();
    tensors["b"].values(1, 0) = value;
    EXPECT_NE(error_message([&] { parse_safetensors(safetensors_bytes(tensors), "w"); }).find("w: b: holds a number"),
              std::string::npos);
  }
}

TEST(Safetensors, AlteredBytesGiveTensorsOrAnError) {
  const std::string good = safetensors_bytes(some_tensors());
  RandomStream random({}, StreamId::test);
  for (int k = 0; k < 5000; ++k) {
    std::string bytes = good;
    for (int change = 0; change < 3; ++change)
      bytes[static_cast<std::size_t>(random.uniform() * static_cast<double>(bytes.size()))] =
          static_cast<char>(static_cast<int>(256.0 * random.uniform()) - 128);
    if (random.uniform() < 0.2)
      bytes.resize(static_cast<std::size_t>(random.uniform() * static_cast<double>(bytes.size())));
    try {
      for (const auto& [name, tensor] : parse_safetensors(bytes, "w")) ASSERT_TRUE(tensor.values.allFinite());
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace truebearing::safetensors_test
