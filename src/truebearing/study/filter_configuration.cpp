// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/filter_configuration.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <string>
#include <vector>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/study/range_prior_configuration.hpp"

namespace truebearing {
namespace {

// Of the components behind those that a start tells: accelerations or a turn rate.
double read_rest(TableReader& table, int states, int told) {
  return states > told ? table.number("rest_sigma", kNonNegative) : 0.0;
}

}  // namespace

MotionLayout read_layout(TableReader& tracker, const MeasurementChoice& measurement) {
  MotionLayout layout{measurement.dimensions(), measurement.has_frequency};
  layout.is_lorenz = measurement.is_lorenz();
  if (layout.has_frequency) layout.frequency_q_hz2ps = tracker.number_or("frequency_q_hz2ps", 0.0, kNonNegative);
  return layout;
}

PriorStart read_prior_start(TableReader& table, int states) {
  const std::vector<double> x = table.numbers("x", states);
  const std::vector<double> variance = table.numbers("variance", states, kPositive);
  PriorStart prior;
  prior.x = Eigen::Map<const Eigen::VectorXd>(x.data(), states);
  prior.P = Eigen::Map<const Eigen::VectorXd>(variance.data(), states).asDiagonal();
  prior.time_s = table.number_or("time_s", 0.0);
  return prior;
}

// Aircraft climb more slowly than they fly.
double read_climb_sigma(TableReader& table, const MeasurementChoice& measurement) {
  if (!table.has("climb_sigma_mps")) return 0.0;
  if (measurement.dimensions() != 3)
    throw table.error("climb_sigma_mps", "has no meaning but in space", "velocity_sigma_mps alone");
  return table.number("climb_sigma_mps", kPositive);
}

Start read_start(TableReader& tracker, const MeasurementChoice& measurement, int states) {
  TableReader table = tracker.table("start");
  std::vector<std::string> kinds{"prior"};
  if (measurement.sensor->tells_position()) kinds.insert(kinds.end(), {"one_point", "two_point"});
  if (measurement.sensor->tells_bearing()) kinds.insert(kinds.end(), {"range", "hand_over"});
  const std::string kind = table.choice("kind", kinds);
  if (kind == "range") return read_range_prior(tracker.table("start"), measurement.dimensions());
  Start start;
  if (kind == "prior") {
    start = read_prior_start(table, states);
  } else if (kind == "hand_over") {
    start = HandOverStart{read_rest(table, states, measurement.leading())};
  } else if (kind == "one_point") {
    const double velocity_sigma_mps = table.number("velocity_sigma_mps", kPositive);
    const double position_sigma_m = table.has("position_sigma_m") ? table.number("position_sigma_m", kPositive) : 0.0;
    start = OnePointStart{velocity_sigma_mps, read_rest(table, states, measurement.leading()), position_sigma_m,
                          read_climb_sigma(table, measurement)};
  } else {
    start = TwoPointStart{read_rest(table, states, measurement.leading())};
  }
  table.finish();
  return start;
}

FilterTrackerOptions read_options(TableReader& tracker, const MeasurementChoice& measurement) {
  FilterTrackerOptions options;
  options.gate_nis_of = measurement.gate_nis_of;
  if (measurement.model == "sensors" && tracker.has("gate_probability"))
    throw tracker.error("gate_probability", "stands beside sensors of several sizes", "one in each [sensors.NAME]");
  if (tracker.has("gate_probability"))
    options.gate_nis =
        chi_square_quantile(tracker.number("gate_probability", {0.5, 1.0 - 1e-12}), measurement.sensor->size());
  options.lost_after_s = tracker.number_or("lost_after_s", std::numeric_limits<double>::infinity(), kPositive);
  options.output_pull = tracker.number_or("output_pull", 0.0, {0.0, 1.0});
  if (options.output_pull > 0.0 && !measurement.sensor->measures_position())
    throw tracker.error("output_pull", "needs measured positions", "0, or model = \"converted_range_bearing\"");
  options.ahead_s = tracker.number_or("ahead_s", 0.0, {0.0, 1e6});
  if (options.ahead_s > 0.0 && options.output_pull > 0.0)
    throw tracker.error("ahead_s", "stands beside output_pull, which is of the present", "one of the two");
  return options;
}

MarkovChain read_chain(TableReader& tracker, int modes) {
  constexpr double kRounding = 1e-6;
  constexpr Range kProbability{0.0, 1.0};
  TableReader table = tracker.table("transition");
  const double period_s = table.number("period_s", kPositive);
  MarkovChain chain;
  if (table.has("matrix")) {
    const std::vector<double> numbers = table.numbers("matrix", modes * modes, kProbability);
    chain.transition = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        numbers.data(), modes, modes);
    for (Eigen::Index i = 0; i < modes; ++i)
      if (std::abs(chain.transition.row(i).sum() - 1.0) > kRounding)
        throw table.error("matrix", fmt::format("has a row {} that does not sum to 1", i + 1), "probabilities");
    chain.initial = ModeVector::Constant(modes, 1.0 / modes);
    chain.period_s = period_s;
  } else {
    chain = star_chain(modes, table.number("leave_first", kProbability), table.number("leave_other", kProbability),
                       modes > 2 ? table.number("to_first", kProbability) : 1.0, period_s);
  }
  if (tracker.has("initial")) {
    const std::vector<double> initial = tracker.numbers("initial", modes, kProbability);
    chain.initial = Eigen::Map<const Eigen::VectorXd>(initial.data(), modes);
    if (std::abs(chain.initial.sum() - 1.0) > kRounding)
      throw tracker.error("initial", "does not sum to 1", "probabilities");
  }
  table.finish();
  return chain;
}

}  // namespace truebearing
