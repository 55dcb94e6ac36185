// What `truebearing tma` answers: the target's range, course and speed with their uncertainty, what the residuals say,
// and what the geometry leaves open. As text and as JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "truebearing/tma/bearings_only_batch.hpp"
#include "truebearing/tma/residual_checks.hpp"
#include "truebearing/measurement/measurement.hpp"

namespace truebearing {

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

  std::vector<Ambiguity> ambiguities;
  std::vector<Eigen::Vector4d> hypotheses;  ///< where the range is open: the state at each of some ranges
  std::optional<Eigen::Vector4d> truth;     ///< at the last bearing

  /// Do the bearings determine the range?
  bool range_is_known() const { return !observability || observability->observable(); }
};

std::string tma_text(const TmaAnswer& answer);
std::string tma_json(const TmaAnswer& answer);

}  // namespace truebearing
