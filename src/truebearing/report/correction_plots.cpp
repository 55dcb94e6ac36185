// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/correction_plots.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "truebearing/report/axis.hpp"
#include "truebearing/report/markup.hpp"
#include "truebearing/report/plot_clock.hpp"

namespace truebearing {
namespace {

constexpr double kOfHundred = 100.0;
// Of curves: those of the rules that fired most have names, some more are drawn; all of hundreds would hide each other.
constexpr std::size_t kNamedTerms = 4, kMostTerms = 12;

std::string plot_id(const std::string& id, std::size_t tracker, const std::string& what) {
  return fmt::format("{}correction_{}_{}", id, tracker, what);
}

// In per cent of the steps that have a value, with the first and last of them: what is before would leave a gap.
PlotSeries per_cent(const std::string& name, std::size_t look, const std::vector<double>& time_s,
                    const std::vector<double>& shares, bool of_what_is_left) {
  PlotSeries line{name, tracker_look(look), Shape::line, {}, {}};
  for (std::size_t i = 0; i < std::min(time_s.size(), shares.size()); ++i) {
    if (line.x.empty() && !std::isfinite(shares[i])) continue;
    line.x.push_back(time_s[i]);
    line.y.push_back(kOfHundred * (of_what_is_left ? 1.0 - shares[i] : shares[i]));
  }
  return line;
}

double mean_where_known(const std::vector<double>& values) {
  double sum = 0.0, count = 0.0;
  for (const double value : values)
    if (std::isfinite(value)) {
      sum += value;
      count += 1.0;
    }
  return count > 0.0 ? sum / count : kNaN;
}

Plot held_back_plot(const ResultTracker& tracker, const std::string& id) {
  const ResultCorrection& correction = *tracker.correction;
  Plot plot;
  plot.id = id;
  plot.title = fmt::format("Who held {} back", tracker.name);
  const PlotClock clock(tracker.time_s);
  plot.x_label = clock.label;
  plot.y_label = "held back (%)";
  const std::vector<double> time_s = clock.from(tracker.time_s);
  const auto add = [&](const char* name, const std::vector<double>& shares, bool of_what_is_left) {
    PlotSeries line = per_cent(name, plot.series.size(), time_s, shares, of_what_is_left);
    plot.summary += fmt::format("{}{} {} %", plot.summary.empty() ? "On average: " : ", ", name,
                                shown(mean_where_known(line.y), 3));
    plot.series.push_back(std::move(line));
  };
  const auto ever_below_one = [](const std::vector<double>& weights) {
    return std::any_of(weights.begin(), weights.end(), [](double weight) { return weight < 1.0; });
  };
  const bool gated = ever_below_one(correction.box), judged = ever_below_one(correction.referee);
  const bool limited = std::isfinite(correction.kappa);
  const bool hands_over = std::any_of(correction.handed_over.begin(), correction.handed_over.end(),
                                      [](double share) { return share > 0.0; });
  if (gated) add("box gate", correction.box, true);
  if (judged) add("referee", correction.referee, true);
  if (limited) add("kappa", correction.limited, false);
  if (hands_over) add("fallback", correction.handed_over, false);
  if (gated || judged)
    plot.caption += fmt::format("{}: how much of what the network says {} took away. ",
                                gated && judged ? "Box gate and referee"
                                : gated         ? "Box gate"
                                                : "Referee",
                                gated && judged ? "they" : "it");
  if (limited)
    plot.caption += fmt::format("Kappa: steps in which it cut a correction to {} standard deviations. ",
                                shown(correction.kappa, 3));
  if (hands_over) plot.caption += "Fallback: its share of what was trusted. ";
  plot.caption += "Means over runs.";
  plot.summary += ".";
  return plot;
}

Plot length_plot(const ResultTracker& tracker, const std::string& id) {
  const ResultCorrection& correction = *tracker.correction;
  Plot plot;
  plot.id = id;
  plot.title = fmt::format("How far {} moved what was trusted", tracker.name);
  const PlotClock clock(tracker.time_s);
  plot.x_label = clock.label;
  plot.y_label = "length (standard deviations)";
  const std::vector<double> time_s = clock.from(tracker.time_s);
  std::vector<double> values;
  const auto add = [&](const char* name, std::size_t look, const std::vector<double>& lengths) {
    PlotSeries line{name, tracker_look(look), Shape::line, {}, {}};
    for (std::size_t i = 0; i < std::min(time_s.size(), lengths.size()); ++i) {
      if (line.x.empty() && !std::isfinite(lengths[i])) continue;
      line.x.push_back(time_s[i]);
      line.y.push_back(lengths[i]);
    }
    values.insert(values.end(), line.y.begin(), line.y.end());
    plot.series.push_back(std::move(line));
  };
  add("what the network wants", 1, correction.wanted_sigmas);
  add("what is published", 0, correction.moved_sigmas);
  plot.y_logarithmic = wants_logarithm(values);
  if (std::isfinite(correction.kappa) && !plot.series[0].x.empty())
    plot.series.push_back({"kappa",
                           {"bound"},
                           Shape::line,
                           {plot.series[0].x.front(), plot.series[0].x.back()},
                           {correction.kappa, correction.kappa}});
  plot.caption =
      "Mean Mahalanobis distance from what was trusted, by its covariance: before kappa, gate and referee, and after.";
  plot.summary =
      fmt::format("On average {} wanted, {} published.", shown(mean_where_known(correction.wanted_sigmas), 3),
                  shown(mean_where_known(correction.moved_sigmas), 3));
  return plot;
}

Plot fired_plot(const ResultTracker& tracker, const std::string& id) {
  const ResultCorrection& correction = *tracker.correction;
  Plot plot;
  plot.id = id;
  plot.title = fmt::format("How often the rules of {} fired", tracker.name);
  plot.x_label = "rule, the most used in training first";
  plot.y_label = "mean strength (%)";
  PlotSeries taught{"in training", {"measured"}, Shape::dots, {}, {}};
  PlotSeries fired{"here", tracker_look(0), Shape::dots, {}, {}};
  double share_here = 0.0;
  std::size_t most = 0;
  for (std::size_t rule = 0; rule < correction.rules.size(); ++rule) {
    const auto number = static_cast<double>(rule + 1);
    taught.x.push_back(number);
    taught.y.push_back(kOfHundred * correction.rules[rule].usage);
    fired.x.push_back(number);
    fired.y.push_back(kOfHundred * correction.rules[rule].fired);
    if (correction.rules[rule].fired > share_here) {
      share_here = correction.rules[rule].fired;
      most = rule;
    }
  }
  plot.series = {std::move(taught), std::move(fired)};
  plot.caption =
      "Strengths of all rules sum to 100 % at every step. A rule that fires far more often than it was taught "
      "answers for steps that the training hardly had.";
  plot.summary = fmt::format("Rule {} fired most: {} %.", most + 1, shown(kOfHundred * share_here, 3));
  return plot;
}

// Of the bins that hold something and the box: where a plot of the feature begins and ends.
std::pair<double, double> range_of(const ResultCorrection::Feature& feature) {
  const double half = feature.clip * feature.scale;
  const double bin = 2.0 * half / static_cast<double>(std::max<std::size_t>(feature.counted.size(), 1));
  double low = kInfinity, high = -kInfinity;
  for (std::size_t i = 0; i < feature.counted.size(); ++i) {
    if (!(feature.counted[i] > 0.0)) continue;
    low = std::min(low, feature.mean - half + bin * static_cast<double>(i));
    high = std::max(high, feature.mean - half + bin * static_cast<double>(i + 1));
  }
  if (std::isfinite(feature.low)) low = std::min(low, feature.low);
  if (std::isfinite(feature.high)) high = std::max(high, feature.high);
  const double margin = 0.05 * (high - low);
  return {low - margin, high + margin};
}

// Steps as a staircase, 1 at its highest.
PlotSeries histogram_of(const ResultCorrection::Feature& feature) {
  PlotSeries steps{"values seen", {"seen"}, Shape::band, {}, {}, {}};
  const double half = feature.clip * feature.scale;
  const double bin = 2.0 * half / static_cast<double>(std::max<std::size_t>(feature.counted.size(), 1));
  const double most = *std::max_element(feature.counted.begin(), feature.counted.end());
  for (std::size_t i = 0; i < feature.counted.size(); ++i)
    for (const std::size_t edge : {i, i + 1}) {
      steps.x.push_back(feature.mean - half + bin * static_cast<double>(edge));
      steps.y.push_back(0.0);
      steps.y2.push_back(most > 0.0 ? feature.counted[i] / most : 0.0);
    }
  std::size_t first = 0, last = steps.x.size();
  while (first < last && steps.y2[first] == 0.0) ++first;
  while (last > first && steps.y2[last - 1] == 0.0) --last;
  for (std::vector<double>* column : {&steps.x, &steps.y, &steps.y2})
    *column = std::vector<double>(column->begin() + static_cast<std::ptrdiff_t>(first),
                                  column->begin() + static_cast<std::ptrdiff_t>(last));
  return steps;
}

// exp(-(u - c)^2 / (2 s^2)) over the range.
PlotSeries term_of(const std::string& name, const Look& look, double centre, double width,
                   const std::pair<double, double>& range) {
  constexpr int kPoints = 40;
  PlotSeries curve{name, look, Shape::line, {}, {}};
  for (int i = 0; i <= kPoints; ++i) {
    const double u = range.first + (range.second - range.first) * i / kPoints, e = (u - centre) / width;
    curve.x.push_back(u);
    curve.y.push_back(std::exp(-0.5 * e * e));
  }
  return curve;
}

// Rules share terms where the partition is a grid: a curve stands for all of them.
std::vector<PlotSeries> terms_of(const ResultCorrection& correction, std::size_t feature,
                                 const std::pair<double, double>& range) {
  std::vector<std::size_t> order(correction.rules.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return correction.rules[a].fired > correction.rules[b].fired; });
  struct Term {
    double centre, width;
    std::vector<std::size_t> rules;
  };
  std::vector<Term> terms;
  for (const std::size_t rule : order) {
    const double centre = correction.rules[rule].centre[feature], width = correction.rules[rule].width[feature];
    const auto same =
        std::find_if(terms.begin(), terms.end(), [&](const Term& t) { return t.centre == centre && t.width == width; });
    if (same != terms.end())
      same->rules.push_back(rule + 1);
    else if (terms.size() < kMostTerms)
      terms.push_back({centre, width, {rule + 1}});
  }
  std::vector<PlotSeries> named, others;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Term& term = terms[i];
    const std::string name = term.rules.size() == 1
                                 ? fmt::format("rule {}", term.rules[0])
                                 : fmt::format("rule {} and {} more", term.rules[0], term.rules.size() - 1);
    if (i < kNamedTerms)
      named.push_back(term_of(name, tracker_look(i), term.centre, term.width, range));
    else
      others.push_back(term_of(others.empty() ? "other rules" : "", {"other"}, term.centre, term.width, range));
  }
  others.insert(others.end(), named.begin(), named.end());
  return others;
}

