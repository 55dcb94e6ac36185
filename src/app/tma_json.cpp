// SPDX-License-Identifier: Apache-2.0
// The answer of `truebearing tma` for programs.
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/tma_answer.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/io/json_file.hpp"

namespace truebearing {
namespace {

using Json = nlohmann::ordered_json;

Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
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

Json outliers_json(const std::vector<TmaOutlier>& outliers) {
  Json json = Json::array();
  for (const TmaOutlier& outlier : outliers)
    json.push_back({{"line", outlier.line},
                    {"time_s", outlier.time_s},
                    {"sigmas", finite(outlier.sigmas)},
                    {"or_line", outlier.or_line ? Json(*outlier.or_line) : Json(nullptr)}});
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
  json["range_determined"] = range_is_known(change, answer.own_ship);
  json["estimate"] = range_is_known(change, answer.own_ship) ? motion_json(change.x, answer.own_ship) : Json(nullptr);
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
