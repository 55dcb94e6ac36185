#include "truebearing/evaluation/run_score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truebearing/core/covariance.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

constexpr double kNotScored = std::numeric_limits<double>::quiet_NaN();

void check_target_motion(const Recording& recording) {
  const auto has_sensor = [](const Measurement& measurement) { return measurement.sensor.has_value(); };
  if (!recording.truth_space || !begins_in_plane(*recording.truth_space) ||
      std::none_of(recording.measurements.begin(), recording.measurements.end(), has_sensor))
    throw InputError("scoring.target_motion", "has no own ship to be relative to, or no truth in the plane",
                     "measurements with own-ship columns");
}

}  // namespace

Scorer::Scorer(const StateSpace& truth, const StateSpace& estimate) : truth_(&truth) {
  std::vector<int> place_of(truth.components.size(), -1);
  for (int i = 0; i < truth.size(); ++i) {
    const int in_estimate = estimate.component_index(truth.components[static_cast<std::size_t>(i)]);
    if (in_estimate < 0) continue;
    place_of[static_cast<std::size_t>(i)] = static_cast<int>(truth_index_.size());
    truth_index_.push_back(i);
    estimate_index_.push_back(in_estimate);
  }
  for (const Quantity& quantity : truth.quantities) {
    std::vector<int> places;
    for (const int index : quantity.indices)
      if (place_of[static_cast<std::size_t>(index)] >= 0) places.push_back(place_of[static_cast<std::size_t>(index)]);
    if (places.size() != quantity.indices.size()) continue;
    quantity_names_.push_back(quantity.name);
    quantities_.push_back(std::move(places));
  }
  if (quantities_.empty())
    throw InputError("scoring", "the truth (" + truth.name + ") and a tracker's state (" + estimate.name +
                                    ") have no quantity in common");
}

void Scorer::prepare(RunScore& score, std::size_t steps) const {
  score.error.assign(quantities_.size(), std::vector<double>(steps, kNotScored));
  score.nees.assign(steps, kNotScored);
  score.quantity_nees.assign(quantities_.size(), std::vector<double>(steps, kNotScored));
}

void Scorer::score_step(const BoundedVector& truth, const StepRecord& record, std::size_t step, RunScore& score) const {
  const int n = dimension();
  BoundedVector d(n);
  BoundedMatrix P(n, n);
  for (int i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    d[i] = truth[truth_index_[row]] - record.x[estimate_index_[row]];
    for (int j = 0; j < n; ++j) P(i, j) = record.P(estimate_index_[row], estimate_index_[static_cast<std::size_t>(j)]);
  }
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    const BoundedVector part = d(quantities_[q]);
    score.error[q][step] = part.norm();
    score.quantity_nees[q][step] = mahalanobis_squared(BoundedMatrix(P(quantities_[q], quantities_[q])), part);
  }
  score.nees[step] = mahalanobis_squared(P, d);
  if (record.correction) {
    ++score.corrected;
    score.gate_sum += record.correction->gate;
    score.gate_limited += record.correction->limited ? 1 : 0;
  }
}

std::vector<RunScore> score_recording(TrackerSet& trackers, const std::vector<Scorer>& scorers,
                                      const Recording& recording, const ScoringRule& rule) {
  if (recording.truth.size() != 1)
    throw InputError("scoring", "the recording has the truth of " + std::to_string(recording.truth.size()) + " targets",
                     "one");
  if (rule.target_motion) check_target_motion(recording);
  const std::vector<BoundedVector>& truth = recording.truth.front().x;
  const std::size_t steps = recording.measurements.size();
  const std::vector<int> time_steps = steps_at(recording, rule.times_s);
  std::vector<RunScore> scores(scorers.size());
  for (std::size_t i = 0; i < scorers.size(); ++i) {
    scorers[i].prepare(scores[i], steps);
    scores[i].phase = recording.truth.front().phase;
    scores[i].turns_at_s = recording.truth.front().turns_at_s;
    for (const int at : time_steps) scores[i].at_times.push_back({.step = at});
  }

  trackers.reset();
  for (std::size_t step = 0; step < steps; ++step) {
    trackers.step(recording.measurements[step]);
    if (static_cast<int>(step) + 1 < rule.from_step) continue;
    for (std::size_t i = 0; i < scorers.size(); ++i) {
      const std::span<const StepRecord> records = trackers.records(static_cast<int>(i));
      if (records.empty()) continue;
      scorers[i].score_step(truth[step], records.front(), step, scores[i]);
      for (TimeScore& at : scores[i].at_times)
        if (at.step == static_cast<int>(step))
          at.take(truth[step], records.front(), recording.measurements[step].sensor, rule.target_motion);
    }
  }
  for (std::size_t i = 0; i < scorers.size(); ++i) {
    const std::span<const TrackEvent> events = trackers.events(static_cast<int>(i));
    scores[i].events.assign(events.begin(), events.end());
  }
  return scores;
}

}  // namespace truebearing
