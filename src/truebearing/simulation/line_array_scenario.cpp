// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/line_array_scenario.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "truebearing/array/line_array.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

constexpr int kMostDraws = 10000;

// One target over the run: its angle and rate at the end of every interval, and of the one before the first.
struct Course {
  std::vector<double> angle_rad, rate_radps;  // [interval + 1]
  double appears_s = -kInfinity, vanishes_s = kInfinity;
};

double time_of(const LineArrayParameters& p, int interval) {
  return (p.first_interval + interval) * p.period_s;
}

Course course_of(const LineArrayParameters& p, const LineArrayParameters::Target& target) {
  Course course;
  course.appears_s = target.appears_s;
  course.vanishes_s = target.vanishes_s;
  for (int k = -1; k < p.intervals; ++k) {
    course.angle_rad.push_back(target.path.angle_rad(time_of(p, k)));
    course.rate_radps.push_back(target.path.rate_at_radps(time_of(p, k)));
  }
  return course;
}

std::vector<double> draw_starts(const LineArrayParameters::Random& random, RandomStream& stream) {
  for (int draw = 0; draw < kMostDraws; ++draw) {
    std::vector<double> starts_deg(static_cast<std::size_t>(random.targets));
    for (double& start : starts_deg) start = random.start_deg.draw(stream);
    std::sort(starts_deg.begin(), starts_deg.end());
    bool apart = true;
    for (std::size_t i = 1; i < starts_deg.size(); ++i)
      apart &= std::sin(radians(starts_deg[i])) - std::sin(radians(starts_deg[i - 1])) >= random.least_separation_sine;
    if (apart) return starts_deg;
  }
  throw InputError("random.least_separation_sine", "keeps every draw of so many targets from being one",
                   "fewer targets, wider starts or less separation");
}

Course draw_course(const LineArrayParameters& p, const LineArrayParameters::Random& random, double start_deg,
                   RandomStream& stream) {
  struct Change {
    double rate_degps, at_s, width_s;
  };
  const double rate_degps = random.rate_degps.draw(stream);
  std::vector<Change> changes(static_cast<std::size_t>(std::lround(std::max(0.0, random.changes.draw(stream)))));
  for (Change& change : changes)
    change = {random.rate_change_degps.draw(stream), random.change_at_s.draw(stream),
              random.change_width_s.draw(stream)};
  Course course;
  double angle_deg = start_deg;
  for (int k = -1; k < p.intervals; ++k) {
    double rate = rate_degps;
    for (const Change& change : changes)
      rate += 0.5 * change.rate_degps * (1.0 + std::tanh((time_of(p, k) - change.at_s) / change.width_s));
    if (k > 0) angle_deg += rate * p.period_s;
    course.angle_rad.push_back(radians(k < 0 ? angle_deg - rate * p.period_s : angle_deg));
    course.rate_radps.push_back(radians(rate));
  }
  if (random.appears_s) course.appears_s = random.appears_s->draw(stream);
  if (random.stays_s) course.vanishes_s = std::max(course.appears_s, 0.0) + random.stays_s->draw(stream);
  return course;
}

std::vector<Course> draw_courses(const LineArrayParameters& p, RandomStream& stream) {
  std::vector<Course> courses;
  if (!p.random) {
    for (const LineArrayParameters::Target& target : p.targets) courses.push_back(course_of(p, target));
    std::sort(courses.begin(), courses.end(),
              [](const Course& a, const Course& b) { return a.angle_rad[1] < b.angle_rad[1]; });
    return courses;
  }
  const double largest_rad = radians(p.random->largest_deg);
  for (int draw = 0; draw < kMostDraws; ++draw) {
    courses.clear();
    for (const double start_deg : draw_starts(*p.random, stream))
      courses.push_back(draw_course(p, *p.random, start_deg, stream));
    if (std::all_of(courses.begin(), courses.end(), [&](const Course& course) {
          return std::all_of(course.angle_rad.begin(), course.angle_rad.end(),
                             [&](double angle) { return std::abs(angle) <= largest_rad; });
        }))
      return courses;
  }
  throw InputError("random.largest_deg", "is passed in every draw", "a larger one, or slower targets");
}

std::complex<double> complex_normal(RandomStream& stream) {  // of power 1
  const double re = stream.normal();
  return {re * std::numbers::sqrt2 / 2.0, stream.normal() * std::numbers::sqrt2 / 2.0};
}