Plot feature_plot(const ResultCorrection& correction, std::size_t i, const std::string& id) {
  const ResultCorrection::Feature& feature = correction.features[i];
  Plot plot;
  plot.id = id;
  const auto [low, high] = range_of(feature);
  if (!(low < high) || !(feature.scale > 0.0) || feature.counted.empty()) return plot;
  plot.title = capitalised(feature.name);
  plot.x_label = feature.name;
  plot.y_label = correction.rules.empty() ? "steps, of the most" : "membership; steps, of the most";
  plot.series.push_back(histogram_of(feature));
  bool first = true;
  for (const double edge : {feature.low, feature.high}) {
    if (!std::isfinite(edge)) continue;
    plot.series.push_back({first ? "edge of the box" : "", {"bound"}, Shape::line, {edge, edge}, {0.0, 1.0}});
    first = false;
  }
  for (PlotSeries& term : terms_of(correction, i, {low, high})) plot.series.push_back(std::move(term));
  if (correction.rules.empty())
    plot.series.push_back({"mean and scale",
                           tracker_look(0),
                           Shape::line,
                           {feature.mean - feature.scale, feature.mean, feature.mean + feature.scale},
                           {0.5, 0.5, 0.5}});
  plot.caption = correction.rules.empty()
                     ? "The values that the feature had, and the scale by which the network reads it."
                     : "The terms of the rules that fired most, over the values that the feature had.";
  plot.summary = fmt::format(
      "Seen: {} on average, from {} to {}{}.", shown(feature.seen_mean), shown(feature.least), shown(feature.greatest),
      std::isfinite(feature.low)
          ? fmt::format("; outside the box in {} % of the steps", shown(kOfHundred * feature.outside, 3))
          : "");
  return plot;
}

}  // namespace

