// truebearing tma LOG.csv: from bearings and own ship's track to the target's range, course and speed.
#include <Eigen/LU>
#include <cmath>
#include <fmt/format.h>
#include <memory>

#include "app/output.hpp"
#include "app/subcommands.hpp"
#include "app/tma_answer.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/measurement/recording_csv.hpp"
#include "truebearing/tma/bearings_only_batch.hpp"
#include "truebearing/tma/cho_2015.hpp"

namespace truebearing {
namespace {

struct Options {
  std::string log;
  std::string method = "ml";
  std::string json;
  double sigma_deg = 0.0;
  double from_s = -std::numeric_limits<double>::infinity();
  double to_s = std::numeric_limits<double>::infinity();
  double huber_sigmas = std::numeric_limits<double>::infinity();
  double velocity_sigma_mps = 5.0;
  double range_m = 0.0;
  double range_sigma_m = 0.0;
};

Recording read_bearings(const Options& options) {
  Recording recording = read_recording(options.log);
  if (recording.measured != std::vector<std::string>{"bearing_deg"})
    throw InputError(options.log, fmt::format("measures {}", fmt::join(recording.measured, ", ")), "bearing_deg");
  if (recording.truth_space && recording.truth_space != &plane_space())
    throw InputError(options.log, "has a truth that is not in the plane", "truth_east_m, truth_north_m");
  return recording;
}

BearingWindow window_of(const Recording& recording, const Options& options, TmaAnswer& answer) {
  BearingWindow window;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const Measurement& measurement = recording.measurements[k];
    if (measurement.time_s < options.from_s || measurement.time_s > options.to_s) continue;
    answer.missing += measurement.is_missing();
    if (measurement.is_missing()) continue;
    if (!measurement.sensor)
      throw InputError(options.log, "does not say where own ship was", "columns sensor_east_m, sensor_north_m");
    if (measurement.sigma.size() == 0 && !(options.sigma_deg > 0.0))
      throw InputError(options.log, "does not say how good its bearings are", "a column bearing_sigma_deg, or --sigma");
    const double sigma_rad = options.sigma_deg > 0.0 ? radians(options.sigma_deg) : measurement.sigma[0];
    window.add(measurement.time_s, measurement.z[0], sigma_rad, measurement.sensor->position_m);
    answer.own_ship = *measurement.sensor;
    if (recording.truth_space && recording.truth[0].x[k].allFinite()) answer.truth = recording.truth[0].x[k];
  }
  constexpr std::size_t kFewest = 5;
  if (window.size() < kFewest)
    throw InputError(options.log, fmt::format("has {} usable bearings in that time", window.size()),
                     fmt::format("{} or more", kFewest));
  if (!(window.last_time_s() > window.first_time_s()))
    throw InputError(options.log, "has all its bearings at one time", "bearings over a time");
  return window;
}

BatchPrior prior_of(const Options& options, const BearingWindow& window) {
  BatchPrior prior;
  prior.velocity_information = Eigen::Matrix2d::Identity() / (options.velocity_sigma_mps * options.velocity_sigma_mps);
  if (options.range_sigma_m > 0.0)
    prior.range = BatchPrior::Range{options.range_m, options.range_sigma_m, window.site_m(0), window.first_time_s()};
  return prior;
}

// The state that explains the bearings best, at each of some ranges at the last of them.
std::vector<Eigen::Vector4d> hypotheses(const BearingWindow& window, const BearingsOnlyBatchOptions& options) {
  constexpr double kRanges_m[] = {1000.0, 2000.0, 5000.0, 10000.0, 20000.0, 50000.0};
  constexpr double kExactly_m = 0.1;
  std::vector<Eigen::Vector4d> states;
  BearingsOnlyBatch batch(options);
  for (const double range_m : kRanges_m) {
    BatchPrior prior;
    prior.range = BatchPrior::Range{range_m, kExactly_m, window.site_m(window.size() - 1), window.last_time_s()};
    const BatchEstimate estimate = batch.solve(window, prior);
    if (estimate.found) states.push_back(estimate.x);
  }
  return states;
}

void solve(const BearingWindow& window, const Options& options, TmaAnswer& answer) {
  if (options.method != "ml" && options.method != "map") {
    ChoOptions cho;
    if (options.method == "gauss_newton") cho.method = ChoOptions::Method::gauss_newton;
    if (options.method == "levenberg") cho.method = ChoOptions::Method::levenberg;
    answer.estimate = solve_cho(window, cho);
    return;
  }
  const BearingsOnlyBatchOptions batch_options{.huber_sigmas = options.huber_sigmas};
  BearingsOnlyBatch batch(batch_options);
  answer.has_prior = options.method == "map";
  answer.estimate = answer.has_prior ? batch.solve(window, prior_of(options, window)) : batch.solve(window);
  if (!answer.estimate.found) return;
  answer.observability = batch.observability();
  answer.ambiguities = batch.ambiguities();
  if (!answer.range_is_known()) answer.hypotheses = hypotheses(window, batch_options);
}

void tma(const Options& options) {
  if ((options.range_m > 0.0) != (options.range_sigma_m > 0.0))
    throw InputError("--range, --range-sigma", "stand one without the other", "both or neither");
  const Recording recording = read_bearings(options);
  TmaAnswer answer;
  answer.log = options.log;
  answer.method = options.method;
  const BearingWindow window = window_of(recording, options, answer);
  answer.bearings = window.size();
  answer.from_s = window.first_time_s();
  solve(window, options, answer);
  if (!answer.estimate.found)
    throw InputError(options.log, "has bearings that no start of " + options.method + " ends in numbers for",
                     "another --method");
  answer.residuals = check_residuals(window, answer.estimate);
  if (options.json != "-") fmt::print("{}", tma_text(answer));
  if (!options.json.empty()) write_output(options.json, tma_json(answer));
}

}  // namespace

void add_tma(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("tma", "range, course and speed of a target from bearings");
  command
      ->add_option("log", options->log,
                   "measurement log (CSV) with bearing_deg and own ship's position; - is "
                   "standard input")
      ->required();
  command
      ->add_option("--method", options->method,
                   "ml, map, or for comparison Cho's gauss_newton, levenberg, "
                   "levenberg_marquardt")
      ->capture_default_str()
      ->check(CLI::IsMember({"ml", "map", "gauss_newton", "levenberg", "levenberg_marquardt"}));
  command
      ->add_option("--sigma", options->sigma_deg, "standard deviation of a bearing in degrees, in place of the log's")
      ->check(CLI::PositiveNumber);
  command->add_option("--from", options->from_s, "use bearings from this time on, s");
  command->add_option("--to", options->to_s, "use bearings up to this time, s");
  command
      ->add_option("--huber", options->huber_sigmas,
                   "bearings farther off than so many standard deviations count "
                   "as outliers (of ml and map)")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--velocity-sigma", options->velocity_sigma_mps,
                   "of map: what is believed of either component "
                   "of the velocity about zero, m/s")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->add_option("--range", options->range_m, "of map: what is believed of the range at the first bearing, m")
      ->check(CLI::PositiveNumber);
  command->add_option("--range-sigma", options->range_sigma_m, "of map: its standard deviation, m")
      ->check(CLI::PositiveNumber);
  command->add_option("--json", options->json, "write the answer as JSON; - is standard output");
  command->callback([options] { tma(*options); });
}

}  // namespace truebearing
