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

using Json = nlohmann::ordered_json;

double compass_deg(double angle_rad) {
  const double angle_deg = std::fmod(degrees(angle_rad), 360.0);
  return angle_deg < 0.0 ? angle_deg + 360.0 : angle_deg;
}

Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// A state as seen from own ship.
struct Motion {
  double range_m, bearing_deg, course_deg, speed_mps;

  Motion(const Eigen::Vector4d& x, const SensorState& own_ship) {
    const Eigen::Vector2d offset_m = x.head<2>() - own_ship.position_m;
    range_m = offset_m.norm();
    bearing_deg = compass_deg(std::atan2(offset_m.x(), offset_m.y()));
    course_deg = compass_deg(std::atan2(x(2), x(3)));
    speed_mps = x.tail<2>().norm();
  }
};

/// Standard deviations of the same.
struct Sigmas {
  double range_m, bearing_deg, course_deg, speed_mps;

  explicit Sigmas(const TmaAnswer& answer) {
    const Eigen::Vector4d& x = answer.estimate.x;
    const Eigen::Matrix4d& P = answer.estimate.P;
    const TargetMotionVariance variance = target_motion_variance(x, P, answer.own_ship);
    const Eigen::Vector2d offset_m = x.head<2>() - answer.own_ship.position_m;
    const Eigen::Vector2d across = Eigen::Vector2d(offset_m.y(), -offset_m.x()) / offset_m.squaredNorm();
    range_m = std::sqrt(variance.range_percent2) / 100.0 * offset_m.norm();
    bearing_deg = degrees(std::sqrt(across.dot(P.topLeftCorner<2, 2>() * across)));
    course_deg = std::sqrt(variance.course_deg2);
    speed_mps = std::sqrt(variance.speed_m2ps2);
  }
};

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

std::string row(const char* name, const char* format, double value, double sigma, const std::optional<double>& truth,
                bool known) {
  const auto figure = [&](double v) { return fmt::format(fmt::runtime(format), v); };
  return fmt::format("{:<14}{:>16}{:>14}{:>14}\n", name, known ? figure(value) : "not determined",
                     known ? figure(sigma) : "", truth ? figure(*truth) : "");
}

std::optional<double> true_frequency(const TmaAnswer& answer) {
  if (!answer.truth || answer.truth->size() < 5 || !std::isfinite((*answer.truth)[4])) return std::nullopt;
  return (*answer.truth)[4];
}

