// What `truebearing tma` answers: the target's range, course and speed with their uncertainty, the tone of its source
// where that was measured, what the residuals say, and what the geometry leaves open. As text and as JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "truebearing/measurement/measurement.hpp"
#include "truebearing/tma/frequency_changes.hpp"
#include "truebearing/tma/residual_checks.hpp"

namespace truebearing {

/// What was measured of the source's tone.
struct TmaSource {
  struct Level {
    double from_s, to_s;
    std::size_t count;  ///< of its frequencies
    double frequency_hz, sigma_hz;
  };
  bool used = false;        ///< false where the estimate is from the bearings alone
  bool looked_for = false;  ///< changes of it
  std::size_t frequencies = 0;
  int outliers = 0;
  std::vector<Level> levels;  ///< in order of time; a level may come back
  double sound_mps = kSoundInWater_mps;
  std::vector<FrequencyChange> changes;
};

struct TmaAnswer {
  std::string log;
  std::string method;
  std::size_t bearings = 0;
  int missing = 0;
  double from_s = 0.0;
  SensorState own_ship;  ///< at the last bearing
  BatchEstimate estimate;
  ResidualChecks residuals;
  std::optional<Observability> observability;  ///< of ml and map
  bool has_prior = false;
  int missing_frequencies = 0;
  std::optional<TmaSource> source;  ///< where frequencies were measured

  std::vector<Ambiguity> ambiguities;
  std::vector<Eigen::Vector4d> hypotheses;  ///< where the range is open: the state at each of some ranges
  std::optional<BoundedVector> truth;       ///< at the last bearing; its fifth component is the source's frequency

  /// Do the bearings determine the range?
  bool range_is_known() const { return !observability || observability->observable(); }
};

std::string tma_text(const TmaAnswer& answer);
std::string tma_json(const TmaAnswer& answer);

}  // namespace truebearing
