// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/rare_loss.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/evaluation/loss_score.hpp"
#include "truebearing/evaluation/run_words.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kOneIn = 10;       // of the pilot's runs at a level is beyond the next
constexpr std::size_t kMostLevels = 12;  // to 1e-12
constexpr double kWantedShare = 0.44;    // of moves that are taken (Papaioannou et al. 2015)
// Of moves that take words as the run has read them. The others reach runs that read otherwise.
constexpr double kAsRead = 0.75;
constexpr double kFirstBeta = 0.6;
constexpr double kLeastBeta = 1e-3;
constexpr double kGain = 0.1;                                // of the logarithm of beta by the wanted share
constexpr std::uint64_t kFirstRun = std::uint64_t{1} << 40;  // further than comparisons get
constexpr StreamId kChains{8};                               // nothing else draws from it

struct ScoredRun {
  std::shared_ptr<const RunWords> words;
  std::uint64_t number = 0;  // a scenario of recordings takes them in turn
  double score = 0.0;
};

// Makes runs of one tracker and scores them. One thread at a time.
class Runs {
 public:
  Runs(const TrackerSet& tracker, const Scenario& scenario, const ScoringRule& rule, std::uint64_t seed)
      : tracker_(tracker.fresh()),
        scorers_{Scorer(scenario.truth_space(), tracker.space(0))},
        scenario_(scenario),
        rule_(rule),
        seed_(seed) {
    rule_.families.clear();
  }

  ScoredRun plain(std::uint64_t number) { return scored(RunWords(), number); }
  ScoredRun moved(const ScoredRun& from, const WordMove& move, RandomStream& stream) {
    return scored(RunWords(*from.words, move, stream), from.number);
  }

 private:
  ScoredRun scored(RunWords words, std::uint64_t number) {
    const Recording recording = [&] {
      const TakeRandomFrom taken(words);
      return scenario_.simulate({seed_, Role::evaluation, number});
    }();
    words.keep_what_was_read();
    const RunScore score = std::move(score_recording(tracker_, scorers_, recording, rule_).front());
    return {std::make_shared<const RunWords>(std::move(words)), number, loss_score(score, scorers_.front(), rule_)};
  }

  TrackerSet tracker_;
  std::vector<Scorer> scorers_;
  const Scenario& scenario_;
  ScoringRule rule_;
  std::uint64_t seed_;
};

// Those of a level's runs that are beyond the next level; or, while that is sought, the best so many.
class Beyond {
 public:
  explicit Beyond(double level) : level_(level) {}
  explicit Beyond(std::size_t most) : level_(-kInfinity), most_(most) {}

  void add(const ScoredRun& run) {
    lost_ += run.score > 1.0;
    if (!(run.score > level_)) return;
    runs_.push_back(run);
    if (runs_.size() / 2 > most_) keep_best();
  }

  // The level that is the best but `most` runs' best score; kept are those beyond it.
  double settle() {
    keep_best();
    std::erase_if(runs_, [this](const ScoredRun& run) { return !(run.score > level_); });
    return level_;
  }

  std::size_t lost() const { return lost_; }
  const std::vector<ScoredRun>& runs() const { return runs_; }

 private:
  // And the one behind them, whose score is the level.
  void keep_best() {
    if (runs_.size() <= most_) return;
    const auto last = runs_.begin() + static_cast<std::ptrdiff_t>(most_);
    std::nth_element(runs_.begin(), last, runs_.end(),
                     [](const ScoredRun& a, const ScoredRun& b) { return a.score > b.score; });
    level_ = last->score;
    runs_.resize(most_ + 1);
  }

  double level_;
  std::size_t most_ = std::numeric_limits<std::size_t>::max() - 1;
  std::vector<ScoredRun> runs_;
  std::size_t lost_ = 0;
};

using Betas = std::array<double, 2>;  // of moves one by one, and as read

struct Moves {
  Betas betas;
  bool follow = false;  // the share that is taken
  std::size_t tried = 0, taken = 0;

  // The end of a chain after a move of any kind.
  void move(ScoredRun& end, double level, Runs& runs, RandomStream& stream) {
    const bool as_read = stream.uniform() < kAsRead;
    double& beta = betas[as_read];
    ScoredRun next = runs.moved(end, {as_read, beta}, stream);
    const bool takes = next.score > level && (!as_read || next.words->reads_alike(*end.words));
    if (takes) end = std::move(next);
    if (follow) beta = std::clamp(beta * std::exp(kGain * (takes - kWantedShare)), kLeastBeta, 1.0);
    taken += takes;
    ++tried;
  }
  double share() const { return tried > 0 ? static_cast<double>(taken) / static_cast<double>(tried) : kNaN; }
};

// Chains from runs beyond the level, as many runs in all as are wanted, those among them. Chains move in turn.
void grow(const std::vector<ScoredRun>& from, double level, std::size_t wanted, Runs& runs, RandomStream& stream,
          Moves& moves, Beyond& beyond) {
  std::vector<ScoredRun> ends = from;
  for (const ScoredRun& run : from) beyond.add(run);
  const std::size_t chains = from.size(), each = wanted / chains, longer = wanted % chains,
                    first = stream.index(chains);
  for (std::size_t step = 1; step <= each; ++step) {
    const std::size_t moving = step < each ? chains : longer;
    for (std::size_t i = 0; i < moving; ++i) {
      ScoredRun& end = ends[(first + i) % chains];
      moves.move(end, level, runs, stream);
      beyond.add(end);
    }
  }
}

// What the pilot found.
struct Ladder {
  std::vector<double> levels;  // the last is 1
  std::vector<Betas> betas;    // [level]: of the chains that lead there
  std::size_t runs = 0;        // that it took
};