// What a target does at a step, by place in the recording's phases.
int phase_of(const std::vector<Course>& courses, std::size_t target, int k, const LineArrayParameters& p) {
  const std::size_t at = static_cast<std::size_t>(k + 1);
  const Course& course = courses[target];
  const auto is_there = [&](const Course& c) { return time_of(p, k) >= c.appears_s && time_of(p, k) < c.vanishes_s; };
  for (std::size_t other = 0; other < courses.size(); ++other)
    if (other != target && is_there(courses[other]) &&
        std::abs(courses[other].angle_rad[at] - course.angle_rad[at]) < p.phases->crossing_rad)
      return 0;
  const double change = std::abs(course.rate_radps[at] - course.rate_radps[at - 1]) / p.period_s;
  return change > p.phases->manoeuvre_radps2 ? 1 : 2;
}

}  // namespace

const StateSpace& LineArrayScenario::truth_space() const {
  return angle_space();
}

Recording LineArrayScenario::simulate(const RunKey& key) const {
  const LineArrayParameters& p = parameters_;
  RandomStream scenario(key, StreamId::scenario), process(key, StreamId::process), noise(key, StreamId::measurement);
  const std::vector<Course> courses = draw_courses(p, scenario);
  const std::size_t N = courses.size(), M = static_cast<std::size_t>(p.sensors);
  const std::size_t Ns = static_cast<std::size_t>(p.snapshots);
  const double run_snr_db = p.snr_db.draw(scenario);
  std::vector<double> amplitude(N);

  Recording recording;
  recording.measured = measured()->components;
  recording.truth_space = &angle_space();
  recording.truth.resize(N);
  if (p.phases) recording.phases = {"crossing", "manoeuvre", "quiet"};
  for (std::size_t n = 0; n < N; ++n) {
    const double snr = std::pow(10.0, (run_snr_db + p.snr_spread_db.draw(scenario)) / 10.0);
    amplitude[n] = std::sqrt(snr * p.noise_power);
    recording.truth[n].track = static_cast<int>(n);
    recording.truth[n].snr = snr;
  }

  auto values = std::make_shared<std::vector<std::complex<double>>>(static_cast<std::size_t>(p.intervals) * Ns * M);
  const double shared = std::sqrt(p.correlation), own = std::sqrt(1.0 - p.correlation);
  const double sensor_sigma = std::sqrt(p.noise_power);
  auto at = values->begin();
  for (int k = 0; k < p.intervals; ++k) {
    const std::size_t end = static_cast<std::size_t>(k + 1);
    for (std::size_t t = 0; t < Ns; ++t) {
      const double back = static_cast<double>(Ns - 1 - t) / static_cast<double>(Ns);  // of the interval, from its end
      const double time_s = time_of(p, k) - back * p.period_s;
      for (std::size_t m = 0; m < M; ++m) at[static_cast<std::ptrdiff_t>(m)] = sensor_sigma * complex_normal(noise);
      const std::complex<double> common = p.correlation > 0.0 ? complex_normal(process) : 0.0;
      for (std::size_t n = 0; n < N; ++n) {
        const Course& course = courses[n];
        std::complex<double> s = amplitude[n] * (shared * common + own * complex_normal(process));
        if (time_s < course.appears_s || time_s >= course.vanishes_s) continue;
        const double moved = p.moving ? back * (course.angle_rad[end - 1] - course.angle_rad[end]) : 0.0;
        const double step = 2.0 * kPi * p.spacing_wavelengths * std::sin(course.angle_rad[end] + moved);
        const std::complex<double> turn = std::polar(1.0, step);
        for (std::size_t m = 0; m < M; ++m) {
          at[static_cast<std::ptrdiff_t>(m)] += s;
          s *= turn;
        }
      }
      for (const int dead : p.dead_sensors) at[dead] = 0.0;
      if (p.lost_share > 0.0 && noise.uniform() < p.lost_share)
        std::fill(at, at + static_cast<std::ptrdiff_t>(M), std::complex<double>(kNaN, kNaN));
      at += static_cast<std::ptrdiff_t>(M);
    }
    Measurement taken;
    taken.time_s = time_of(p, k);
    taken.snapshots = SnapshotBlock{std::span(*values).subspan(static_cast<std::size_t>(k) * Ns * M, Ns * M), p.sensors,
                                    p.spacing_wavelengths, p.period_s};
    recording.measurements.push_back(std::move(taken));
    for (std::size_t n = 0; n < N; ++n) {
      const Course& course = courses[n];
      const bool there = time_of(p, k) >= course.appears_s && time_of(p, k) < course.vanishes_s;
      BoundedVector x(2);
      x << course.angle_rad[end], course.rate_radps[end];
      if (!there) x.setConstant(kNaN);
      recording.truth[n].x.push_back(x);
      if (p.phases) recording.truth[n].phase.push_back(there ? phase_of(courses, n, k, p) : -1);
    }
  }
  recording.snapshots = std::move(values);
  return recording;
}

