// SPDX-License-Identifier: Apache-2.0
#include "training/tune.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <exception>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>
#include <limits>
#include <memory>
#include <nlopt.hpp>
#include <optional>
#include <toml++/toml.h>

#include "truebearing/core/error.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/summary.hpp"
#include "truebearing/study/tracker_registry.hpp"

namespace truebearing {
namespace {

// A number that does not matter would wander to 0 or infinity: it stays within this factor of its start.
constexpr double kLargestFactor = 1e4;

// The tuned numbers of a tracker as one vector of logarithms.
class TunedTracker {
 public:
  TunedTracker(const Study& study, const TrackerSpec& spec) : study_(study), spec_(spec) {
    for (const std::string& path : spec.tune) {
      sizes_.push_back(numbers_at(*spec.configuration, path, spec.name + ".tune").size());
      for (const double value : numbers_at(*spec.configuration, path, spec.name + ".tune"))
        start_.push_back(std::log(value));
    }
  }

  const std::vector<double>& start() const { return start_; }

  TunedValues values(const std::vector<double>& logarithms) const {
    TunedValues values;
    std::size_t next = 0;
    for (std::size_t i = 0; i < sizes_.size(); ++i)
      for (std::size_t j = 0; j < sizes_[i]; ++j) values[spec_.tune[i]].push_back(std::exp(logarithms[next++]));
    return values;
  }

  std::unique_ptr<Tracker> make(const std::vector<double>& logarithms) const {
    SharedTable configuration = spec_.configuration;
    for (const auto& [path, numbers] : values(logarithms)) configuration = with_numbers(*configuration, path, numbers);
    TableReader reader = tracker_reader(spec_, configuration, study_.path().string());
    return make_tracker(spec_.kind, reader, &study_.scenario());
  }

 private:
  const Study& study_;
  const TrackerSpec& spec_;
  std::vector<std::size_t> sizes_;
  std::vector<double> start_;
};

// What tuning wants to know of runs: the squared errors of each quantity, and the sum of the NEES and how many they
// are.
struct TuningFigures {
  std::vector<SquaredErrors> errors;
  SquaredErrors nees;

  explicit TuningFigures(std::size_t quantities) : errors(quantities) {}
  explicit TuningFigures(const RunScore& score) {
    for (std::size_t q = 0; q < score.error.size(); ++q) errors.push_back(squared_errors(score, q));
    for (const double value : score.nees)
      if (!std::isnan(value)) nees.add(SquaredErrors{value, 1.0});
  }

  void exchange(TallyStream& stream) {
    for (SquaredErrors& of_quantity : errors) truebearing::exchange(of_quantity, stream);
    truebearing::exchange(nees, stream);
  }
};

struct Tuned {
  double cost = 0.0;  // sum of ln RMSE; as large as can be where that is no number
  double nees = 0.0;  // mean over runs and scored steps
  int dimension = 0;
};

// Scores a tracker on the same recordings again and again.
class TuningRuns {
 public:
  TuningRuns(const Study& study, const TuneOptions& options)
      : study_(study), threads_(options.threads), ranks_(options.ranks), recordings_(study.tuning_runs()) {
    monte_carlo(recordings_.size(), threads_, [&](std::size_t run, std::size_t) {
      recordings_[run] = study.scenario().simulate({options.seed, Role::tuning, run});
    });
  }

  const std::vector<Recording>& recordings() const { return recordings_; }

  // Of the tracker that the numbers make.
  Tuned score(const Tracker& tracker, const std::vector<double>& logarithms) const {
    Ensemble ensemble;
    ensemble.add("tuned", tracker.fresh());
    TrackerSet prototype(std::move(ensemble));
    prototype.show_member("tuned");
    const std::vector<Scorer> scorers{Scorer(study_.scenario().truth_space(), tracker.space())};
    const std::size_t quantities = scorers.front().quantities().size();
    std::vector<TuningFigures> figures(recordings_.size(), TuningFigures(quantities));
    std::vector<std::unique_ptr<TrackerSetPack>> packs(worker_count(threads_));
    const BlockRange own = own_runs(ranks_, recordings_.size());
    const std::size_t together = prototype.best_together(runs_together(own.size(), threads_));
    monte_carlo_together(own.size(), together, threads_, [&](std::size_t first, std::size_t count, std::size_t worker) {
      if (!packs[worker]) packs[worker] = std::make_unique<TrackerSetPack>(prototype, together);
      const auto run = [&](std::size_t i) { return own.first + (first + i) * own.stride; };
      std::vector<const Recording*> some;
      for (std::size_t i = 0; i < count; ++i) some.push_back(&recordings_[run(i)]);
      const auto scores = score_recordings(*packs[worker], scorers, some, study_.scoring());
      for (std::size_t i = 0; i < count; ++i) figures[run(i)] = TuningFigures(scores[i].front());
    });
    if (ranks_) exchange(*ranks_, logarithms, figures);
    Tuned tuned{0.0, 0.0, scorers.front().dimension()};
    for (std::size_t q = 0; q < quantities; ++q) {
      RunErrors errors;
      for (const TuningFigures& of_run : figures) errors.add(of_run.errors[q]);
      tuned.cost += std::log(errors.rmse().value);
    }
    if (!std::isfinite(tuned.cost)) tuned.cost = std::numeric_limits<double>::max();
    SquaredErrors nees;
    for (const TuningFigures& of_run : figures) nees.add(of_run.nees);
    tuned.nees = nees.sum / nees.count;
    if (ranks_) take_first(*ranks_, tuned);
    return tuned;
  }

