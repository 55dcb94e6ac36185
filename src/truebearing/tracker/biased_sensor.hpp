// SPDX-License-Identifier: Apache-2.0
// A sensor whose measurements are off by what is known of it: taken off z before anything else looks at it.
#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "truebearing/tracker/any_sensor.hpp"

namespace truebearing {

class BiasedSensor final : public AnySensor {
 public:
  /// bias (m): what it measures too much, in the units of z. Throws std::invalid_argument where it is of another length.
  BiasedSensor(std::unique_ptr<AnySensor> sensor, BoundedVector bias)
      : sensor_(std::move(sensor)), bias_(std::move(bias)) {
    if (bias_.size() != sensor_->size()) throw std::invalid_argument("a bias has as many components as z");
  }

  Measured measured() const override { return sensor_->measured(); }
  int size() const override { return sensor_->size(); }
  int states() const override { return sensor_->states(); }
  bool measures_position() const override { return sensor_->measures_position(); }
  bool tells_position() const override { return sensor_->tells_position(); }
  bool tells_bearing() const override { return sensor_->tells_bearing(); }
  bool has_value(const Measurement& measurement) const override { return sensor_->has_value(measurement); }
  bool heeds_expected() const override { return sensor_->heeds_expected(); }
  const AnyMeasurement& take(const Measurement& measurement, const Prediction& expected) override {
    return sensor_->take(unbiased(measurement), expected);
  }
  std::optional<PositionFix> fix(const Measurement& measurement) const override {
    return sensor_->fix(unbiased(measurement));
  }
  std::optional<Sight> sight(const Measurement& measurement) const override {
    return sensor_->sight(unbiased(measurement));
  }
  std::optional<PriorStart> believe(const GaussianState& plane, const Measurement& measurement) const override {
    return sensor_->believe(plane, unbiased(measurement));
  }
  std::unique_ptr<AnySensor> fresh() const override { return std::make_unique<BiasedSensor>(sensor_->fresh(), bias_); }

 private:
  Measurement unbiased(const Measurement& measurement) const {
    Measurement mended = measurement;
    // What a sensor leaves alone may stand behind what it takes.
    if (mended.z.size() >= bias_.size()) mended.z.head(bias_.size()) -= bias_;
    return mended;
  }

  std::unique_ptr<AnySensor> sensor_;
  BoundedVector bias_;
};

}  // namespace truebearing
