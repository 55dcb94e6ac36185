// SPDX-License-Identifier: Apache-2.0
// The answer of `truebearing tma` in words.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "app/tma_answer.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing {
namespace {

std::string row(const char* name, int decimals, double value, double sigma, const std::optional<double>& truth,
                bool known) {
  return fmt::format("{:<14} {:>15} {:>13} {:>13}\n", name, known ? figure(value, sigma, decimals) : "not determined",
                     known ? figure(sigma, sigma, decimals) : "", truth ? figure(*truth, sigma, decimals) : "");
}

std::string motion_table(const TmaAnswer& answer) {
  const Motion motion(answer.estimate.x, answer.own_ship);
  const MotionSigmas sigma(answer.estimate.x, answer.estimate.P, answer.own_ship);
  std::optional<Motion> truth;
  if (answer.truth) truth.emplace(answer.truth->head<4>(), answer.own_ship);
  const auto of_truth = [&](double Motion::*value) { return truth ? std::optional(*truth.*value) : std::nullopt; };
  const auto coordinate = [&](int i) { return answer.truth ? std::optional((*answer.truth)[i]) : std::nullopt; };
  const bool known = answer.has_motion();
  const Eigen::Vector4d& x = answer.estimate.x;
  const Eigen::Vector4d sigmas = answer.estimate.P.diagonal().cwiseSqrt();
  std::string text = fmt::format("{:<14}{:>16}{:>14}{:>14}\n", fmt::format("at {} s", seconds(answer.estimate.time_s)),
                                 "estimate", "std. dev.", answer.truth ? "truth" : "");
  text += row("bearing deg", 2, motion.bearing_deg, sigma.bearing_deg, of_truth(&Motion::bearing_deg), true);
  text += row("range m", 0, motion.range_m, sigma.range_m, of_truth(&Motion::range_m), known);
  text += row("course deg", 1, motion.course_deg, sigma.course_deg, of_truth(&Motion::course_deg), known);
  text += row("speed m/s", 2, motion.speed_mps, sigma.speed_mps, of_truth(&Motion::speed_mps), known);
  text += row("East m", 0, x[0], sigmas[0], coordinate(0), known);
  text += row("North m", 0, x[1], sigmas[1], coordinate(1), known);
  if (answer.source && !answer.source->levels.empty()) {
    const TmaSource::Level& last = answer.source->levels.back();
    text += row("source Hz", 3, last.frequency_hz, last.sigma_hz, true_frequency(answer), true);
  }
  if (!known) return text;
  const Ellipse ellipse(answer.estimate.P);
  return text + fmt::format("95 % ellipse: semi-axes {} m and {} m, the longer towards {:.0f} deg\n",
                            figure(ellipse.semi_major_m, ellipse.semi_major_m, 0),
                            figure(ellipse.semi_minor_m, ellipse.semi_minor_m, 0), ellipse.orientation_deg);
}

// A small jump of a tone sounds like a target that changes its velocity.
std::string manoeuvre_instead(const TmaSource& source) {
  constexpr double kLikely_mps = 20.0;
  double least_mps = kLikely_mps;
  for (std::size_t i = 1; i < source.levels.size(); ++i) {
    const double before_hz = source.levels[i - 1].frequency_hz, change_hz = source.levels[i].frequency_hz - before_hz;
    least_mps = std::min(least_mps, std::abs(change_hz) / before_hz * source.sound_mps);
  }
  if (least_mps >= kLikely_mps) return {};
  return fmt::format(
      "Or the target manoeuvred: {:.1f} m/s more or less along the line of sight would have done the same.\n",
      least_mps);
}

std::string source_lines(const TmaAnswer& answer) {
  if (!answer.source) return {};
  const TmaSource& source = *answer.source;
  std::string text = "\n";
  for (std::size_t i = 0; i < source.changes.size(); ++i)
    text += fmt::format("{} at {} s, to {:.3f} Hz\n",
                        i == 0 ? "THE SOURCE CHANGED ITS FREQUENCY" : "                       and again",
                        seconds(source.changes[i].time_s), source.changes[i].frequency_hz);
  if (!source.looked_for)
    text += "one frequency of the source is taken for granted\n";
  else if (source.changes.empty())
    text += "no sign that the source changed its frequency\n";
  text += manoeuvre_instead(source);
  if (!source.used) text += "Because of that the frequencies were left out: the answer is from the bearings alone.\n";
  text += fmt::format("{:>10} {:>10}{:>14}{:>14}{:>14}\n", "from s", "to s", "source Hz", "std. dev.", "frequencies");
  for (const TmaSource::Level& level : source.levels)
    text += fmt::format("{:>10} {:>10}{:>14.3f}{:>14.4f}{:>14}\n", seconds(level.from_s), seconds(level.to_s),
                        level.frequency_hz, level.sigma_hz, level.count);
  if (source.outliers > 0) text += fmt::format("frequencies that fit none of these: {}\n", source.outliers);
  return text;
}

std::string size_of_the_residuals(const ResidualChecks& checks) {
  if (checks.fits) return "as it should be";
  return checks.too_small ? "SMALLER THAN THE NOISE SHOULD LEAVE THEM" : "LARGER THAN THE NOISE ALLOWS";
}

std::string whiteness(const ResidualChecks& checks) {
  if (!std::isfinite(checks.lag_one)) return "no correlation to speak of: they are nothing but rounding";
  return fmt::format("correlation at lag one {:+.1f} standard deviations, {}", checks.lag_one,
                     checks.white ? "white" : "NOT WHITE");
}

// As well as by a change of velocity, and likelier.
bool explained_otherwise(const TmaAnswer& answer) {
  if (answer.causes.empty()) return false;
  const std::string& first = answer.causes.front().kind;
  return first == "own_ship" || first == "bearing_bias" || first == "back_bearings" || first == "two_contacts";
}

std::string manoeuvre_lines(const TmaAnswer& answer) {
  const ResidualChecks& checks = answer.residuals;
  if (!checks.change) return "no sign that the target changed its velocity\n";
  const VelocityChange& change = *checks.change;
  if (explained_otherwise(answer))
    return fmt::format(
        "a change of the target's velocity at about {} s ({} to {} s; score {:.0f}) would look much like it, but there "
        "is a likelier explanation: see the end\n",
        seconds(change.time_s), seconds(change.earliest_s), seconds(change.latest_s), checks.manoeuvre);
  std::string text = fmt::format(
      "THE TARGET SEEMS TO HAVE CHANGED ITS VELOCITY at about {} s ({} to {} s; score {:.0f}): one course and speed do "
      "not\nexplain these measurements, and the figures above average over several.\n",
      seconds(change.time_s), seconds(change.earliest_s), seconds(change.latest_s), checks.manoeuvre);
  if (range_is_known(change, answer.own_ship))
    text += "With one change of velocity then, at the end: " + motion_with_sigmas(change.x, change.P, answer.own_ship) +
            "\n";
  bool any = false;
  for (const TmaStretch& stretch : answer.stretches) {
    if (!stretch.range_is_known) continue;
    any = true;
    const bool first = stretch.to_s < answer.residuals.change->time_s;
    text += fmt::format("Try {} {}: {}\n", first ? "--to" : "--from", seconds(first ? stretch.to_s : stretch.from_s),
                        motion_with_sigmas(stretch.estimate.x, stretch.estimate.P, stretch.own_ship));
  }
  if (!any) text += "Neither what is before it nor what is after it determines the range by itself.\n";
  return text;
}

std::string outlier_lines(const TmaAnswer& answer) {
  constexpr std::size_t kMost = 20;
  std::string text;
  for (const auto& [name, outliers] :
       {std::pair("bearings", &answer.outliers), std::pair("frequencies", &answer.frequency_outliers)}) {
    if (outliers->empty()) continue;
    text += fmt::format("{} that do not belong to the others: {}, in ", name, outliers->size());
    for (std::size_t i = 0; i < std::min(kMost, outliers->size()); ++i)
      text += fmt::format("{}{} ({} s)", i == 0 ? "line " : ", ", (*outliers)[i].line, seconds((*outliers)[i].time_s));
    text += outliers->size() > kMost ? ", ...\n" : "\n";
  }
  const ResidualChecks& checks = answer.residuals;
  if (!answer.outliers.empty())
    text += fmt::format("without these bearings: chi-square {:.1f} for {} degrees of freedom\n", checks.rest.chi_square,
                        checks.rest.degrees_of_freedom);
  return text;
}

// What an error that no residual shows would do.
std::string bias_lines(const TmaAnswer& answer) {
  if (!answer.range_is_known() || !answer.residuals.least_squares.found) return {};
  const BearingBias& bias = answer.residuals.bias;
  const Eigen::Vector4d& x = answer.residuals.least_squares.x;
  const Motion is(x, answer.own_ship), would_be(x + radians(1.0) * bias.moves, answer.own_ship);
  const std::string seen = std::isfinite(bias.sigma_rad) && degrees(bias.sigma_rad) < 90.0
                               ? fmt::format("shows from {:.1f} deg on", 3.3 * degrees(bias.sigma_rad))
                               : "does not show at all";
  return fmt::format(
      "a constant error of the bearings {} here; one degree moves the range by {:+.0f} m, the course by {:+.1f} deg, "
      "the speed by {:+.2f} m/s\n",
      seen, would_be.range_m - is.range_m, std::remainder(would_be.course_deg - is.course_deg, 360.0),
      would_be.speed_mps - is.speed_mps);
}

std::string residual_lines(const TmaAnswer& answer) {
  const ResidualChecks& checks = answer.residuals;
  return fmt::format("\nresiduals: chi-square {:.1f} for {} degrees of freedom, {}; {}\n", checks.chi_square,
                     checks.degrees_of_freedom, size_of_the_residuals(checks), whiteness(checks)) +
         outlier_lines(answer) + manoeuvre_lines(answer) + bias_lines(answer);
}

std::string cause_lines(const TmaAnswer& answer) {
  if (answer.causes.empty()) return {};
  std::string text = "\nwhat is wrong, the likeliest first:\n";
  for (const TmaCause& cause : answer.causes) text += "  - " + cause.says + "\n";
  return text;
}

std::string open_range_lines(const TmaAnswer& answer) {
  if (answer.range_is_known()) return {};
  if (!answer.observability) return "\nNOTHING CAN BE SAID OF THE RANGE: no numbers come out of these bearings.\n";
  const Observability& geometry = *answer.observability;
  std::string text = answer.source && answer.source->used
                         ? "\nTHE BEARINGS AND FREQUENCIES DO NOT DETERMINE THE RANGE: "
                         : "\nTHE BEARINGS DO NOT DETERMINE THE RANGE: ";
  if (geometry.log_range_sigma > 10.0)
    text += "own ship has not manoeuvred in a way that shows.\n";
  else
    text += fmt::format(
        "a target infinitely far away explains them nearly as well (likelihood ratio {:.1f}, {:.1f} needed).\n",
        std::max(geometry.against_infinity, 0.0), Observability::kRuledOut);
  if (answer.has_prior) text += "The answer above is what was believed beforehand as much as what was measured.\n";
  text += fmt::format(
      "They fit a target at any range on that bearing; the course and speed that fit best at some of them:\n"
      "{:>12}{:>14}{:>12}\n",
      "range m", "course deg", "speed m/s");
  for (const Eigen::Vector4d& x : answer.hypotheses) {
    const Motion motion(x, answer.own_ship);
    text += fmt::format("{:>12.0f}{:>14.1f}{:>12.2f}\n", motion.range_m, motion.course_deg, motion.speed_mps);
  }
  return text + "A manoeuvre of own ship across the line of sight will tell.\n";
}

std::string ambiguity_lines(const TmaAnswer& answer) {
  std::string text;
  if (!answer.range_is_known()) return text;  // every range is possible, as has been said
  for (const Ambiguity& other : answer.ambiguities) {
    const Motion motion(other.x, answer.own_ship);
    text +=
        fmt::format("also possible: range {:.0f} m, course {:.1f} deg, speed {:.2f} m/s (likelihood ratio {:.1f})\n",
                    motion.range_m, motion.course_deg, motion.speed_mps, 2.0 * other.cost);
  }
  return text;
}

}  // namespace

std::string tma_text(const TmaAnswer& answer) {
  std::string text =
      fmt::format("{}\n{}: {} bearings from {} to {} s, {} missing; ", verdict(answer), answer.log, answer.bearings,
                  seconds(answer.from_s), seconds(answer.estimate.time_s), answer.missing);
  if (answer.source)
    text += fmt::format("{} frequencies, {} missing; ", answer.source->frequencies, answer.missing_frequencies);
  text += fmt::format("method {}\n\n", answer.method);
  return text + motion_table(answer) + open_range_lines(answer) + ambiguity_lines(answer) + source_lines(answer) +
         residual_lines(answer) + cause_lines(answer);
}

}  // namespace truebearing
