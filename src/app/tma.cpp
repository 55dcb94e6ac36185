// truebearing tma LOG.csv: from bearings, frequencies where the log has them, and own ship's track to the target's
// range, course and speed, and to the tone of its source.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <optional>

#include "app/log_options.hpp"
#include "app/output.hpp"
#include "app/subcommands.hpp"
#include "app/tma_answer.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/recording/recording_csv.hpp"
#include "truebearing/tma/target_motion_batch.hpp"
#include "truebearing/tma/cho_2015.hpp"
#include "truebearing/tma/frequency_changes.hpp"

namespace truebearing {
namespace {

struct TmaArguments {
  std::string log;
  std::string method = "ml";
  std::string json;
  LogArguments reading;
  double sigma_deg = 0.0;
  double from_s = -std::numeric_limits<double>::infinity();
  double to_s = std::numeric_limits<double>::infinity();
  double huber_sigmas = std::numeric_limits<double>::infinity();
  double velocity_sigma_mps = 5.0;
  double range_m = 0.0;
  double range_sigma_m = 0.0;
  double frequency_sigma_hz = 0.0;
  double sound_mps = kSoundInWater_mps;
  std::string frequency_changes = "levels";
  bool bearings_only = false;

  bool is_cho() const { return method != "ml" && method != "map"; }
};

struct Windows {
  BearingWindow bearings;
  DopplerWindow frequencies;
};

Recording read_log(const TmaArguments& options) {
  LogFindings findings;
  RecordingOptions wanted;
  wanted.measured = {"bearing_deg", "frequency_hz"};
  Recording recording = read_recording(options.log, options.reading.over(wanted), &findings);
  print_note(options.log, findings.note());
  const bool has_frequencies = recording.measured == std::vector<std::string>{"bearing_deg", "frequency_hz"};
  if (!has_frequencies && recording.measured != std::vector<std::string>{"bearing_deg"})
    throw InputError(options.log, fmt::format("measures {}", fmt::join(recording.measured, ", ")),
                     "bearing_deg, or bearing_deg and frequency_hz in this order");
  if (has_frequencies && options.is_cho() && !options.bearings_only)
    throw InputError(options.log, "has frequencies, which --method " + options.method + " takes no notice of",
                     "--method ml or map, or --bearings-only");
  if (recording.truth_space && !begins_in_plane(*recording.truth_space))
    throw InputError(options.log, "has a truth that is not in the plane", "truth_east_m, truth_north_m");
  return recording;
}

void add_frequency(const Measurement& measurement, const TmaArguments& options, DopplerWindow& window) {
  if (measurement.sigma.size() == 0 && !(options.frequency_sigma_hz > 0.0))
    throw InputError(options.log, "does not say how good its frequencies are",
                     "a column frequency_sigma_hz, --frequency-sigma, or --bearings-only");
  const double sigma_hz = options.frequency_sigma_hz > 0.0 ? options.frequency_sigma_hz : measurement.sigma[1];
  window.add(measurement.time_s, measurement.z[1], sigma_hz, *measurement.sensor);
}

// Without own ship's velocity its own share of the Doppler shift would be taken for the target's.
void check_velocities(const DopplerWindow& window, const std::string& log) {
  bool at_rest = true, moved = false;
  for (std::size_t i = 0; i < window.size(); ++i) {
    at_rest = at_rest && window.sensor(i).velocity_mps.isZero(0.0);
    moved = moved || window.sensor(i).position_m != window.sensor(0).position_m;
  }
  if (at_rest && moved)
    throw InputError(log, "has frequencies of a sensor that moves, and not its velocity",
                     "columns sensor_east_mps, sensor_north_mps, or --bearings-only");
}

Windows windows_of(const Recording& recording, const TmaArguments& options, TmaAnswer& answer) {
  Windows windows{{}, DopplerWindow(options.sound_mps)};
  const bool has_frequencies = recording.measured.size() == 2 && !options.bearings_only;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const Measurement& measurement = recording.measurements[k];
    if (measurement.time_s < options.from_s || measurement.time_s > options.to_s) continue;
    const bool has_bearing = std::isfinite(measurement.z[0]);
    const bool has_frequency = has_frequencies && std::isfinite(measurement.z[1]);
    answer.missing += !has_bearing;
    answer.missing_frequencies += has_frequencies && !has_frequency;
    if (!has_bearing && !has_frequency) continue;
    if (!measurement.sensor)
      throw InputError(options.log, "does not say where own ship was", "columns sensor_east_m, sensor_north_m");
    if (has_frequency) add_frequency(measurement, options, windows.frequencies);
    if (!has_bearing) continue;
    if (measurement.sigma.size() == 0 && !(options.sigma_deg > 0.0))
      throw InputError(options.log, "does not say how good its bearings are", "a column bearing_sigma_deg, or --sigma");
    const double sigma_rad = options.sigma_deg > 0.0 ? radians(options.sigma_deg) : measurement.sigma[0];
    windows.bearings.add(measurement.time_s, measurement.z[0], sigma_rad, measurement.sensor->position_m);
    answer.own_ship = *measurement.sensor;
    if (recording.truth_space && recording.truth[0].x[k].head<4>().allFinite()) answer.truth = recording.truth[0].x[k];
  }
  constexpr std::size_t kFewest = 5;
  if (windows.bearings.size() < kFewest)
    throw InputError(options.log, fmt::format("has {} usable bearings in that time", windows.bearings.size()),
                     fmt::format("{} or more", kFewest));
  if (!(windows.bearings.last_time_s() > windows.bearings.first_time_s()))
    throw InputError(options.log, "has all its bearings at one time", "bearings over a time");
  check_velocities(windows.frequencies, options.log);
  return windows;
}

BatchPrior prior_of(const TmaArguments& options, const BearingWindow& window) {
  BatchPrior prior;
  prior.velocity_information = Eigen::Matrix2d::Identity() / (options.velocity_sigma_mps * options.velocity_sigma_mps);
  if (options.range_sigma_m > 0.0)
    prior.range = BatchPrior::Range{options.range_m, options.range_sigma_m, window.site_m(0), window.first_time_s()};
  return prior;
}

FrequencyChangeOptions changes_of(const TmaArguments& options) {
  using Handling = FrequencyChangeOptions::Handling;
  FrequencyChangeOptions changes;
  if (options.frequency_changes == "segments") changes.handling = Handling::segments;
  if (options.frequency_changes == "switch") changes.handling = Handling::bearings_only;
  if (options.frequency_changes == "ignored") changes.handling = Handling::ignored;
  return changes;
}

// The state that explains the data best, at each of some ranges at the last bearing.
std::vector<Eigen::Vector4d> hypotheses(const BearingWindow& window, const DopplerWindow* frequencies,
                                        const TargetMotionBatchOptions& options) {
  constexpr double kRanges_m[] = {1000.0, 2000.0, 5000.0, 10000.0, 20000.0, 50000.0};
  constexpr double kExactly_m = 0.1;
  std::vector<Eigen::Vector4d> states;
  TargetMotionBatch batch(options);
  for (const double range_m : kRanges_m) {
    BatchPrior prior;
    prior.range = BatchPrior::Range{range_m, kExactly_m, window.site_m(window.size() - 1), window.last_time_s()};
    const BatchEstimate estimate = batch.solve(window, prior, nullptr, frequencies);
    if (estimate.found) states.push_back(estimate.x);
  }
  return states;
}

// The times over which the source kept a level, outliers apart.
void list_levels(const DopplerWindow& window, TmaSource& source, const BatchEstimate& estimate) {
  std::vector<SourceFrequency> sources;
  window.sources(estimate.x, estimate.time_s, sources);
  int current = -1;
  for (std::size_t i = 0; i < window.size(); ++i) {
    const int level = window.level(i);
    const bool goes_on = i + 1 < window.size() && window.level(i + 1) == level;
    if (level != current && !goes_on) {
      ++source.outliers;
      continue;
    }
    const SourceFrequency& f0 = sources[static_cast<std::size_t>(level)];
    if (level != current)
      source.levels.push_back({window.time_s(i), 0.0, 0, f0.frequency_hz, std::sqrt(f0.variance_with(estimate.P))});
    current = level;
    source.levels.back().to_s = window.time_s(i);
    ++source.levels.back().count;
  }
}

void solve(Windows& windows, const TmaArguments& options, TmaAnswer& answer) {
  const BearingWindow& bearings = windows.bearings;
  if (options.is_cho()) {
    ChoOptions cho;
    if (options.method == "gauss_newton") cho.method = ChoOptions::Method::gauss_newton;
    if (options.method == "levenberg") cho.method = ChoOptions::Method::levenberg;
    answer.estimate = solve_cho(bearings, cho);
    if (answer.estimate.found) answer.residuals = check_residuals(bearings, answer.estimate);
    return;
  }
  const TargetMotionBatchOptions batch_options{.huber_sigmas = options.huber_sigmas};
  TargetMotionBatch batch(batch_options);
  answer.has_prior = options.method == "map";
  std::optional<BatchPrior> prior;
  if (answer.has_prior) prior = prior_of(options, bearings);
  const DopplerWindow* used = nullptr;
  if (windows.frequencies.size() > 0) {
    FrequencyChangeBatch with_frequencies(changes_of(options));
    answer.estimate = with_frequencies.solve(batch, bearings, windows.frequencies, prior);
    if (with_frequencies.used_frequencies()) used = &windows.frequencies;
    TmaSource& source = answer.source.emplace();
    source.used = used;
    source.sound_mps = options.sound_mps;
    source.looked_for = options.frequency_changes != "ignored";
    source.frequencies = windows.frequencies.size();
    source.changes.assign(with_frequencies.changes().begin(), with_frequencies.changes().end());
    if (answer.estimate.found) list_levels(windows.frequencies, source, answer.estimate);
  } else {
    answer.estimate = batch.solve(bearings, prior);
  }
  if (!answer.estimate.found) return;
  answer.residuals = check_residuals(bearings, answer.estimate, used);
  answer.observability = batch.observability();
  answer.ambiguities = batch.ambiguities();
  if (!answer.range_is_known()) answer.hypotheses = hypotheses(bearings, used, batch_options);
}

void tma(const TmaArguments& options) {
  if ((options.range_m > 0.0) != (options.range_sigma_m > 0.0))
    throw InputError("--range, --range-sigma", "stand one without the other", "both or neither");
  check_outputs({options.json}, {options.log});
  const Recording recording = read_log(options);
  TmaAnswer answer;
  answer.log = options.log;
  answer.method = options.method;
  Windows windows = windows_of(recording, options, answer);
  answer.bearings = windows.bearings.size();
  answer.from_s = windows.bearings.first_time_s();
  solve(windows, options, answer);
  if (!answer.estimate.found)
    throw InputError(options.log, "has bearings that no start of " + options.method + " ends in numbers for",
                     "another --method");
  if (!is_standard_output(options.json)) fmt::print("{}", tma_text(answer));
  if (!options.json.empty()) write_output(options.json, tma_json(answer));
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
  add_log_arguments(command, options->reading);
  command.runs([options] { tma(*options); });
}

}  // namespace truebearing