std::string motion_table(const TmaAnswer& answer) {
  const Motion motion(answer.estimate.x, answer.own_ship);
  const Sigmas sigma(answer);
  std::optional<Motion> truth;
  if (answer.truth) truth.emplace(answer.truth->head<4>(), answer.own_ship);
  const auto of_truth = [&](double Motion::*value) { return truth ? std::optional(*truth.*value) : std::nullopt; };
  const auto coordinate = [&](int i) { return answer.truth ? std::optional((*answer.truth)[i]) : std::nullopt; };
  // A prior answers where the bearings do not, and is said to.
  const bool known = answer.range_is_known() || answer.has_prior;
  const Eigen::Vector4d& x = answer.estimate.x;
  const Eigen::Vector4d sigmas = answer.estimate.P.diagonal().cwiseSqrt();
  std::string text = fmt::format("{:<14}{:>16}{:>14}{:>14}\n", fmt::format("at {:g} s", answer.estimate.time_s),
                                 "estimate", "std. dev.", answer.truth ? "truth" : "");
  text += row("bearing deg", "{:.2f}", motion.bearing_deg, sigma.bearing_deg, of_truth(&Motion::bearing_deg), true);
  text += row("range m", "{:.0f}", motion.range_m, sigma.range_m, of_truth(&Motion::range_m), known);
  text += row("course deg", "{:.1f}", motion.course_deg, sigma.course_deg, of_truth(&Motion::course_deg), known);
  text += row("speed m/s", "{:.2f}", motion.speed_mps, sigma.speed_mps, of_truth(&Motion::speed_mps), known);
  text += row("East m", "{:.0f}", x[0], sigmas[0], coordinate(0), known);
  text += row("North m", "{:.0f}", x[1], sigmas[1], coordinate(1), known);
  if (answer.source && !answer.source->levels.empty()) {
    const TmaSource::Level& last = answer.source->levels.back();
    text += row("source Hz", "{:.3f}", last.frequency_hz, last.sigma_hz, true_frequency(answer), true);
  }
  if (!known) return text;
  const Ellipse ellipse(answer.estimate.P);
  return text + fmt::format("95 % ellipse: semi-axes {:.0f} m and {:.0f} m, the longer towards {:.0f} deg\n",
                            ellipse.semi_major_m, ellipse.semi_minor_m, ellipse.orientation_deg);
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
    text += fmt::format("{} at {:g} s, to {:.3f} Hz\n",
                        i == 0 ? "THE SOURCE CHANGED ITS FREQUENCY" : "                       and again",
                        source.changes[i].time_s, source.changes[i].frequency_hz);
  if (!source.looked_for)
    text += "one frequency of the source is taken for granted\n";
  else if (source.changes.empty())
    text += "no sign that the source changed its frequency\n";
  text += manoeuvre_instead(source);
  if (!source.used) text += "Because of that the frequencies were left out: the answer is from the bearings alone.\n";
  text += fmt::format("{:>10}{:>10}{:>14}{:>14}{:>14}\n", "from s", "to s", "source Hz", "std. dev.", "frequencies");
  for (const TmaSource::Level& level : source.levels)
    text += fmt::format("{:>10g}{:>10g}{:>14.3f}{:>14.4f}{:>14}\n", level.from_s, level.to_s, level.frequency_hz,
                        level.sigma_hz, level.count);
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

std::string residual_lines(const TmaAnswer& answer) {
  const ResidualChecks& checks = answer.residuals;
  std::string text = fmt::format(
      "\nresiduals: chi-square {:.1f} for {} degrees of freedom, {}; correlation at lag one {:+.1f} standard "
      "deviations, {}\n",
      checks.chi_square, checks.degrees_of_freedom, checks.fits ? "as it should be" : "LARGER THAN THE NOISE ALLOWS",
      checks.lag_one, checks.white ? "white" : "NOT WHITE");
  if (checks.manoeuvred)
    text += fmt::format(
        "THE TARGET SEEMS TO HAVE CHANGED ITS VELOCITY at about {:g} s (score {:.0f}): one course and speed do not\n"
        "explain these measurements, and the figures above average over several. Try --from {:g}.\n",
        checks.manoeuvre_s, checks.manoeuvre, checks.manoeuvre_s);
  else
    text += "no sign that the target changed its velocity\n";
  return text;
}

std::string open_range_lines(const TmaAnswer& answer) {
  if (answer.range_is_known()) return {};
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

}  // namespace

std::string tma_text(const TmaAnswer& answer) {
  std::string text = fmt::format("{}: {} bearings from {:g} to {:g} s, {} missing; ", answer.log, answer.bearings,
                                 answer.from_s, answer.estimate.time_s, answer.missing);
  if (answer.source)
    text += fmt::format("{} frequencies, {} missing; ", answer.source->frequencies, answer.missing_frequencies);
  text += fmt::format("method {}\n\n", answer.method);
  return text + motion_table(answer) + open_range_lines(answer) + ambiguity_lines(answer) + source_lines(answer) +
         residual_lines(answer);
}

std::string tma_json(const TmaAnswer& answer) {
  const BatchEstimate& estimate = answer.estimate;
  const Sigmas sigma(answer);
  const Ellipse ellipse(estimate.P);
  const Eigen::Vector4d sigmas = estimate.P.diagonal().cwiseSqrt();
  Json json;
  json["log"] = answer.log;
  json["method"] = answer.method;
  json["bearings"] = answer.bearings;
  json["missing"] = answer.missing;
  json["from_s"] = answer.from_s;
  json["time_s"] = estimate.time_s;
  json["range_determined"] = answer.range_is_known();
  json["estimate"] = motion_json(estimate.x, answer.own_ship);
  json["standard_deviation"] = {{"range_m", finite(sigma.range_m)},
                                {"bearing_deg", finite(sigma.bearing_deg)},
                                {"course_deg", finite(sigma.course_deg)},
                                {"speed_mps", finite(sigma.speed_mps)},
                                {"east_m", finite(sigmas[0])},
                                {"north_m", finite(sigmas[1])},
                                {"east_mps", finite(sigmas[2])},
                                {"north_mps", finite(sigmas[3])}};
  json["covariance"] = Json::array();
  for (int i = 0; i < 4; ++i) {
    Json covariance_row = Json::array();
    for (int j = 0; j < 4; ++j) covariance_row.push_back(finite(estimate.P(i, j)));
    json["covariance"].push_back(covariance_row);
  }
  json["ellipse95"] = {{"semi_major_m", finite(ellipse.semi_major_m)},
                       {"semi_minor_m", finite(ellipse.semi_minor_m)},
                       {"orientation_deg", finite(ellipse.orientation_deg)}};
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
  json["residuals"] = {{"chi_square", answer.residuals.chi_square},
                       {"degrees_of_freedom", answer.residuals.degrees_of_freedom},
                       {"fits", answer.residuals.fits},
                       {"lag_one_sigmas", answer.residuals.lag_one},
                       {"white", answer.residuals.white}};
  json["manoeuvre"] = {{"detected", answer.residuals.manoeuvred},
                       {"score", answer.residuals.manoeuvre},
                       {"time_s", answer.residuals.manoeuvre_s}};
  json["solver"] = {{"cost", estimate.cost},
                    {"iterations", estimate.iterations},
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
  return json_text(json);
}

}  // namespace truebearing
