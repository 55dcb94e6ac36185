// SPDX-License-Identifier: Apache-2.0
// What is wrong with an answer of `truebearing tma`, in order of likelihood, and the line that sums it up.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "app/tma_answer.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing {
namespace {

// 2 ln of the likelihood ratio of noise that is so many times as large as it is said to be.
double gain_of_other_noise(double sigmas, double count) {
  const double variance = std::max(sigmas * sigmas, 1e-12);
  return count * (variance - 1.0 - std::log(variance));
}

std::string lines_of(const std::vector<TmaOutlier>& outliers) {
  constexpr std::size_t kMost = 5;
  std::string text = outliers.size() == 1 ? "line " : "lines ";
  for (std::size_t i = 0; i < std::min(kMost, outliers.size()); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : ", ", outliers[i].line);
  return text + (outliers.size() > kMost ? ", ..." : "");
}

std::string says_of_outliers(const TmaAnswer& answer) {
  const std::vector<TmaOutlier>& outliers = answer.outliers;
  const TmaOutlier& worst = *std::max_element(outliers.begin(), outliers.end(), [](const auto& a, const auto& b) {
    return std::abs(a.sigmas) < std::abs(b.sigmas);
  });
  const char* what = outliers.size() == 1 ? "it" : "them";
  const std::string advice = answer.is_robust ? fmt::format("--huber makes little of {}", what)
                                              : fmt::format("leave {} out or try --huber 2", what);
  if (outliers.size() == 1)
    return fmt::format("one bearing is an outlier, {:.0f} sigma off at {} s (line {}{}): {}", std::abs(worst.sigmas),
                       seconds(worst.time_s), worst.line,
                       worst.or_line ? fmt::format(", or else line {}", *worst.or_line) : "", advice);
  return fmt::format("{} bearings are outliers ({}; the worst {:.0f} sigma off at {} s, line {}): {}", outliers.size(),
                     lines_of(outliers), std::abs(worst.sigmas), seconds(worst.time_s), worst.line, advice);
}

// Of bearings and of frequencies, where what they claim is not what the residuals are.
void add_other_noise(const TmaAnswer& answer, std::vector<TmaCause>& causes) {
  constexpr double kSigmas = 3.3;  // of the standard deviation of a root mean square, sqrt(1 / 2n)
  const ResidualChecks& checks = answer.residuals;
  const auto add = [&](const char* what, const char* option, double sigmas, double count, double claimed,
                       const char* unit) {
    if (!std::isfinite(sigmas) || count < 1.0) return;
    const double off = (sigmas - 1.0) * std::sqrt(2.0 * count);
    const bool larger = checks.rest.too_large && off > kSigmas;
    const bool smaller = off < -kSigmas && (sigmas < 0.5 || checks.rest.too_small);
    if (!larger && !smaller) return;
    const std::string fitting =
        sigmas * claimed > 1e-9 * claimed
            ? fmt::format("{} {:.3g} {} would fit, {:.3g} was said", option, sigmas * claimed, unit, claimed)
            : "there is none";
    const char* why = larger ? "is the standard deviation or a unit wrong, or the noise not white?"
                             : "is the standard deviation or a unit wrong, are rows repeated or smoothed, is the "
                               "sensor stuck?";
    causes.push_back({larger ? "noise_larger" : "noise_smaller", gain_of_other_noise(sigmas, count) - std::log(count),
                      fmt::format("the noise of the {} is {} than it is said to be: {}; {}", what,
                                  larger ? "larger" : "smaller", fitting, why)});
  };
  add("bearings", "--sigma", checks.bearing_sigmas, static_cast<double>(answer.bearings - answer.outliers.size()),
      degrees(answer.bearing_sigma_rad), "deg");
  if (answer.source && answer.source->used)
    add("frequencies", "--frequency-sigma", checks.frequency_sigmas, static_cast<double>(answer.source->frequencies),
        answer.frequency_sigma_hz, "Hz");
}

double of_unknowns(const ResidualChecks& checks, double unknowns) {
  return unknowns * std::log(std::max(static_cast<double>(checks.degrees_of_freedom), 2.0));
}

// About the least squares of the bearings that are no outliers, and of these too.
double sum_of_squares(const TmaAnswer& answer) {
  double sum = 2.0 * answer.residuals.least_squares.cost;
  for (const TmaOutlier& outlier : answer.outliers) sum += outlier.sigmas * outlier.sigmas;
  return sum;
}

// Which bearing is of which contact is unknown too: 2 ln of how many ways there are to part them.
double of_parting(const TmaAnswer& answer) {
  const std::size_t *count = answer.two_contacts->count, both = count[0] + count[1];
  double sum = 0.0;
  for (const double part : {static_cast<double>(count[0]), static_cast<double>(count[1])})
    sum += 2.0 * part * std::log(static_cast<double>(both) / part);
  return sum;
}

double likelihood_of_two(const TmaAnswer& answer) {
  return sum_of_squares(answer) - 2.0 * answer.two_contacts->cost - of_unknowns(answer.residuals, 4.0) -
         of_parting(answer);
}

// What leaves residuals as they should be says that the noise is as it is said to be.
bool fits_at_the_stated_sigma(const TmaAnswer& answer) {
  const BearingBias& bias = answer.residuals.bias;
  return (answer.two_contacts && likelihood_of_two(answer) > 0.0) || answer.reversed ||
         (bias.detected && SumOfSquares(2.0 * bias.estimate.cost, answer.residuals.rest.degrees_of_freedom - 1).fits());
}

double likelihood_of_change(const ResidualChecks& checks) {
  return checks.manoeuvre - of_unknowns(checks, 3.0);
}

double likelihood_of_bias(const ResidualChecks& checks) {
  return checks.bias.gain - of_unknowns(checks, 1.0);
}

// A manoeuvre bends the bearings as an error that is constant would, but that explains it far worse.
bool bias_is_likely(const ResidualChecks& checks) {
  constexpr double kFarWorse = 10.0;
  if (!checks.bias.detected) return false;
  return !checks.change || likelihood_of_bias(checks) > likelihood_of_change(checks) - kFarWorse;
}

TmaCause bearing_bias(const TmaAnswer& answer) {
  const BearingBias& bias = answer.residuals.bias;
  std::string says =
      fmt::format("all bearings seem to be {:+.1f} +- {:.1f} deg off", degrees(bias.bias_rad), degrees(bias.sigma_rad));
  if (answer.range_is_known())
    says += ": without that " + motion_with_sigmas(bias.estimate.x, bias.estimate.P, answer.own_ship);
  return {"bearing_bias", likelihood_of_bias(answer.residuals), says};
}

std::string motion_or_not(const TmaAnswer& answer) {
  if (!answer.range_is_known()) {
    const char* what = answer.source && answer.source->used ? "bearings and frequencies" : "bearings";
    if (!answer.has_motion()) return fmt::format("RANGE NOT KNOWN: the {} do not determine it", what);
    return fmt::format("RANGE NOT KNOWN from the {}: the answer is what was believed beforehand as much", what);
  }
  return motion_with_sigmas(answer.estimate.x, answer.estimate.P, answer.own_ship);
}

}  // namespace

