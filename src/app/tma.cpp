// SPDX-License-Identifier: Apache-2.0
// truebearing tma LOG.csv: from bearings, frequencies where the log has them, and own ship's track to the target's
// range, course and speed, and to the tone of its source.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <optional>

#include "app/log_options.hpp"
#include "app/output.hpp"
#include "app/report_output.hpp"
#include "app/subcommands.hpp"
#include "app/tma_answer.hpp"
#include "app/tma_log.hpp"
#include "app/tma_own_ship.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/report/tma_page.hpp"
#include "truebearing/tma/cho_2015.hpp"
#include "truebearing/tma/frequency_changes.hpp"
#include "truebearing/tma/target_motion_batch.hpp"

namespace truebearing {
namespace {

BatchPrior prior_of(const TmaArguments& options, const BearingWindow& window) {
  BatchPrior prior;
  prior.velocity_information = Eigen::Matrix2d::Identity() / (options.velocity_sigma_mps * options.velocity_sigma_mps);
  if (options.range_sigma_m > 0.0)
    prior.range = BatchPrior::Range{options.range_m, options.range_sigma_m, window.site_m(0), window.first_time_s()};
  return prior;
}

FrequencyChangeOptions changes_of(const TmaArguments& options) {
  using Handling = FrequencyChangeOptions::Handling;
  FrequencyChangeOptions changes = FrequencyChangeOptions::of_a_log();
  if (options.frequency_changes == "segments") changes.handling = Handling::segments;
  if (options.frequency_changes == "switch") changes.handling = Handling::bearings_only;
  if (options.frequency_changes == "ignored") changes.handling = Handling::ignored;
  return changes;
}

// Round ranges (1, 2, 5, 10, ...) about as far as own ship sailed and farther; kilometres where it did not move.
std::vector<double> round_ranges_m(const BearingWindow& window) {
  double way_m = 0.0;
  for (std::size_t i = 0; i < window.size(); ++i) way_m = std::max(way_m, (window.site_m(i) - window.site_m(0)).norm());
  const double decade_m = way_m > 0.0 ? std::pow(10.0, std::floor(std::log10(way_m))) : 1000.0;
  std::vector<double> ranges_m;
  for (const double factor : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0}) ranges_m.push_back(factor * decade_m);
  return ranges_m;
}

// The state that explains the data best, at each of some ranges at the last bearing.
std::vector<Eigen::Vector4d> hypotheses(const BearingWindow& window, const DopplerWindow* frequencies,
                                        const TargetMotionBatchOptions& options) {
  constexpr double kExactly = 1e-4;
  std::vector<Eigen::Vector4d> states;
  TargetMotionBatch batch(options);
  for (const double range_m : round_ranges_m(window)) {
    BatchPrior prior;
    prior.range =
        BatchPrior::Range{range_m, kExactly * range_m, window.site_m(window.size() - 1), window.last_time_s()};
    const BatchEstimate estimate = batch.solve(window, prior, nullptr, frequencies);
    if (estimate.found) states.push_back(estimate.x);
  }
  return states;
}

// The times over which the source kept a level, outliers apart.
void list_levels(const TmaWindows& windows, TmaSource& source, TmaAnswer& answer) {
  const DopplerWindow& window = windows.frequencies;
  std::vector<SourceFrequency> sources;
  window.sources(answer.estimate.x, answer.estimate.time_s, sources);
  std::vector<LevelRun> runs;
  list_runs(window, runs);
  for (const LevelRun& run : runs) {
    const SourceFrequency& f0 = sources[static_cast<std::size_t>(run.level)];
    source.levels.push_back({window.time_s(run.begin), window.time_s(run.end - 1), run.count, f0.frequency_hz,
                             std::sqrt(f0.variance_with(answer.estimate.P))});
  }
  for (std::size_t i = 0; i < window.size(); ++i) {
    const auto holds = [&](const LevelRun& run) {
      return i >= run.begin && i < run.end && window.level(i) == run.level;
    };
    if (std::any_of(runs.begin(), runs.end(), holds)) continue;
    ++source.outliers;
    answer.frequency_outliers.push_back({window.time_s(i), windows.frequency_line[i], std::nan("")});
  }
}

double root_mean_square_sigma(std::size_t count, const auto& weight) {
  double squares = 0.0;
  for (std::size_t i = 0; i < count; ++i) squares += 1.0 / weight(i);
  return std::sqrt(squares / static_cast<double>(count));
}

// By a method of Cho's. What the bearings determine is a matter of theirs and not of the method.
void solve_by_cho(const BearingWindow& bearings, const TmaArguments& options, TmaAnswer& answer) {
  ChoOptions cho;
  if (options.method == "gauss_newton") cho.method = ChoOptions::Method::gauss_newton;
  if (options.method == "levenberg") cho.method = ChoOptions::Method::levenberg;
  answer.estimate = solve_cho(bearings, cho);
  TargetMotionBatch batch;
  const BatchEstimate least_squares = batch.solve(bearings);
  if (!answer.estimate.found || !least_squares.found) return;
  answer.above_least_squares = answer.estimate.cost - least_squares.cost;
  answer.observability = batch.observability();
}

// By maximum likelihood or maximum a posteriori; the frequencies that it used.
const DopplerWindow* solve_by_batch(TmaWindows& windows, const TmaArguments& options, TmaAnswer& answer) {
  TargetMotionBatch batch({.huber_sigmas = options.huber_sigmas});
  answer.has_prior = options.method == "map";
  answer.is_robust = std::isfinite(options.huber_sigmas);
  std::optional<BatchPrior> prior;
  if (answer.has_prior) prior = prior_of(options, windows.bearings);
  const DopplerWindow* used = nullptr;
  if (windows.frequencies.size() > 0) {
    FrequencyChangeBatch with_frequencies(changes_of(options));
    answer.estimate = with_frequencies.solve(batch, windows.bearings, windows.frequencies, prior);
    if (with_frequencies.used_frequencies()) used = &windows.frequencies;
    TmaSource& source = answer.source.emplace();
    source.used = used;
    source.sound_mps = options.sound_mps;
    source.looked_for = options.frequency_changes != "ignored";
    source.frequencies = windows.frequencies.size();
    source.changes.assign(with_frequencies.changes().begin(), with_frequencies.changes().end());
    if (answer.estimate.found) list_levels(windows, source, answer);
  } else {
    answer.estimate = batch.solve(windows.bearings, prior);
  }
  if (!answer.estimate.found) return used;
  answer.observability = batch.observability();
  answer.ambiguities = batch.ambiguities();
  return used;
}

// What the bearings and frequencies between two times say by themselves.
TmaStretch stretch_of(const TmaWindows& windows, const DopplerWindow* used, double from_s, double to_s) {
  constexpr std::size_t kFewest = 5;
  TmaStretch stretch;
  stretch.from_s = from_s;
  stretch.to_s = to_s;
  const auto within = [&](double time_s) { return time_s >= from_s && time_s <= to_s; };
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < windows.bearings.size(); ++i) {
    if (within(windows.bearings.time_s(i)))
      stretch.own_ship = windows.own_ship[i];
    else
      others.push_back(i);
  }
  const BearingWindow bearings = windows.bearings.without(others);
  if (bearings.size() < kFewest) return stretch;
  DopplerWindow frequencies(windows.frequencies.sound_mps());
  for (std::size_t i = 0; used && i < used->size(); ++i)
    if (within(used->time_s(i)))
      frequencies.add(used->time_s(i), used->frequency_hz(i), used->sigma_hz(i), used->sensor(i));
  TargetMotionBatch batch;
  FrequencyChangeBatch changes;
  stretch.estimate = frequencies.size() > 0 ? changes.solve(batch, bearings, frequencies) : batch.solve(bearings);
  if (!stretch.estimate.found || !batch.observability().observable()) return stretch;
  const ResidualChecks checks =
      check_residuals(bearings, stretch.estimate, frequencies.size() > 0 ? &frequencies : nullptr);
  stretch.range_is_known = checks.rest.fits() && !checks.manoeuvred;
  return stretch;
}