// [level]
struct Climb {
  std::vector<double> probabilities;
  std::vector<Moves> moves;
};

class Climber {
 public:
  Climber(Runs& runs, const RareLossOptions& options, std::size_t repetition)
      : runs_(runs),
        draws_(options.draws),
        first_(kFirstRun + repetition * options.draws),
        stream_({options.seed, Role::evaluation, repetition}, kChains) {}

  // Throws InputError where it does not get there.
  Ladder pilot(const std::string& name, const std::function<void(std::size_t levels)>& told) {
    Ladder ladder;
    ladder.runs = draws_;
    Moves moves{{kFirstBeta, kFirstBeta}, true};
    Beyond beyond(draws_ / kOneIn);
    begin(beyond);
    for (;;) {
      ladder.betas.push_back(moves.betas);
      const bool is_last = beyond.lost() * kOneIn >= draws_;
      const double level = is_last ? 1.0 : beyond.settle();
      ladder.levels.push_back(level);
      told(ladder.levels.size());
      if (level == 1.0) return ladder;
      if (ladder.levels.size() == kMostLevels)
        throw InputError("scoring.loss_thresholds",
                         fmt::format("are passed by {} too rarely to be told, less than once in 10^{} runs: the rarest "
                                     "errors told are of {:.3g} times the thresholds",
                                     name, kMostLevels, level),
                         "lower ones, as --loss position_m=1000");
      if (beyond.runs().empty())
        throw InputError("scoring.loss_thresholds",
                         fmt::format("cannot be climbed to: the last errors of {} take too few values beyond {:.3g} "
                                     "times them",
                                     name, level),
                         "more --draws, or an error that can be of any size");
      const std::vector<ScoredRun> from = beyond.runs();
      beyond = Beyond(draws_ / kOneIn);
      grow(from, level, draws_, runs_, stream_, moves, beyond);
      ladder.runs += draws_ - from.size();
    }
  }

  Climb climb(const Ladder& ladder, const std::function<void(std::size_t levels)>& told) {
    Climb climb;
    Beyond beyond(ladder.levels.front());
    begin(beyond);
    double probability = 1.0;
    for (std::size_t i = 0; i < ladder.levels.size(); ++i) {
      Moves& moves = climb.moves.emplace_back(Moves{ladder.betas[i]});
      if (i > 0 && probability > 0.0) {
        const std::vector<ScoredRun> from = beyond.runs();
        beyond = Beyond(ladder.levels[i]);
        grow(from, ladder.levels[i - 1], draws_, runs_, stream_, moves, beyond);
      }
      probability *= static_cast<double>(beyond.runs().size()) / static_cast<double>(draws_);
      climb.probabilities.push_back(probability);
      told(ladder.levels.size());
    }
    return climb;
  }

 private:
  void begin(Beyond& beyond) {
    for (std::size_t i = 0; i < draws_; ++i) beyond.add(runs_.plain(first_ + i));
  }

  Runs& runs_;
  std::size_t draws_;
  std::uint64_t first_;
  RandomStream stream_;
};

// The levels with their figures over the repetitions.
std::vector<RareLoss::Level> levels_of(const Ladder& ladder, const std::vector<Climb>& climbs) {
  std::vector<RareLoss::Level> levels;
  for (std::size_t i = 0; i < ladder.levels.size(); ++i) {
    std::vector<double> probabilities;
    Moves moves{ladder.betas[i]};
    for (const Climb& climb : climbs) {
      probabilities.push_back(climb.probabilities[i]);
      moves.tried += climb.moves[i].tried;
      moves.taken += climb.moves[i].taken;
    }
    levels.push_back({ladder.levels[i], mean_of(probabilities), moves.share()});
  }
  return levels;
}

}  // namespace

RareLoss rare_loss(const TrackerSet& tracker, const Scenario& scenario, const ScoringRule& rule,
                   const RareLossOptions& options) {
  const Scorer scorer(scenario.truth_space(), tracker.space(0));
  if (std::none_of(rule.loss_thresholds.begin(), rule.loss_thresholds.end(),
                   [&](const auto& threshold) { return scorer.quantity(threshold.first).has_value(); }))
    throw InputError("scoring.loss_thresholds", "say of no quantity of " + tracker.name(0) + " when it is lost",
                     fmt::format("an error beyond which it is, of {}", fmt::join(scorer.quantities(), " or ")));
  std::vector<std::optional<Runs>> copies(worker_count(options.threads));
  const auto runs_of = [&](std::size_t worker) -> Runs& {
    if (!copies[worker]) copies[worker].emplace(tracker, scenario, rule, options.seed);
    return *copies[worker];
  };
  if (runs_of(0).plain(0).words->size() == 0)
    throw InputError("scenario", "draws nothing at random: all its runs are one", "one whose runs differ");

  std::mutex mutex;
  std::size_t done = 0;
  const auto told = [&](std::size_t levels) {
    const std::lock_guard lock(mutex);
    if (++done; options.progress) options.progress(done, levels * (options.repetitions + 1));
  };
  const Ladder ladder = Climber(runs_of(0), options, 0).pilot(tracker.name(0), told);
  std::vector<Climb> climbs(options.repetitions);
  monte_carlo(options.repetitions, options.threads, [&](std::size_t i, std::size_t worker) {
    climbs[i] = Climber(runs_of(worker), options, i + 1).climb(ladder, told);
  });

  RareLoss result;
  result.levels = levels_of(ladder, climbs);
  result.loss_rate = result.levels.back().probability;
  result.runs = ladder.runs;
  for (const Climb& climb : climbs) {
    result.repetitions.push_back(climb.probabilities.back());
    result.runs += options.draws;
    for (const Moves& moves : climb.moves) result.runs += moves.tried;
  }
  return result;
}

}  // namespace truebearing
