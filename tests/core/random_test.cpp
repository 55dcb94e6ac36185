// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/random.hpp"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "tests/support/statistics.hpp"

namespace truebearing::random_test {
namespace {

using testing::counts_are_even;
using testing::mean_margin;
using testing::moments;
using testing::variance_fits;

constexpr std::size_t kDraws = 200'000;

std::vector<double> normals(const RunKey& key, StreamId id, std::size_t count) {
  RandomStream stream(key, id);
  std::vector<double> values(count);
  for (double& value : values) value = stream.normal();
  return values;
}

TEST(Random, GeneratorIsPhilox4x64) {
  // First line of kat_vectors of Random123 for philox4x64-10: counter 0, key 0.
  const r123::Philox4x64::ctr_type block = r123::Philox4x64()({{0, 0, 0, 0}}, {{0, 0}});
  EXPECT_EQ(block[0], 0x16554d9eca36314cULL);
  EXPECT_EQ(block[1], 0xdb20fe9d672d0fdcULL);
  EXPECT_EQ(block[2], 0xd7e772cee186176bULL);
  EXPECT_EQ(block[3], 0x7e68b68aec7ba23bULL);
}

TEST(Random, StreamIsAFunctionOfItsKey) {
  const RunKey key{7, Role::training, 3};
  EXPECT_EQ(normals(key, StreamId::process, 100), normals(key, StreamId::process, 100));
}

TEST(Random, EveryPartOfTheKeySeparates) {
  std::set<std::uint64_t> seen;
  std::size_t drawn = 0;
  for (const std::uint64_t seed : {1ULL, 2ULL})
    for (const Role role : {Role::tuning, Role::training, Role::validation, Role::evaluation})
      for (const std::uint64_t run : {0ULL, 1ULL, 1000ULL})
        for (const StreamId id : {StreamId::scenario, StreamId::process, StreamId::measurement, StreamId::learning}) {
          RandomStream stream({seed, role, run}, id);
          for (int i = 0; i < 100; ++i, ++drawn) seen.insert(stream.bits());
        }
  EXPECT_EQ(seen.size(), drawn);  // two equal 64-bit numbers among 9600 come by chance once in 4e11
}

TEST(Random, NeighbouringStreamsAreUncorrelated) {
  const RunKey key{1, Role::evaluation, 0};
  const std::vector<double> base = normals(key, StreamId::process, kDraws);
  const std::vector<std::vector<double>> others = {normals({2, Role::evaluation, 0}, StreamId::process, kDraws),
                                                   normals({1, Role::training, 0}, StreamId::process, kDraws),
                                                   normals({1, Role::evaluation, 1}, StreamId::process, kDraws),
                                                   normals(key, StreamId::measurement, kDraws)};
  for (const std::vector<double>& other : others) {
    std::vector<double> products(kDraws);
    std::transform(base.begin(), base.end(), other.begin(), products.begin(), std::multiplies<>());
    EXPECT_LT(std::abs(moments(products).mean), mean_margin(1.0, kDraws));
  }
}

TEST(Random, UniformIsUniform) {
  RandomStream stream({1, Role::evaluation, 0}, StreamId::test);
  std::vector<int> counts(100), pairs(100);
  double last = 0.0;
  for (std::size_t i = 0; i < kDraws; ++i) {
    const double u = stream.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    ++counts[static_cast<std::size_t>(100.0 * u)];
    if (i % 2 == 1) ++pairs[10 * static_cast<std::size_t>(10.0 * last) + static_cast<std::size_t>(10.0 * u)];
    last = u;
  }
  EXPECT_TRUE(counts_are_even(counts));
  EXPECT_TRUE(counts_are_even(pairs));
  counts[0] += static_cast<int>(kDraws) / 300;
  EXPECT_FALSE(counts_are_even(counts)) << "the test cannot see a cell that is a third too full";
}

TEST(Random, IndexReachesEveryValueEvenly) {
  RandomStream stream({1, Role::evaluation, 0}, StreamId::test);
  std::vector<int> counts(7);
  for (std::size_t i = 0; i < kDraws; ++i) ++counts.at(stream.index(counts.size()));
  EXPECT_TRUE(counts_are_even(counts));
}

TEST(Random, NormalIsNormal) {
  const std::vector<double> values = normals({1, Role::evaluation, 0}, StreamId::test, kDraws);
  EXPECT_LT(std::abs(moments(values).mean), mean_margin(1.0, kDraws));
  EXPECT_TRUE(variance_fits(moments(values).variance, 1.0, kDraws));
  EXPECT_FALSE(variance_fits(moments(values).variance, 1.02, kDraws)) << "the test cannot see 2 % of variance";

  std::vector<double> edges;
  for (int i = 1; i < 50; ++i) edges.push_back(normal_quantile(i / 50.0));
  std::vector<int> counts(50);
  for (const double value : values)
    ++counts[static_cast<std::size_t>(std::upper_bound(edges.begin(), edges.end(), value) - edges.begin())];
  EXPECT_TRUE(counts_are_even(counts));
}

}  // namespace
}  // namespace truebearing::random_test
