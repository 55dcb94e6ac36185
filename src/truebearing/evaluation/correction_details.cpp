// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/correction_details.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

namespace truebearing {

CorrectionTally::CorrectionTally(const Correction& correction)
    : model_(correction.shared_model()),
      kappa_(correction.bounds().kappa),
      gate_(correction.gate()),
      bounds_(describe(correction.bounds())),
      features_(model_->design.features.size()) {
  if (const auto* rules = std::get_if<RuleBase>(&model_->network))
    rules_.resize(static_cast<std::size_t>(rules->network.rules()));
}

void CorrectionTally::take(std::size_t step, std::span<const StepRecord> records,
                           std::span<const CorrectionAccount> accounts) {
  if (steps_.size() <= step) steps_.resize(step + 1);
  Step& sums = steps_[step];
  for (std::size_t i = 0; i < std::min(records.size(), accounts.size()); ++i) {
    if (!records[i].correction) continue;
    const CorrectionOutcome& outcome = *records[i].correction;
    sums.corrected += 1.0;
    sums.gate += outcome.gate;
    sums.limited += outcome.limited ? 1.0 : 0.0;
    sums.handed_over += outcome.handed_over;
    const CorrectionAccount& account = accounts[i];
    if (!account.asked()) continue;
    sums.asked += 1.0;
    sums.box += account.box;
    sums.referee += 0.5 * (account.referee.position + account.referee.velocity);
    if (std::isfinite(account.wanted_sigmas) && std::isfinite(outcome.distance_sigmas)) {
      sums.measured += 1.0;
      sums.wanted += account.wanted_sigmas;
      sums.moved += outcome.distance_sigmas;
    }
    take_features(account);
    take_rules(account);
  }
}

void CorrectionTally::take_features(const CorrectionAccount& account) {
  for (std::size_t i = 0; i < features_.size(); ++i) {
    const auto place = static_cast<Eigen::Index>(i);
    const double value = account.features[place];
    Feature& feature = features_[i];
    feature.sum += value;
    feature.squares += value * value;
    feature.least = std::min(feature.least, value);
    feature.greatest = std::max(feature.greatest, value);
    const auto& box = model_->gate;
    if (box && (value < box->low[place] || value > box->high[place])) feature.outside += 1.0;
    const InputScale standard = input_scale(model_->network, place);
    const double share = 0.5 + 0.5 * (value - standard.mean) / (standard.scale * standard.clip);
    constexpr auto kLast = static_cast<double>(CorrectionDetails::kBins) - 1.0;
    feature.counted[static_cast<std::size_t>(std::clamp(std::floor((kLast + 1.0) * share), 0.0, kLast))] += 1.0;
  }
  if (!gate_) return;
  if (gate_->intervals.excess(account.intervals) > 0.0) outside_intervals_ += 1.0;
  if (!(account.disagreement <= gate_->largest_disagreement)) outside_disagreement_ += 1.0;
}

void CorrectionTally::take_rules(const CorrectionAccount& account) {
  if (rules_.empty()) return;
  FuzzyNetwork::Strengths phi;
  model_->rules().network.strengths(account.features, phi);
  Eigen::Index strongest = 0;
  phi.maxCoeff(&strongest);
  rules_[static_cast<std::size_t>(strongest)].strongest += 1.0;
  for (std::size_t rule = 0; rule < rules_.size(); ++rule) rules_[rule].fired += phi[static_cast<Eigen::Index>(rule)];
}

void CorrectionTally::add(const CorrectionTally& run) {
  if (steps_.size() < run.steps_.size()) steps_.resize(run.steps_.size());
  for (std::size_t i = 0; i < run.steps_.size(); ++i)
    for (const auto member : kSums) steps_[i].*member += run.steps_[i].*member;
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    rules_[i].fired += run.rules_[i].fired;
    rules_[i].strongest += run.rules_[i].strongest;
  }
  for (std::size_t i = 0; i < features_.size(); ++i) {
    Feature& feature = features_[i];
    const Feature& more = run.features_[i];
    feature.sum += more.sum;
    feature.squares += more.squares;
    feature.least = std::min(feature.least, more.least);
    feature.greatest = std::max(feature.greatest, more.greatest);
    feature.outside += more.outside;
    for (std::size_t bin = 0; bin < feature.counted.size(); ++bin) feature.counted[bin] += more.counted[bin];
  }
  outside_intervals_ += run.outside_intervals_;
  outside_disagreement_ += run.outside_disagreement_;
}

void CorrectionTally::exchange(TallyStream& stream) {
  stream.list(steps_, [&](Step& step) {
    for (const auto member : kSums) stream.sum(step.*member);
  });
  for (CorrectionDetails::Rule& rule : rules_) {
    stream.sum(rule.fired);
    stream.sum(rule.strongest);
  }
  for (Feature& feature : features_) {
    stream.sum(feature.sum);
    stream.sum(feature.squares);
    stream.least(feature.least);
    stream.greatest(feature.greatest);
    stream.sum(feature.outside);
    for (double& bin : feature.counted) stream.sum(bin);
  }
  stream.sum(outside_intervals_);
  stream.sum(outside_disagreement_);
}

CorrectionDetails CorrectionTally::details() const {
  CorrectionDetails details;
  details.model = model_;
  details.kappa = kappa_;
  details.bounds = bounds_;
  const auto mean = [](double sum, double count) { return count > 0.0 ? sum / count : kNaN; };
  for (const Step& step : steps_) {
    details.steps += step.corrected;
    details.asked += step.asked;
    details.gate.push_back(mean(step.gate, step.corrected));
    details.box.push_back(mean(step.box, step.asked));
    details.referee.push_back(mean(step.referee, step.asked));
    details.limited.push_back(mean(step.limited, step.corrected));
    details.handed_over.push_back(mean(step.handed_over, step.corrected));
    details.wanted_sigmas.push_back(mean(step.wanted, step.measured));
    details.moved_sigmas.push_back(mean(step.moved, step.measured));
  }
  const double n = details.asked;
  for (const CorrectionDetails::Rule& rule : rules_)
    details.rules.push_back({mean(rule.fired, n), mean(rule.strongest, n)});
  for (const Feature& feature : features_) {
    CorrectionDetails::Feature& told = details.features.emplace_back();
    told.counted = feature.counted;
    if (n == 0.0) continue;
    told.mean = feature.sum / n;
    told.deviation = std::sqrt(std::max(0.0, feature.squares / n - told.mean * told.mean));
    told.least = feature.least;
    told.greatest = feature.greatest;
    told.outside = feature.outside / n;
  }
  details.outside_intervals = mean(outside_intervals_, n);
  details.outside_disagreement = mean(outside_disagreement_, n);
  return details;
}

}  // namespace truebearing
