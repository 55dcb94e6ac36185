// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/angle_path.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_message.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing::angle_path_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

AnglePath read(const std::string& text) {
  const SharedTable table = parse_toml(text, "path.toml");
  TableReader reader(table, "path.toml");
  AnglePath path = read_angle_path(reader);
  reader.finish();
  return path;
}

const std::string kAll = R"(
start_deg = -45.0
rate_degps = 0.4
sine = { amplitude_deg = 10.0, period_s = 40.0, until_s = 50.0 }
bend = { height_deg = -20.0, centre_s = 30.0, width_s = 10.0 }
hyperbola = { rate_degps = 0.7, centre_s = 30.0, closest_deg = 1.5 }
)";

TEST(AnglePath, IsTheSumOfItsTerms) {
  const AnglePath path = read(kAll);
  for (const double t : {-1.0, 0.0, 12.0, 30.0, 49.0, 70.0}) {
    const double expected_deg = -45.0 + 0.4 * t + 10.0 * std::sin(2.0 * kPi * std::min(t, 50.0) / 40.0) -
                                20.0 * std::tanh((t - 30.0) / 10.0) +
                                std::sqrt(0.7 * (t - 30.0) * 0.7 * (t - 30.0) + 2.25);
    EXPECT_NEAR(degrees(path.angle_rad(t)), expected_deg, 1e-12) << t;
  }
}

TEST(AnglePath, RateIsTheDerivativeOfTheAngle) {
  constexpr double kStep_s = 1e-4;
  for (const std::string& text :
       {std::string("start_deg = 5\n"), std::string("start_deg = 5\nrate_degps = -0.8\n"),
        std::string("start_deg = 5\nsine = { amplitude_deg = 10, period_s = 40, until_s = 50 }\n"),
        std::string("start_deg = 5\nsine = { amplitude_deg = 10, period_s = 40 }\n"),
        std::string("start_deg = 5\nbend = { height_deg = -20, centre_s = 30, width_s = 10 }\n"),
        std::string("start_deg = 5\nhyperbola = { rate_degps = 0.7, centre_s = 30, closest_deg = 1.5 }\n"), kAll}) {
    const AnglePath path = read(text);
    for (double t = -5.0; t < 80.0; t += 3.7) {
      const double difference = (path.angle_rad(t + kStep_s) - path.angle_rad(t - kStep_s)) / (2.0 * kStep_s);
      EXPECT_NEAR(path.rate_at_radps(t), difference, 1e-6 * radians(1.0)) << text << t;
    }
  }
}

TEST(AnglePath, SineStopsWhereItIsToldTo) {
  const AnglePath path = read("start_deg = 20\nsine = { amplitude_deg = 10, period_s = 40, until_s = 50 }\n");
  EXPECT_EQ(path.angle_rad(51.0), path.angle_rad(500.0));
  EXPECT_EQ(path.rate_at_radps(51.0), 0.0);
  EXPECT_NE(path.rate_at_radps(49.0), 0.0);
}

TEST(AnglePath, RefusesWhatIsNone) {
  const auto refusal = [](const std::string& text) { return error_message([&] { read(text); }); };
  EXPECT_THAT(refusal("rate_degps = 1.0\n"), HasSubstr("start_deg"));
  EXPECT_THAT(refusal("start_deg = 91.0\n"), HasSubstr("start_deg"));
  EXPECT_THAT(refusal("start_deg = 1.0\nrate_degs = 1.0\n"), HasSubstr("rate_degps"));
  EXPECT_THAT(refusal("start_deg = 1.0\nsine = { amplitude_deg = 1.0 }\n"), HasSubstr("period_s"));
  EXPECT_THAT(refusal("start_deg = 1.0\nsine = { amplitude_deg = 1.0, period_s = 0.0 }\n"), HasSubstr("sine.period_s"));
  EXPECT_THAT(refusal("start_deg = 1.0\nbend = { height_deg = 1.0, centre_s = 0.0, width = 1.0 }\n"),
              HasSubstr("width_s"));
  EXPECT_THAT(refusal("start_deg = 1.0\nhyperbola = { rate_degps = 1.0, centre_s = 0.0, closest_deg = 0.0 }\n"),
              HasSubstr("closest_deg"));
}

}  // namespace
}  // namespace truebearing::angle_path_test