// Before and after a change of velocity. A turn takes a while: farther from it where the rest is not yet, or no more,
// one course and speed.
std::vector<TmaStretch> stretches_of(const TmaWindows& windows, const DopplerWindow* used,
                                     const VelocityChange& change) {
  constexpr int kMostSteps = 4;
  const double first_s = windows.bearings.first_time_s(), last_s = windows.bearings.last_time_s();
  const double step_s = std::max(change.latest_s - change.earliest_s, 0.01 * (last_s - first_s));
  TmaStretch before, after;
  for (int k = 1; k <= kMostSteps && !before.range_is_known; ++k)
    before = stretch_of(windows, used, first_s, change.earliest_s - k * step_s);
  for (int k = 1; k <= kMostSteps && !after.range_is_known; ++k)
    after = stretch_of(windows, used, change.latest_s + k * step_s, last_s);
  return {before, after};
}

// What the residuals say, and what else the measurements may be where one course and speed does not explain them.
void examine(const TmaWindows& windows, const DopplerWindow* used, TmaAnswer& answer) {
  const BearingWindow& bearings = windows.bearings;
  ResidualChecks& checks = answer.residuals;
  checks = check_residuals(bearings, answer.estimate, used);
  for (const Outlier& outlier : checks.outliers) {
    answer.outliers.push_back({bearings.time_s(outlier.at), windows.line[outlier.at], outlier.sigmas});
    if (outlier.or_else) answer.outliers.back().or_line = windows.line[*outlier.or_else];
  }
  answer.bearing_sigma_rad = root_mean_square_sigma(bearings.size(), [&](std::size_t i) { return bearings.weight(i); });
  if (used)
    answer.frequency_sigma_hz = root_mean_square_sigma(used->size(), [&](std::size_t i) { return used->weight(i); });
  if (checks.change) answer.stretches = stretches_of(windows, used, *checks.change);
  if (used) return;
  if (checks.rest.too_large || 10 * checks.outliers.size() >= bearings.size())
    answer.two_contacts = find_two_contacts(bearings, checks.least_squares, checks.outliers);
  if (checks.rest.too_large || !answer.range_is_known())
    answer.reversed = find_reversed(bearings, checks.least_squares);
}

