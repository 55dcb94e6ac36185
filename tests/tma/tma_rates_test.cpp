// SPDX-License-Identifier: Apache-2.0
// How often target-motion analysis is right about simulated logs. TRUEBEARING_TMA_LOGS of each kind, ten where it is not
// set; with a thousand the figures of docs/bearings.md (CONTRIBUTING.md). TRUEBEARING_TMA_SEED gives others.
#include <boost/math/distributions/binomial.hpp>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/environment.hpp"
#include "tests/support/tma_rates.hpp"

namespace truebearing::tma_rates_test {
namespace {

using testing::rates_of;
using testing::scenario_with_turns;
using testing::TmaRates;

constexpr const char* kScenarios[] = {"cho_s1", "bearings_only_m", "passive_sonar_a"};
constexpr double kByChance = 1e-3;  // the tests' own level, for each window
constexpr double kMiss = 1e-5;      // how rarely chance breaks an expectation here

int logs_of_each_kind() {
  return testing::number_from_environment("TRUEBEARING_TMA_LOGS", 10);
}

std::uint64_t seed(int otherwise) {
  return static_cast<std::uint64_t>(testing::number_from_environment("TRUEBEARING_TMA_SEED", otherwise));
}

// No more than comes by chance where the rate is twice the level.
int most_false_alarms(int logs) {
  return static_cast<int>(quantile(complement(boost::math::binomial(logs, 2.0 * kByChance), kMiss)));
}
// No fewer than come by chance where the rate is `share`.
int fewest_found(double of, double share) {
  if (of < 1.0) return 0;
  return static_cast<int>(quantile(boost::math::binomial(std::floor(of), share), kMiss));
}

TEST(TmaRates, OfSteadyTargetsWithAndWithoutOutliers) {
  const int logs = logs_of_each_kind();
  fmt::print("{:<16} {:>5} {:>6} {:>8} {:>9} {:>5} {:>8} {:>6} {:>6} {:>6}\n", "steady target", "by", "to s",
             "outliers", "manoeuvre", "jump", "outliers", "can be", "found", "wrong");
  for (const char* name : kScenarios) {
    const auto scenario = scenario_with_turns(name, "");
    for (const char* method : {"ml", "map", "huber"})
      for (const double end_s : {300.0, 390.0, 1500.0, 1e9})
        for (const double share : {0.0, 0.01, 0.05}) {
          const TmaRates rates =
              rates_of(*scenario, {.method = method, .end_s = end_s, .outlier_share = share}, logs, seed(3));
          const double outliers = std::max(rates.outliers, 1);
          fmt::print("{:<16} {:>5} {:>6} {:>7.0f}% {:>9} {:>5} {:>8} {:>6.3f} {:>6.3f} {:>6}\n", name, method,
                     end_s < 1e9 ? fmt::format("{:.0f}", end_s) : "whole", 100.0 * share, rates.manoeuvres, rates.jumps,
                     rates.outliers, rates.outliers_to_find / outliers, rates.outliers_found / outliers,
                     rates.outliers_invented);
          std::fflush(stdout);
          EXPECT_LE(rates.manoeuvres, most_false_alarms(logs));
          EXPECT_LE(rates.jumps, most_false_alarms(logs));
          EXPECT_GE(rates.outliers_found, fewest_found(rates.outliers_to_find, 0.9));
        }
  }
}

TEST(TmaRates, OfTurnsOfThirtyDegrees) {
  const int logs = logs_of_each_kind();
  constexpr double kDegps = 3.0, kDegrees = 30.0, kWithin_s = 60.0;
  fmt::print("{:<16} {:>6} {:>9} {:>10} {:>6} {:>6} {:>8} {:>6} {:>6}\n", "turn of 30 deg", "at s", "dv m/s",
             "sigma m/s", "can be", "found", "sigma s", "can be", "dated");
  for (const auto& [name, times_s] : {std::pair("cho_s1", std::vector{900.0, 1800.0, 2700.0}),
                                      std::pair("bearings_only_m", std::vector{600.0, 960.0, 1320.0}),
                                      std::pair("passive_sonar_a", std::vector{700.0, 1050.0, 1500.0})})
    for (const double begin_s : times_s) {
      const double middle_s = begin_s + 0.5 * kDegrees / kDegps;
      const auto scenario = scenario_with_turns(
          name, fmt::format("turns = [{{ time_s = {}, by_deg = {}, rate_degps = {} }}]", begin_s, kDegrees, kDegps));
      const testing::TurnRates rates = testing::turn_rates_of(*scenario, middle_s, kWithin_s, logs, seed(5));
      fmt::print("{:<16} {:>6.0f} {:>9.2f} {:>10.3f} {:>6.3f} {:>6.3f} {:>8.1f} {:>6.3f} {:>6.3f}\n", name, begin_s,
                 rates.change_mps, rates.bound.sigma_mps, rates.bound.found, rates.found / static_cast<double>(logs),
                 rates.bound.time_sigma_s, rates.bound.dated(kWithin_s),
                 rates.dated / std::max(1.0, static_cast<double>(rates.found)));
      std::fflush(stdout);
      if (rates.bound.found < 0.95) continue;  // what is found in 95 % at best may come to 90 % by chance
      EXPECT_GE(rates.found, fewest_found(logs, 0.9));
      EXPECT_GE(rates.dated, fewest_found(rates.found, std::min(0.8, rates.bound.dated(kWithin_s))));
    }
}

}  // namespace
}  // namespace truebearing::tma_rates_test
