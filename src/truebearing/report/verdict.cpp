// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/verdict.hpp"

#include <cmath>
#include <fmt/format.h>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/evaluation/metric.hpp"
#include "truebearing/evaluation/share_of_way.hpp"
#include "truebearing/report/markup.hpp"

namespace truebearing {
namespace {

constexpr double kPercent = 100.0;
// A difference of fewer standard errors is what chance makes in 1 of 20.
constexpr double kStandardErrors = 2.0;

std::string above_or_below(double rmse, double other) {
  const double percent = kPercent * (rmse / other - 1.0);
  return fmt::format("{} % {}", shown(std::abs(percent), 2), percent < 0.0 ? "below" : "above");
}

// One that is a tracker: it is scored on the same errors, which a bound from theory need not be.
const ResultTracker* bound_of(const ResultFigures& figures) {
  for (const ResultTracker& tracker : figures.trackers)
    if (tracker.is_bound) return &tracker;
  return nullptr;
}

// Of each quantity that the pair was compared in: "14 % below tuned in position (9 standard errors)".
std::string differences(const ResultFigures& figures, const std::string& a, const std::string& b) {
  std::string text;
  for (const ResultPair& pair : figures.pairs) {
    if (pair.a != a || pair.b != b) continue;
    const ResultTracker* tracker = figures.tracker(a);
    const ResultTracker* other = figures.tracker(b);
    const ResultQuantity* of_a = tracker ? tracker->quantity(pair.quantity) : nullptr;
    const ResultQuantity* of_b = other ? other->quantity(pair.quantity) : nullptr;
    if (!of_a || !of_b || !std::isfinite(of_a->rmse / of_b->rmse)) continue;
    const double errors = std::abs(pair.mean / pair.se);
    text += text.empty() ? "" : ", ";
    text += fmt::format("{}{} in {}", above_or_below(of_a->rmse, of_b->rmse), text.empty() ? " " + b : "",
                        name_of(pair.quantity));
    if (std::isfinite(errors))
      text += errors < kStandardErrors
                  ? fmt::format(" ({} standard errors: no difference can be told)", shown(errors, 2))
                  : fmt::format(" ({} standard errors)", shown(errors, 2));
  }
  return text;
}

std::string against_bound(const ResultFigures& figures, const ResultTracker& tracker) {
  const ResultTracker* bound = bound_of(figures);
  if (!bound || bound == &tracker) return {};
  for (const ResultQuantity& quantity : tracker.quantities) {
    const ResultQuantity* least = bound->quantity(quantity.name);
    if (least && std::isfinite(quantity.rmse / least->rmse))
      return fmt::format("{} the bound {} in {}", above_or_below(quantity.rmse, least->rmse), bound->name,
                         name_of(quantity.name));
  }
  return {};
}

// Where nothing was paired: the best, and by how much.
std::string best_of(const ResultFigures& figures, const ResultTracker& best) {
  const ResultQuantity& quantity = best.quantities.front();
  std::string text = fmt::format("has the least {} error, RMSE {} {}", name_of(quantity.name), shown(quantity.rmse),
                                 unit_of(quantity.name));
  const ResultTracker* next = nullptr;
  for (const ResultTracker& tracker : figures.trackers) {
    const ResultQuantity* of = tracker.quantity(quantity.name);
    if (&tracker == &best || tracker.is_bound || !of || !std::isfinite(of->rmse)) continue;
    if (!next || of->rmse < next->quantity(quantity.name)->rmse) next = &tracker;
  }
  if (next)
    text += fmt::format(", {} {}", above_or_below(quantity.rmse, next->quantity(quantity.name)->rmse), next->name);
  return text;
}

// What is asked: the first pair of the tracker that errs least of those that a pair holds against another.
const ResultPair* asked(const ResultFigures& figures) {
  const ResultPair* first = nullptr;
  double least = 0.0;
  for (const ResultPair& pair : figures.pairs) {
    const ResultTracker* tracker = figures.tracker(pair.a);
    if (!tracker || tracker->quantities.empty() || tracker->is_bound) continue;
    const double rmse = tracker->quantities.front().rmse;
    if (!std::isfinite(rmse) || (first && !(rmse < least))) continue;
    first = &pair;
    least = rmse;
  }
  return first;
}

const ResultTracker* subject(const ResultFigures& figures) {
  if (const ResultPair* pair = asked(figures)) return figures.tracker(pair->a);
  for (const ResultTracker& tracker : figures.trackers)
    if (!tracker.quantities.empty())
      if (const ResultTracker* best = best_in(figures, tracker.quantities.front().name)) return best;
  return nullptr;
}

}  // namespace

const ResultTracker* best_in(const ResultFigures& figures, const std::string& quantity) {
  const ResultTracker* best = nullptr;
  for (const ResultTracker& tracker : figures.trackers) {
    const ResultQuantity* of = tracker.quantity(quantity);
    if (tracker.is_bound || !of || !std::isfinite(of->rmse)) continue;
    if (!best || of->rmse < best->quantity(quantity)->rmse) best = &tracker;
  }
  return best;
}

double share_of_the_way(double a, double b, double bound) {
  return kPercent * share_of_way(a, b, bound);
}

std::string consistency(const ResultTracker& tracker, double runs) {
  if (!std::isfinite(tracker.nees) || !(tracker.nees_expected > 0.0) || !(runs >= 1.0)) return {};
  const ChiSquareMeans consistent = chi_square_means(runs, tracker.nees_expected);
  if (tracker.nees > consistent.high) return "claims to know more than it does";
  if (tracker.nees < consistent.low) return "knows more than it claims";
  return "consistent";
}

std::string question(const Results& results) {
  const std::string where =
      fmt::format("{}, {} runs, seed {:.0f}", results.study, shown(results.runs, 9), results.seed);
  if (const ResultPair* pair = asked(results.all))
    return fmt::format("Does {} err less than {}? {}.", pair->a, pair->b, where);
  return fmt::format("Which tracker errs least? {}.", where);
}

std::string answer(const Results& results) {
  const ResultTracker* tracker = subject(results.all);
  if (!tracker) return "No tracker has an error that could be scored.";
  std::string text;
  if (const ResultPair* pair = asked(results.all)) text = differences(results.all, pair->a, pair->b);
  if (text.empty()) {
    if (const ResultTracker* best = best_in(results.all, tracker->quantities.front().name)) tracker = best;
    text = best_of(results.all, *tracker);
  } else {
    text = "is " + text;
  }
  if (const std::string bound = against_bound(results.all, *tracker); !bound.empty()) text += "; " + bound;
  const double runs = results.runs * static_cast<double>(std::max<std::size_t>(results.sets.size(), 1));
  if (const std::string says = consistency(*tracker, runs); !says.empty())
    text += fmt::format("; {} (NEES {}, {:.0f} expected)", says, shown(tracker->nees, 3), tracker->nees_expected);
  return fmt::format("{} {}.", tracker->name, text);
}

}  // namespace truebearing