 private:
  // Gives every rank the figures of the others' runs. Each looks for the least cost by itself, and no wrong one is
  // found where they should ever look at different places.
  static void exchange(Ranks& ranks, const std::vector<double>& logarithms, std::vector<TuningFigures>& figures) {
    TallyStream own(false);
    for (const double logarithm : logarithms) own.whole(std::bit_cast<std::uint64_t>(logarithm));
    for (std::size_t run = ranks.rank(); run < figures.size(); run += ranks.size()) figures[run].exchange(own);
    const std::vector<std::string> all = ranks.gather_all(own.written());
    for (std::size_t rank = 0; rank < all.size(); ++rank) {
      TallyStream stream(all[rank]);
      for (const double logarithm : logarithms)
        if (stream.whole(0) != std::bit_cast<std::uint64_t>(logarithm))
          throw InputError(fmt::format("rank {}", rank), fmt::format("rounds otherwise than rank {}", ranks.rank()),
                           "machines of one kind");
      if (rank == ranks.rank()) continue;
      for (std::size_t run = rank; run < figures.size(); run += ranks.size()) figures[run].exchange(stream);
      stream.finish();
    }
  }

  // Logarithms may differ in their last bit from machine to machine, and all must take the same step.
  static void take_first(Ranks& ranks, Tuned& tuned) {
    TallyStream own(false);
    own.value(tuned.cost);
    own.value(tuned.nees);
    const std::string firsts = from_first(ranks, own.written());
    TallyStream first(firsts);
    tuned.cost = first.value(0.0);
    tuned.nees = first.value(0.0);
  }

