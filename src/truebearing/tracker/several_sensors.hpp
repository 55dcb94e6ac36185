// SPDX-License-Identifier: Apache-2.0
// Several sensors that take turns, as one that a tracker reads: each measurement says by Measurement::source whose it is.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "truebearing/tracker/any_sensor.hpp"

namespace truebearing {

class SeveralSensors final : public AnySensor {
 public:
  struct Part {
    std::string name;
    std::unique_ptr<AnySensor> sensor;
    bool used = true;  ///< else its measurements are nothing to this tracker
  };

  /// In the order of Measurement::source. Throws std::invalid_argument where none is used.
  explicit SeveralSensors(std::vector<Part> parts);

  Measured measured() const override;
  int size() const override;    ///< of the longest z
  int states() const override;  ///< of the model that looks at most
  bool measures_position() const override;
  bool tells_position() const override;
  bool tells_bearing() const override;
  bool has_value(const Measurement& measurement) const override;
  bool heeds_expected() const override;
  const AnyMeasurement& take(const Measurement& measurement, const Prediction& expected) override;
  std::optional<PositionFix> fix(const Measurement& measurement) const override;
  std::optional<Sight> sight(const Measurement& measurement) const override;
  std::optional<PriorStart> believe(const GaussianState& plane, const Measurement& measurement) const override;
  std::unique_ptr<AnySensor> fresh() const override;

 private:
  /// nullptr where the measurement is of none that is used.
  AnySensor* whose(const Measurement& measurement) const;

  std::vector<Part> parts_;
};

}  // namespace truebearing
