// SPDX-License-Identifier: Apache-2.0
#include "app/tma_answer.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/linear_algebra.hpp"
#include "truebearing/evaluation/target_motion.hpp"
#include "truebearing/io/json_file.hpp"

namespace truebearing {
namespace {

double compass_deg(double angle_rad) {
  const double angle_deg = std::fmod(degrees(angle_rad), 360.0);
  return angle_deg < 0.0 ? angle_deg + 360.0 : angle_deg;
}

// With so many decimals, or where its standard deviation is smaller than they show with two figures of that.
std::string figure(double value, double sigma, int decimals) {
  if (!std::isfinite(value)) return "unknown";
  if (sigma > 0.0 && sigma < std::pow(10.0, -decimals))
    decimals = std::min(1 - static_cast<int>(std::floor(std::log10(sigma))), 12);
  return fmt::format("{:.{}f}", value, decimals);
}

}  // namespace

Motion::Motion(const Eigen::Vector4d& x, const SensorState& own_ship) {
  const Eigen::Vector2d offset_m = x.head<2>() - own_ship.position_m;
  range_m = offset_m.norm();
  bearing_deg = compass_deg(std::atan2(offset_m.x(), offset_m.y()));
  course_deg = compass_deg(std::atan2(x(2), x(3)));
  speed_mps = x.tail<2>().norm();
}

MotionSigmas::MotionSigmas(const Eigen::Vector4d& x, const Eigen::Matrix4d& P, const SensorState& own_ship) {
  const TargetMotionVariance variance = target_motion_variance(x, P, own_ship);
  const Eigen::Vector2d offset_m = x.head<2>() - own_ship.position_m;
  const Eigen::Vector2d across = Eigen::Vector2d(offset_m.y(), -offset_m.x()) / offset_m.squaredNorm();
  range_m = std::sqrt(variance.range_percent2) / 100.0 * offset_m.norm();
  bearing_deg = degrees(std::sqrt(across.dot(P.topLeftCorner<2, 2>() * across)));
  course_deg = std::sqrt(variance.course_deg2);
  speed_mps = std::sqrt(variance.speed_m2ps2);
}

std::string motion_with_sigmas(const Eigen::Vector4d& x, const Eigen::Matrix4d& P, const SensorState& own_ship) {
  const Motion motion(x, own_ship);
  const MotionSigmas sigma(x, P, own_ship);
  return fmt::format("range {} +- {} m, course {:.1f} +- {:.1f} deg, speed {} +- {} m/s",
                     figure(motion.range_m, sigma.range_m, 0), figure(sigma.range_m, sigma.range_m, 0),
                     motion.course_deg, sigma.course_deg, figure(motion.speed_mps, sigma.speed_mps, 2),
                     figure(sigma.speed_mps, sigma.speed_mps, 2));
}

std::string seconds(double time_s) {
  return fmt::format("{:.12g}", time_s);
}

namespace {

using Json = nlohmann::ordered_json;

Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// The 95 % ellipse of the position.
struct Ellipse {
  double semi_major_m, semi_minor_m, orientation_deg;  // of the major axis, from North, in [0, 180)