  const Study& study_;
  int threads_;
  Ranks* ranks_;
  std::vector<Recording> recordings_;
};

// H of z = H x, row by row, by least squares over every measurement and the truth beside it.
std::vector<double> fitted_matrix(const std::vector<Recording>& recordings, const Study& study,
                                  const TrackerSpec& spec) {
  if ((*spec.configuration)["ahead_s"].value_or(0.0) > 0.0)
    throw InputError(
        study.path().string() + ": trackers." + spec.name + ".tune",
        std::string("names ") + kMeasurementMatrix + ", and ahead_s a truth that is not beside what is measured",
        "a tracker of the present");
  const Eigen::Index n = study.scenario().truth_space().size();
  const auto numbers = static_cast<Eigen::Index>(numbers_at(*spec.configuration, kMeasurementMatrix, spec.name).size());
  const Eigen::Index m = numbers / n;
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(n, n), products = Eigen::MatrixXd::Zero(n, m);
  for (const Recording& recording : recordings)
    for (const Truth& truth : recording.truth)
      for (std::size_t k = 0; k < truth.x.size(); ++k) {
        const BoundedVector& z = recording.measurements[k].z;
        if (z.size() != m || !z.allFinite() || !truth.x[k].allFinite()) continue;
        squares += truth.x[k] * truth.x[k].transpose();
        products += truth.x[k] * z.transpose();
      }
  const Eigen::LDLT<Eigen::MatrixXd> factors(squares);
  if (numbers != n * m || m == 0 || factors.info() != Eigen::Success || !(factors.rcond() > 1e-12))
    throw InputError(study.path().string() + ": trackers." + spec.name + ".tune",
                     std::string("names ") + kMeasurementMatrix + ", which the tuning runs do not tell",
                     "runs whose truth moves in every component of the state");
  const Eigen::MatrixXd transposed = factors.solve(products);  // (n x m), by columns: the rows of H
  return {transposed.data(), transposed.data() + transposed.size()};
}

std::vector<double> offset(std::vector<double> values, double by) {
  for (double& value : values) value += by;
  return values;
}

std::vector<std::uint64_t> bits_of(const TunedValues& values) {
  std::vector<std::uint64_t> bits;
  for (const auto& [key, numbers] : values)
    for (const double number : numbers) bits.push_back(std::bit_cast<std::uint64_t>(number));
  return bits;
}

// What numbers cost; those that make no tracker, a probability above 1 say, are as bad as can be.
std::optional<Tuned> score_of(const std::vector<double>& logarithms, const TunedTracker& tracker,
                              const TuningRuns& runs) {
  std::unique_ptr<Tracker> made;
  try {
    made = tracker.make(logarithms);
  } catch (const InputError&) {
    return std::nullopt;
  }
  return runs.score(*made, logarithms);
}

// One factor on all numbers that leaves the estimates as they are: choose it by the NEES.
void fix_common_factor(std::vector<double>& logarithms, const TunedTracker& tracker, const TuningRuns& runs) {
  const Tuned before = runs.score(*tracker.make(logarithms), logarithms);
  std::vector<double> scaled = logarithms;
  for (double& logarithm : scaled) logarithm += std::log(before.nees / before.dimension);
  const std::optional<Tuned> after = score_of(scaled, tracker, runs);
  if (after && std::abs(after->cost - before.cost) < 1e-9) logarithms = scaled;
}

}  // namespace

TunedValues tune_tracker(const Study& study, const std::string& name, const TuneOptions& options, TuneReport* report) {
  if (study.tracker(name).tune.empty())
    throw InputError(study.path().string() + ": trackers." + name, "has nothing to tune", "a key `tune`");
  const TuningRuns runs(study, options);
  TrackerSpec spec = study.tracker(name);
  TunedValues fitted;
  if (std::erase(spec.tune, kMeasurementMatrix) > 0) {
    fitted[kMeasurementMatrix] = fitted_matrix(runs.recordings(), study, spec);
    spec.configuration = with_numbers(*spec.configuration, kMeasurementMatrix, fitted[kMeasurementMatrix]);
    if (spec.tune.empty()) {
      if (report) *report = {};
      if (options.ranks)
        check_all_have(*options.ranks, fmt::format("{}", fmt::join(bits_of(fitted), " ")), "fitted number");
      return fitted;
    }
  }
  const TunedTracker tracker(study, spec);

  const auto cost_at = [&](const std::vector<double>& logarithms) {
    const std::optional<Tuned> tuned = score_of(logarithms, tracker, runs);
    return tuned ? tuned->cost : std::numeric_limits<double>::max();
  };
  constexpr std::array kSteps{1.0, 0.3};
  const int in_a_round = std::max(1, options.max_evaluations / static_cast<int>(kSteps.size()));  // 0: no limit
  const int most = 1 + static_cast<int>(kSteps.size()) * in_a_round;
  int evaluations = 0;
  std::exception_ptr failure;  // the optimizer would swallow it
  double best = std::numeric_limits<double>::max();
  std::function<double(const std::vector<double>&)> cost = [&](const std::vector<double>& logarithms) {
    if (failure) return std::numeric_limits<double>::max();
    double value = std::numeric_limits<double>::max();
    try {
      value = cost_at(logarithms);
    } catch (...) {
      failure = std::current_exception();
    }
    best = std::min(best, value);
    ++evaluations;
    if (options.progress) options.progress(evaluations, most, best);
    return value;
  };
  tracker.make(tracker.start());  // the start must be valid
  const double before = cost(tracker.start());
  if (failure) std::rethrow_exception(failure);

  // Two rounds: the second from where the first ended, with a fresh simplex, for those that collapse on the way.
  std::vector<double> logarithms = tracker.start();
  double after = before;
  for (const double step : kSteps) {
    nlopt::opt optimizer(nlopt::LN_NELDERMEAD, static_cast<unsigned>(logarithms.size()));
    optimizer.set_min_objective(
        [](const std::vector<double>& x, std::vector<double>&, void* data) {
          return (*static_cast<std::function<double(const std::vector<double>&)>*>(data))(x);
        },
        &cost);
    optimizer.set_lower_bounds(offset(tracker.start(), -std::log(kLargestFactor)));
    optimizer.set_upper_bounds(offset(tracker.start(), std::log(kLargestFactor)));
    optimizer.set_initial_step(step);
    optimizer.set_ftol_abs(1e-7);
    optimizer.set_xtol_abs(1e-3);
    optimizer.set_maxeval(in_a_round);
    optimizer.optimize(logarithms, after);
    if (failure) std::rethrow_exception(failure);
  }
  if (logarithms.size() > 1) fix_common_factor(logarithms, tracker, runs);
  if (report) *report = {evaluations, before, after};
  TunedValues values = tracker.values(logarithms);
  values.merge(fitted);
  if (options.ranks) check_all_have(*options.ranks, fmt::format("{}", fmt::join(bits_of(values), " ")), "tuned number");
  return values;
}

}  // namespace truebearing
