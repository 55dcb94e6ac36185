// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/run_words.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace truebearing::run_words_test {
namespace {

// What a run draws.
using Run = std::function<std::vector<double>(RandomStream&)>;

std::vector<double> draw(RunWords& words, const Run& run) {
  const TakeRandomFrom taken(words);
  RandomStream stream({.seed = 3, .run = 8}, StreamId::measurement);
  return run(stream);
}

Run uniforms(std::size_t count) {
  return [count](RandomStream& stream) {
    std::vector<double> all(count);
    for (double& u : all) u = stream.uniform();
    return all;
  };
}

std::vector<double> normals(RandomStream& stream) {
  std::vector<double> all(8);
  for (double& z : all) z = stream.normal();
  return all;
}

// Further normals where the first is positive.
std::vector<double> more_or_less(RandomStream& stream) {
  std::vector<double> all{stream.normal()};
  if (all.front() > 0.0)
    for (int i = 0; i < 5; ++i) all.push_back(stream.normal());
  return all;
}

TEST(RunWords, OfAPlainRunAreTheGenerators) {
  RandomStream generator({.seed = 3, .run = 8}, StreamId::measurement);
  RunWords words;
  EXPECT_EQ(draw(words, normals), normals(generator));
  EXPECT_EQ(words.size(), 8u);
  RandomStream chain({}, StreamId::test);
  words.keep_what_was_read();
  RunWords moved(words, {true, 1.0}, chain);
  RandomStream other({.seed = 3, .run = 8}, StreamId::measurement);
  EXPECT_NE(draw(moved, normals), normals(other));
}

TEST(RunWords, OfAStreamThatIsBegunAgainAreTheSame) {
  RandomStream chain({}, StreamId::test);
  RunWords plain;
  draw(plain, normals);
  plain.keep_what_was_read();
  RunWords moved(plain, {true, 0.5}, chain);
  const std::vector<double> first = draw(moved, uniforms(20));
  EXPECT_EQ(draw(moved, uniforms(20)), first);
}

// 40000 words in twenty cells: chi-square with 19 degrees of freedom, above 43.8 once in a thousand. So for a chain
// that goes on and on, as rounding or a wrong step would show there.
TEST(RunWords, MovedStayUniformAndIndependent) {
  for (const WordMove move : {WordMove{true, 0.1}, WordMove{true, 0.7}, WordMove{false, 0.4}, WordMove{false, 1.0}}) {
    RandomStream chain({.seed = 5}, StreamId::test);
    std::array<double, 20> cells{};
    double products = 0.0;
    for (std::uint64_t run = 0; run < 1000; ++run) {
      RunWords words;
      const auto drawn = [&](RunWords& from) {
        const TakeRandomFrom taken(from);
        RandomStream stream({.seed = 4, .run = run}, StreamId::process);
        std::vector<double> all = uniforms(20)(stream);
        for (int k = 0; k < 20; ++k) all.push_back(0.5 * std::erfc(-stream.normal() / std::numbers::sqrt2));
        return all;
      };
      drawn(words);
      for (int i = 0; i < 5; ++i) {
        words.keep_what_was_read();
        words = RunWords(words, move, chain);
        drawn(words);
      }
      const std::vector<double> last = drawn(words);
      for (std::size_t i = 0; i < last.size(); ++i) {
        cells[static_cast<std::size_t>(20.0 * last[i])] += 1.0;
        products += 12.0 * (last[i] - 0.5) * (last[(i + 1) % last.size()] - 0.5);
      }
    }
    double chi_square = 0.0;
    for (const double count : cells) chi_square += (count - 2000.0) * (count - 2000.0) / 2000.0;
    EXPECT_LT(chi_square, 43.8) << move.as_read << " " << move.beta;
    EXPECT_LT(std::abs(products) / 200.0, 3.3) << "of 40000 independent products with variance 1";
  }
}

// A normal keeps sqrt(1 - beta^2) of itself where its words move as it was made of them, and something where they move
// one by one.
TEST(RunWords, MoveAsFarAsBetaSays) {
  const auto correlation = [](const WordMove& move) {
    RandomStream chain({.seed = 6}, StreamId::test);
    double sum = 0.0;
    for (int i = 0; i < 4000; ++i) {
      RunWords plain(RunWords(), {true, 1.0}, chain);
      const std::vector<double> before = draw(plain, normals);
      plain.keep_what_was_read();
      RunWords moved(plain, move, chain);
      const std::vector<double> after = draw(moved, normals);
      for (std::size_t k = 0; k < before.size(); ++k) sum += before[k] * after[k] / 32000.0;
    }
    return sum;
  };
  for (const double beta : {0.05, 0.5, 0.9, 1.0})
    EXPECT_NEAR(correlation({true, beta}), std::sqrt(1.0 - beta * beta), 0.02) << beta;
  EXPECT_NEAR(correlation({false, 1.0}), 0.0, 0.02);
  EXPECT_GT(correlation({false, 0.05}), 0.9);
}

// One uniform, and two normals or as many uniforms.
std::vector<double> one_or_other(RandomStream& stream) {
  std::vector<double> all{stream.uniform()};
  for (int i = 0; i < 2; ++i) all.push_back(all.front() < 0.5 ? stream.normal() : stream.uniform());
  return all;
}

TEST(RunWords, TellWhichRunsMakeNormalsOfTheSameWords) {
  RandomStream chain({.seed = 8}, StreamId::test);
  int alike = 0;
  for (int i = 0; i < 400; ++i) {
    RunWords from(RunWords(), {true, 1.0}, chain);
    const bool before = draw(from, one_or_other).front() < 0.5;
    from.keep_what_was_read();
    RunWords to(from, {true, 1.0}, chain);
    const bool after = draw(to, one_or_other).front() < 0.5;
    to.keep_what_was_read();
    EXPECT_EQ(from.reads_alike(to), before == after);
    EXPECT_EQ(to.reads_alike(from), before == after);
    alike += before == after;
  }
  EXPECT_GT(alike, 140);
  EXPECT_LT(alike, 260);
}

// As many moves from few words to many as back: the move is reversible though runs read different numbers of words.
TEST(RunWords, MovesAreReversibleWhereRunsReadMoreOrLess) {
  RandomStream chain({.seed = 7}, StreamId::test);
  double last_large_first = 0.0, first_large_last = 0.0, longer = 0.0;
  constexpr int kRuns = 40000;
  for (int i = 0; i < kRuns; ++i) {
    RunWords from(RunWords(), {true, 1.0}, chain);
    const std::vector<double> before = draw(from, more_or_less);
    from.keep_what_was_read();
    EXPECT_EQ(from.size(), before.size() == 1 ? 4u : 8u);
    RunWords to(from, {i % 2 == 0, 0.6}, chain);
    const std::vector<double> after = draw(to, more_or_less);
    const auto is_large = [](const std::vector<double>& run) { return run.size() > 1 && run.back() > 1.0; };
    first_large_last += is_large(before) && after.size() == 1;
    last_large_first += before.size() == 1 && is_large(after);
    longer += after.size() > 1;
  }
  EXPECT_NEAR(longer / kRuns, 0.5, 3.3 * 0.5 / std::sqrt(kRuns));
  EXPECT_NEAR(first_large_last, last_large_first, 3.3 * std::sqrt(first_large_last + last_large_first));
  EXPECT_GT(first_large_last, 100.0);
}

}  // namespace
}  // namespace truebearing::run_words_test