void solve(TmaWindows& windows, const TmaArguments& options, TmaAnswer& answer) {
  const DopplerWindow* used = nullptr;
  if (options.is_cho())
    solve_by_cho(windows.bearings, options, answer);
  else
    used = solve_by_batch(windows, options, answer);
  if (!answer.estimate.found) return;
  answer.own_ship_is_off = own_ship_is_off(windows);
  examine(windows, used, answer);
  if (answer.observability && !answer.range_is_known())
    answer.hypotheses = hypotheses(windows.bearings, used, {.huber_sigmas = options.huber_sigmas});
  find_causes(answer);
}

std::vector<TmaBearing> drawn_bearings(const BearingWindow& window, const BatchEstimate& estimate) {
  std::vector<TmaBearing> drawn;
  for (std::size_t i = 0; i < window.size(); ++i)
    drawn.push_back({window.time_s(i), degrees(window.bearing_rad(i)), window.site_m(i),
                     window.residual(i, estimate.x, estimate.time_s) * std::sqrt(window.weight(i))});
  return drawn;
}

void write_tma_report(const ReportArguments& report, const std::string& json, const std::string& log) {
  if (!report.page.empty()) write_output(report.page, tma_page(json, log));
  if (!report.svg.empty()) write_plots(report.svg, tma_plot_files(json, log));
}