  explicit Ellipse(const Eigen::Matrix4d& P) {
    const SymmetricModes<2> modes = symmetric_modes<2>(P.topLeftCorner<2, 2>());
    const double scale = std::sqrt(chi_square_quantile(0.95, 2.0));
    semi_minor_m = scale * std::sqrt(std::max(modes.values[0], 0.0));
    semi_major_m = scale * std::sqrt(std::max(modes.values[1], 0.0));
    const Eigen::Vector2d axis = modes.vectors.col(1);
    orientation_deg = std::fmod(compass_deg(std::atan2(axis.x(), axis.y())), 180.0);
  }
};

std::string row(const char* name, int decimals, double value, double sigma, const std::optional<double>& truth,
                bool known) {
  return fmt::format("{:<14}{:>16}{:>14}{:>14}\n", name, known ? figure(value, sigma, decimals) : "not determined",
                     known ? figure(sigma, sigma, decimals) : "", truth ? figure(*truth, sigma, decimals) : "");
}

std::optional<double> true_frequency(const TmaAnswer& answer) {
  if (!answer.truth || answer.truth->size() < 5 || !std::isfinite((*answer.truth)[4])) return std::nullopt;
  return (*answer.truth)[4];
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

Json source_json(const TmaSource& source, int missing) {
  Json json{{"used", source.used},         {"frequencies", source.frequencies}, {"missing", missing},
            {"outliers", source.outliers}, {"levels", Json::array()},           {"changes", Json::array()}};
  for (const TmaSource::Level& level : source.levels)
    json["levels"].push_back({{"from_s", level.from_s},
                              {"to_s", level.to_s},
                              {"frequency_hz", level.frequency_hz},
                              {"standard_deviation_hz", finite(level.sigma_hz)},
                              {"frequencies", level.count}});
  for (const FrequencyChange& change : source.changes)
    json["changes"].push_back({{"time_s", change.time_s}, {"frequency_hz", change.frequency_hz}});
  return json;
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

// A range that is known to a half of itself.
bool is_known(const VelocityChange& change, const SensorState& own_ship) {
  constexpr double kLargest = 0.5;
  return MotionSigmas(change.x, change.P, own_ship).range_m < kLargest * Motion(change.x, own_ship).range_m;
}

std::string manoeuvre_lines(const TmaAnswer& answer) {
  const ResidualChecks& checks = answer.residuals;
  if (!checks.change) return "no sign that the target changed its velocity\n";
  const VelocityChange& change = *checks.change;
  std::string text = fmt::format(
      "THE TARGET SEEMS TO HAVE CHANGED ITS VELOCITY at about {} s ({} to {} s; score {:.0f}): one course and speed do "
      "not\nexplain these measurements, and the figures above average over several.\n",
      seconds(change.time_s), seconds(change.earliest_s), seconds(change.latest_s), checks.manoeuvre);
  if (is_known(change, answer.own_ship))
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
    text += fmt::format("{} that do not belong to their neighbours: {}, in ", name, outliers->size());
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

Json bearings_json(const std::vector<TmaBearing>& bearings) {
  Json json;
  for (const char* column : {"time_s", "own_east_m", "own_north_m", "bearing_deg", "residual_sigmas"})
    json[column] = Json::array();
  for (const TmaBearing& bearing : bearings) {
    json["time_s"].push_back(bearing.time_s);
    json["own_east_m"].push_back(bearing.own_ship_m.x());
    json["own_north_m"].push_back(bearing.own_ship_m.y());
    json["bearing_deg"].push_back(bearing.bearing_deg);
    json["residual_sigmas"].push_back(finite(bearing.residual_sigmas));
  }
  return json;
}

Json motion_json(const Eigen::Vector4d& x, const SensorState& own_ship) {
  const Motion motion(x, own_ship);
  return {{"range_m", motion.range_m},
          {"bearing_deg", motion.bearing_deg},
          {"course_deg", motion.course_deg},
          {"speed_mps", motion.speed_mps},
          {"east_m", x[0]},
          {"north_m", x[1]},
          {"east_mps", x[2]},
          {"north_mps", x[3]}};
}

Json outliers_json(const std::vector<TmaOutlier>& outliers) {
  Json json = Json::array();
  for (const TmaOutlier& outlier : outliers)
    json.push_back({{"line", outlier.line}, {"time_s", outlier.time_s}, {"sigmas", finite(outlier.sigmas)}});
  return json;
}

Json residuals_json(const ResidualChecks& checks, const TmaAnswer& answer) {
  Json json{{"chi_square", finite(checks.chi_square)},
            {"degrees_of_freedom", checks.degrees_of_freedom},
            {"fits", checks.fits},
            {"too_small", checks.too_small},
            {"lag_one_sigmas", finite(checks.lag_one)},
            {"white", checks.white}};
  if (!std::isfinite(checks.lag_one)) json["white"] = nullptr;
  json["without_outliers"] = {{"chi_square", finite(checks.rest.chi_square)},
                              {"degrees_of_freedom", checks.rest.degrees_of_freedom},
                              {"fits", checks.rest.fits()}};
  json["bearing_sigma_deg"] = finite(degrees(answer.bearing_sigma_rad));
  json["bearing_sigma_that_fits_deg"] = finite(degrees(answer.bearing_sigma_rad) * checks.bearing_sigmas);
  if (answer.source && answer.source->used) {
    json["frequency_sigma_hz"] = finite(answer.frequency_sigma_hz);
    json["frequency_sigma_that_fits_hz"] = finite(answer.frequency_sigma_hz * checks.frequency_sigmas);
  }
  return json;
}

// Where there was none its time is that of the largest score, which means nothing.
Json manoeuvre_json(const TmaAnswer& answer) {
  const ResidualChecks& checks = answer.residuals;
  Json json{{"detected", checks.manoeuvred}, {"score", finite(checks.manoeuvre)}, {"time_s", checks.manoeuvre_s}};
  if (!checks.change) return json;
  const VelocityChange& change = *checks.change;
  json["earliest_s"] = change.earliest_s;
  json["latest_s"] = change.latest_s;
  json["range_determined"] = is_known(change, answer.own_ship);
  json["estimate"] = is_known(change, answer.own_ship) ? motion_json(change.x, answer.own_ship) : Json(nullptr);
  json["stretches"] = Json::array();
  for (const TmaStretch& stretch : answer.stretches)
    json["stretches"].push_back(
        {{"from_s", stretch.from_s},
         {"to_s", stretch.to_s},
         {"range_determined", stretch.range_is_known},
         {"estimate", stretch.range_is_known ? motion_json(stretch.estimate.x, stretch.own_ship) : Json(nullptr)}});
  return json;
}

Json bias_json(const TmaAnswer& answer) {
  const BearingBias& bias = answer.residuals.bias;
  const bool seen = std::isfinite(bias.sigma_rad);
  return {{"detected", bias.detected},
          {"estimate_deg", seen ? finite(degrees(bias.bias_rad)) : Json(nullptr)},
          {"standard_deviation_deg", finite(degrees(bias.sigma_rad))}};
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

std::string tma_json(const TmaAnswer& answer) {
  const BatchEstimate& estimate = answer.estimate;
  const MotionSigmas sigma(answer.estimate.x, answer.estimate.P, answer.own_ship);
  const Ellipse ellipse(estimate.P);
  const Eigen::Vector4d sigmas = estimate.P.diagonal().cwiseSqrt();
  Json json;
  json["verdict"] = verdict(answer);
  json["causes"] = Json::array();
  for (const TmaCause& cause : answer.causes)
    json["causes"].push_back({{"kind", cause.kind}, {"likelihood", finite(cause.likelihood)}, {"says", cause.says}});
  json["log"] = answer.log;
  json["method"] = answer.method;
  json["bearings"] = answer.bearings;
  json["missing"] = answer.missing;
  json["from_s"] = answer.from_s;
  json["time_s"] = estimate.time_s;
  json["range_determined"] = answer.range_is_known();
  // What nothing is known of is null.
  const auto known = [&](double value) { return answer.has_motion() ? finite(value) : Json(nullptr); };
  json["estimate"] = motion_json(estimate.x, answer.own_ship);
  if (!answer.has_motion())
    for (const auto& [key, value] : json["estimate"].items())
      if (key != "bearing_deg") value = nullptr;
  json["standard_deviation"] = {{"range_m", known(sigma.range_m)},
                                {"bearing_deg", finite(sigma.bearing_deg)},
                                {"course_deg", known(sigma.course_deg)},
                                {"speed_mps", known(sigma.speed_mps)},
                                {"east_m", known(sigmas[0])},
                                {"north_m", known(sigmas[1])},
                                {"east_mps", known(sigmas[2])},
                                {"north_mps", known(sigmas[3])}};
  json["covariance"] = Json::array();
  for (int i = 0; i < 4; ++i) {
    Json covariance_row = Json::array();
    for (int j = 0; j < 4; ++j) covariance_row.push_back(known(estimate.P(i, j)));
    json["covariance"].push_back(covariance_row);
  }
  json["ellipse95"] = {{"semi_major_m", known(ellipse.semi_major_m)},
                       {"semi_minor_m", known(ellipse.semi_minor_m)},
                       {"orientation_deg", known(ellipse.orientation_deg)}};
  if (answer.source) {
    json["source"] = source_json(*answer.source, answer.missing_frequencies);
    if (!answer.source->levels.empty()) {
      json["estimate"]["frequency_hz"] = answer.source->levels.back().frequency_hz;
      json["standard_deviation"]["frequency_hz"] = finite(answer.source->levels.back().sigma_hz);
    }
  }
  if (answer.observability) {
    const Eigen::Vector4d& worst = answer.observability->worst;
    json["observability"] = {{"rank", answer.observability->rank},
                             {"log_range_sigma", finite(answer.observability->log_range_sigma)},
                             {"against_infinity", finite(answer.observability->against_infinity)},
                             {"worst_direction", {worst[0], worst[1], worst[2], worst[3]}}};
  }
  json["residuals"] = residuals_json(answer.residuals, answer);
  json["outliers"] = {{"bearings", outliers_json(answer.outliers)},
                      {"frequencies", outliers_json(answer.frequency_outliers)}};
  json["manoeuvre"] = manoeuvre_json(answer);
  json["bearing_bias"] = bias_json(answer);
  json["solver"] = {{"cost", estimate.cost},
                    {"iterations", estimate.iterations},
                    {"converged", estimate.converged},
                    {"starts", estimate.starts},
                    {"non_finite_starts", estimate.non_finite_starts}};
  json["ambiguities"] = Json::array();
  for (const Ambiguity& other : answer.ambiguities) {
    Json entry = motion_json(other.x, answer.own_ship);
    entry["likelihood_ratio"] = 2.0 * other.cost;
    json["ambiguities"].push_back(entry);
  }
  json["hypotheses"] = Json::array();
  for (const Eigen::Vector4d& x : answer.hypotheses) json["hypotheses"].push_back(motion_json(x, answer.own_ship));
  if (answer.truth) json["truth"] = motion_json(answer.truth->head<4>(), answer.own_ship);
  if (const auto frequency_hz = true_frequency(answer)) json["truth"]["frequency_hz"] = *frequency_hz;
  if (!answer.drawn.empty()) json["details"] = bearings_json(answer.drawn);
  return json_text(json);
}

}  // namespace truebearing
