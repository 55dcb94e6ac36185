#include "truebearing/simulation/recorded_scenario.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"

namespace truebearing {

RecordedScenario::RecordedScenario(Recording recorded, std::optional<double> sigma)
    : recorded_(std::move(recorded)), sigma_(sigma) {
  if (!recorded_.truth_space || recorded_.truth.size() != 1)
    throw InputError("recording", "has no truth to measure", "a log with truth_ columns");
  for (const std::string& name : recorded_.measured) {
    const int component = recorded_.truth_space->component_index(name);
    if (component < 0)
      throw InputError("recording", "measures \"" + name + "\", which is no component of its truth",
                       suggestion(name, recorded_.truth_space->components));
    components_.push_back(component);
  }
  if (sigma_ && !(*sigma_ > 0.0 && std::isfinite(*sigma_)))
    throw InputError("sigma", "is " + std::to_string(*sigma_), "a number > 0");
  const auto lacks_sigma = [](const Measurement& m) { return !m.is_missing() && m.sigma.size() == 0; };
  if (!sigma_ && std::any_of(recorded_.measurements.begin(), recorded_.measurements.end(), lacks_sigma))
    throw InputError("recording", "carries no sigma for its measurements", "_sigma_ columns, or a sigma beside it");
}

Recording RecordedScenario::simulate(const RunKey& key) const {
  RandomStream stream(key, StreamId::measurement);
  Recording recording = recorded_;
  recording.counts = {};
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    Measurement& measurement = recording.measurements[k];
    for (Eigen::Index i = 0; i < measurement.z.size(); ++i) {
      const double noise = stream.normal();  // drawn for missing values too: the noise of step k depends on k alone
      if (std::isnan(measurement.z(i))) continue;
      const double sigma = measurement.sigma.size() > 0 ? measurement.sigma(i) : sigma_.value_or(0.0);
      measurement.z(i) = recording.truth[0].x[k](components_[static_cast<std::size_t>(i)]) + sigma * noise;
    }
    recording.counts.missing += measurement.is_missing();
  }
  return recording;
}

}  // namespace truebearing