// An option that a method takes no notice of is not ignored in silence.
void check_options(const TmaArguments& options) {
  if ((options.range_m > 0.0) != (options.range_sigma_m > 0.0))
    throw InputError("--range, --range-sigma", "stand one without the other", "both or neither");
  const auto refuse = [&](bool given, const char* option, const char* methods) {
    if (given) throw InputError(option, "is nothing that --method " + options.method + " takes notice of", methods);
  };
  const bool is_map = options.method == "map";
  refuse(!is_map && options.range_m > 0.0, "--range", "--method map");
  refuse(!is_map && options.velocity_sigma_mps != TmaArguments{}.velocity_sigma_mps, "--velocity-sigma",
         "--method map");
  refuse(options.is_cho() && std::isfinite(options.huber_sigmas), "--huber", "--method ml or map");
}

void tma(const TmaArguments& options) {
  check_options(options);
  check_outputs(options.report, {options.json}, {options.log});
  const Recording recording = read_tma_log(options);
  TmaAnswer answer;
  answer.log = options.log;
  answer.method = options.method;
  TmaWindows windows = tma_windows(recording, options, answer);
  answer.bearings = windows.bearings.size();
  answer.from_s = windows.bearings.first_time_s();
  solve(windows, options, answer);
  if (!answer.estimate.found)
    throw InputError(options.log, "has bearings that no start of " + options.method + " ends in numbers for",
                     "another --method");
  if (options.report.wanted()) answer.drawn = drawn_bearings(windows.bearings, answer.estimate);
  if (!is_standard_output(options.json) && !is_standard_output(options.report.page)) fmt::print("{}", tma_text(answer));
  if (options.json.empty() && !options.report.wanted()) return;
  const std::string json = tma_json(answer);
  if (!options.json.empty()) write_output(options.json, json);
  write_tma_report(options.report, json, options.log);
}

}  // namespace

void add_tma(const Subcommands& all) {
  auto options = std::make_shared<TmaArguments>();
  const Subcommand command = all.add("tma", "range, course and speed of a target from bearings and frequencies");
  command
      .argument("log", options->log,
                "measurement log (CSV) with bearing_deg and own ship's position, and with frequency_hz and own "
                "ship's velocity where there are frequencies; - is standard input")
      .required();
  command
      .argument("--method", options->method,
                "ml, map, or for comparison Cho's gauss_newton, levenberg, "
                "levenberg_marquardt")
      .default_shown()
      .one_of({"ml", "map", "gauss_newton", "levenberg", "levenberg_marquardt"});
  command.argument("--sigma", options->sigma_deg, "standard deviation of a bearing in degrees, in place of the log's")
      .positive();
  command
      .argument("--frequency-sigma", options->frequency_sigma_hz,
                "standard deviation of a frequency in Hz, in place of the log's")
      .positive();
  command.argument("--sound", options->sound_mps, "speed of sound, m/s").default_shown().positive();
  command
      .argument("--frequency-changes", options->frequency_changes,
                "where the source changed its tone: levels finds what belongs together; segments takes one "
                "frequency from jump to jump; switch uses bearings only; ignored believes in one frequency")
      .default_shown()
      .one_of({"levels", "segments", "switch", "ignored"});
  command.flag("--bearings-only", options->bearings_only, "leave the log's frequencies unused");
  command.argument("--from", options->from_s, "use measurements from this time on, s");
  command.argument("--to", options->to_s, "use measurements up to this time, s");
  command
      .argument("--huber", options->huber_sigmas,
                "bearings farther off than so many standard deviations count "
                "as outliers (of ml and map)")
      .positive();
  command
      .argument("--velocity-sigma", options->velocity_sigma_mps,
                "of map: what is believed of either component "
                "of the velocity about zero, m/s")
      .default_shown()
      .positive();
  command.argument("--range", options->range_m, "of map: what is believed of the range at the first bearing, m")
      .positive();
  command.argument("--range-sigma", options->range_sigma_m, "of map: its standard deviation, m").positive();
  command.argument("--json", options->json, "write the answer as JSON; - is standard output");
  add_report_arguments(command, options->report);
  add_log_arguments(command, options->reading);
  command.runs([options] { tma(*options); });
}

}  // namespace truebearing