void find_causes(TmaAnswer& answer) {
  const ResidualChecks& checks = answer.residuals;
  const double count = static_cast<double>(checks.degrees_of_freedom), of_an_unknown = of_unknowns(checks, 1.0);
  std::vector<TmaCause>& causes = answer.causes;
  causes.clear();
  // No other can be likelier than what explains all of them: positions and velocity contradict each other as it is.
  if (!answer.own_ship_is_off.empty())
    causes.push_back({"own_ship", sum_of_squares(answer) + count, answer.own_ship_is_off});
  if (!answer.outliers.empty()) {
    double squares = 0.0;
    for (const TmaOutlier& outlier : answer.outliers) squares += outlier.sigmas * outlier.sigmas - of_an_unknown;
    causes.push_back({"outliers", squares, says_of_outliers(answer)});
  }
  if (checks.change)
    causes.push_back({"manoeuvre", likelihood_of_change(checks),
                      fmt::format("the target changed its velocity at about {} s (between {} and {} s)",
                                  seconds(checks.change->time_s), seconds(checks.change->earliest_s),
                                  seconds(checks.change->latest_s))});
  if (answer.two_contacts && likelihood_of_two(answer) > 0.0)
    causes.push_back({"two_contacts", likelihood_of_two(answer),
                      fmt::format("the bearings are of two contacts, {} of one and {} of the other",
                                  answer.two_contacts->count[0], answer.two_contacts->count[1])});
  if (answer.reversed) {
    const Motion motion(answer.reversed->x, answer.own_ship);
    causes.push_back({"back_bearings", sum_of_squares(answer) - 2.0 * answer.reversed->cost - of_an_unknown,
                      fmt::format("all bearings seem to be 180 degrees off (of the other end of an array, or back "
                                  "bearings): turned round they give range {:.0f} m, course {:.1f} deg, speed {:.2f} "
                                  "m/s",
                                  motion.range_m, motion.course_deg, motion.speed_mps)});
  }
  if (bias_is_likely(checks)) causes.push_back(bearing_bias(answer));
  if (!fits_at_the_stated_sigma(answer)) add_other_noise(answer, causes);
  if (!checks.white && causes.empty())
    causes.push_back({"not_white", checks.lag_one * checks.lag_one - of_an_unknown,
                      "the residuals are correlated: the noise is, or the target does not keep one course and speed"});
  constexpr double kNearEnough = 0.5;
  if (!answer.estimate.converged || answer.above_least_squares > kNearEnough) {
    const bool elsewhere = answer.above_least_squares > kNearEnough;
    if (elsewhere || answer.method == "ml" || answer.method == "map")
      causes.push_back(
          {"not_converged", 2.0 * answer.above_least_squares,
           fmt::format("the method did not converge{}: {}",
                       answer.estimate.converged ? "" : fmt::format(" in {} iterations", answer.estimate.iterations),
                       elsewhere ? "the least squares lie elsewhere (try --method ml)" : "its limit ended it")});
  }
  std::stable_sort(causes.begin(), causes.end(),
                   [](const TmaCause& a, const TmaCause& b) { return a.likelihood > b.likelihood; });
}

std::string verdict(const TmaAnswer& answer) {
  const bool allowed_for = answer.is_robust && answer.causes.size() == 1 && answer.causes.front().kind == "outliers";
  if (allowed_for) return motion_or_not(answer) + "; " + answer.causes.front().says;
  if (!answer.causes.empty())
    return fmt::format("NOT TO BE TRUSTED AS IT STANDS: {}; {}", answer.causes.front().says, motion_or_not(answer));
  if (!answer.range_is_known()) return motion_or_not(answer) + "; nothing speaks against one course and speed";
  if (answer.source && !answer.source->changes.empty())
    return motion_or_not(answer) + "; the source changed its frequency, which is allowed for";
  return motion_or_not(answer) + "; one course and speed explains the measurements";
}

}  // namespace truebearing