std::string LineArrayScenario::note() const {
  return LineArray{parameters_.sensors, parameters_.spacing_wavelengths}.note();
}

namespace {

void read_array(TableReader table, LineArrayParameters& p) {
  p.sensors = static_cast<int>(table.integer("sensors", 2, 1024));
  if (table.has("spacing_m"))
    p.spacing_wavelengths = table.number("spacing_m", kPositive) * table.number("frequency_hz", kPositive) /
                            table.number_or("sound_mps", 1500.0, kPositive);
  else
    p.spacing_wavelengths = table.number_or("spacing_wavelengths", 0.5, kPositive);
  p.snapshots = static_cast<int>(table.integer("snapshots", 1, 100000));
  p.noise_power = table.number_or("noise_power", 1.0, kPositive);
  if (table.has("dead_sensors"))
    for (const double sensor : table.numbers("dead_sensors", -1, {0.0, p.sensors - 1.0}))
      p.dead_sensors.push_back(static_cast<int>(std::lround(sensor)));
  p.lost_share = table.number_or("lost_share", 0.0, {0.0, 1.0});
  table.finish();
}

LineArrayParameters::Random read_random(TableReader table) {
  constexpr Range kAngle{-89.0, 89.0}, kNonNegativeTime{0.0, 1e9};
  LineArrayParameters::Random random;
  random.targets = static_cast<int>(table.integer("targets", 1, 32));
  random.start_deg = read_distribution(table, "start_deg", kAngle);
  random.least_separation_sine = table.number_or("least_separation_sine", 0.0, {0.0, 1.0});
  random.rate_degps = read_distribution_or(table, "rate_degps", 0.0);
  random.changes = read_distribution_or(table, "changes", 0.0, {0.0, 20.0});
  random.rate_change_degps = read_distribution_or(table, "rate_change_degps", 0.0);
  random.change_at_s = read_distribution_or(table, "change_at_s", 0.0);
  random.change_width_s = read_distribution_or(table, "change_width_s", 1.0, kPositive);
  random.largest_deg = table.number_or("largest_deg", 89.0, {0.0, 89.0, true});
  if (table.has("appears_s")) random.appears_s = read_distribution(table, "appears_s");
  if (table.has("stays_s")) random.stays_s = read_distribution(table, "stays_s", kNonNegativeTime);
  table.finish();
  return random;
}

}  // namespace

std::unique_ptr<Scenario> read_line_array_scenario(TableReader& table) {
  LineArrayParameters p;
  p.period_s = table.number("period_s", {0.0, 3600.0, true});
  p.first_interval = static_cast<int>(table.integer_or("first_interval", 0, -1000000, 1000000));
  p.intervals = static_cast<int>(table.integer("intervals", 1, 100000));
  p.moving = table.boolean_or("moving", false);
  read_array(table.table("array"), p);
  TableReader signals = table.table("signals");
  p.snr_db = read_distribution(signals, "snr_db");
  p.snr_spread_db = read_distribution_or(signals, "snr_spread_db", 0.0);
  p.correlation = signals.number_or("correlation", 0.0, {0.0, 0.999});
  signals.finish();
  if (auto random = table.table_if_present("random")) {
    p.random = read_random(std::move(*random));
    if (table.has("targets")) throw table.error("targets", "stands beside [random]", "one of the two");
  } else {
    for (TableReader& target : table.tables("targets")) {
      p.targets.push_back({read_angle_path(target), target.number_or("appears_s", -kInfinity),
                           target.number_or("vanishes_s", kInfinity)});
      for (int k = -1; k < p.intervals; ++k)
        if (std::abs(p.targets.back().path.angle_rad(time_of(p, k))) >= radians(90.0))
          throw target.error("start_deg", "begins a path that passes 90 deg", "a path in front of the array");
      target.finish();
    }
    if (p.targets.empty()) throw table.error("targets", "is missing or empty", "[[targets]] or [random]");
  }
  if (auto phases = table.table_if_present("phases")) {
    p.phases = {radians(phases->number("crossing_deg", kNonNegative)),
                radians(phases->number("manoeuvre_degps2", kNonNegative))};
    phases->finish();
  }
  return std::make_unique<LineArrayScenario>(std::move(p));
}

}  // namespace truebearing