std::vector<Plot> correction_time_plots(const ResultFigures& figures, std::size_t i, const std::string& id) {
  const ResultTracker& tracker = figures.trackers[i];
  if (!tracker.correction || tracker.time_s.size() < 2 || tracker.correction->gate.size() < 2) return {};
  std::vector<Plot> plots;
  for (Plot plot :
       {held_back_plot(tracker, plot_id(id, i, "held_back")), length_plot(tracker, plot_id(id, i, "length"))})
    if (!plot.empty()) plots.push_back(std::move(plot));
  return plots;
}

std::vector<Plot> rule_plots(const ResultFigures& figures, std::size_t i, const std::string& id) {
  const ResultTracker& tracker = figures.trackers[i];
  if (!tracker.correction || tracker.correction->rules.size() < 2) return {};
  return {fired_plot(tracker, plot_id(id, i, "fired"))};
}

std::vector<Plot> feature_plots(const ResultFigures& figures, std::size_t i, const std::string& id) {
  std::vector<Plot> plots;
  if (!figures.trackers[i].correction) return plots;
  const ResultCorrection& correction = *figures.trackers[i].correction;
  for (std::size_t feature = 0; feature < correction.features.size(); ++feature) {
    Plot plot = feature_plot(correction, feature, plot_id(id, i, fmt::format("feature_{}", feature + 1)));
    if (!plot.empty()) plots.push_back(std::move(plot));
  }
  return plots;
}

std::vector<Plot> correction_plots(const ResultFigures& figures, const std::string& id) {
  std::vector<Plot> plots;
  for (std::size_t i = 0; i < figures.trackers.size(); ++i)
    for (const auto& made :
         {correction_time_plots(figures, i, id), rule_plots(figures, i, id), feature_plots(figures, i, id)})
      plots.insert(plots.end(), made.begin(), made.end());
  return plots;
}

}  // namespace truebearing
