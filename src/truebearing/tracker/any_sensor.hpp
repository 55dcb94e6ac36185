// SPDX-License-Identifier: Apache-2.0
// AnySensor: how a tracker reads measurements of one kind, chosen by a study at run time. From each it makes z, R and
// the measurement model of the step; and it says what a track may begin with. A sensor is written as a plain struct:
//     Model model(const Measurement&) const     the measurement model of the step
//     Model::Vector value(const Measurement&)   what that model calls z
//     Measured measured() const                 what it takes (measurement/measured.hpp)
//     static constexpr bool kMeasuresPosition   z is the first components of the state
//     Model model(const Measurement&, const Prediction&)   in place of the first, where R depends on where the target is
// and, where it has them, has_value() (a part of z will do), fix() (a position to begin with), sight() and believe() (a
// bearing to begin with). SensorOf makes an AnySensor of it.
#pragma once

#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "truebearing/filter/any_measurement.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/tracker/start.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

/// A bearing and where it was taken from.
struct Sight {
  double bearing_rad;
  double sigma_rad;
  SensorState from;
};

class AnySensor {
 public:
  virtual ~AnySensor() = default;

  virtual Measured measured() const = 0;
  virtual int size() const = 0;    ///< m
  virtual int states() const = 0;  ///< k: the model looks at the first k components of a state
  virtual bool measures_position() const = 0;
  virtual bool tells_position() const = 0;  ///< fix() does
  virtual bool tells_bearing() const = 0;   ///< sight() and believe() do
  /// True where the model can use the measurement, or a part of it.
  virtual bool has_value(const Measurement& measurement) const = 0;
  /// True where take() looks at what is expected.
  virtual bool heeds_expected() const = 0;
  /// z, R and the model of that measurement to a track that expects its target there, valid until the next call. Only of
  /// one that has a value.
  virtual const AnyMeasurement& take(const Measurement& measurement, const Prediction& expected) = 0;
  /// The position that it measures, directly or converted.
  virtual std::optional<PositionFix> fix(const Measurement& measurement) const = 0;
  virtual std::optional<Sight> sight(const Measurement& measurement) const = 0;
  /// What is believed of the plane with all that the measurement lets one believe in; nothing where it does not.
  virtual std::optional<PriorStart> believe(const GaussianState& plane, const Measurement& measurement) const = 0;
  virtual std::unique_ptr<AnySensor> fresh() const = 0;
};

template <typename Sensor>
class SensorOf final : public AnySensor {
  using Model = typename Sensor::Model;

 public:
  explicit SensorOf(Sensor sensor) : sensor_(std::move(sensor)), taken_(Sensor::kMeasuresPosition) {}

  Measured measured() const override { return sensor_.measured(); }
  int size() const override { return Model::kMeasurements; }
  int states() const override { return Model::kStates; }
  bool measures_position() const override { return Sensor::kMeasuresPosition; }
  bool tells_position() const override { return kTellsPosition; }
  bool tells_bearing() const override { return kTellsBearing; }

  bool has_value(const Measurement& measurement) const override {
    if constexpr (requires { sensor_.has_value(measurement); })
      return sensor_.has_value(measurement);
    else
      return !measurement.is_missing() && measurement.z.size() == Model::kMeasurements;
  }
  bool heeds_expected() const override { return kHeedsExpected; }
  const AnyMeasurement& take(const Measurement& measurement, const Prediction& expected) override {
    if constexpr (kHeedsExpected)
      taken_.set(sensor_.model(measurement, expected), sensor_.value(measurement));
    else
      taken_.set(sensor_.model(measurement), sensor_.value(measurement));
    return taken_;
  }

  std::optional<PositionFix> fix(const Measurement& measurement) const override {
    if constexpr (kTellsPosition)
      return sensor_.fix(measurement);
    else
      return std::nullopt;
  }
  std::optional<Sight> sight(const Measurement& measurement) const override {
    if constexpr (kTellsBearing)
      return sensor_.sight(measurement);
    else
      return std::nullopt;
  }
  std::optional<PriorStart> believe(const GaussianState& plane, const Measurement& measurement) const override {
    if constexpr (kTellsBearing)
      return sensor_.believe(plane, measurement);
    else
      return std::nullopt;
  }

  std::unique_ptr<AnySensor> fresh() const override { return std::make_unique<SensorOf>(sensor_); }

 private:
  static constexpr bool kHeedsExpected =
      requires(const Sensor& sensor, const Measurement& m, const Prediction& expected) {
    sensor.model(m, expected);
  };
  static constexpr bool kTellsPosition = requires(const Sensor& sensor, const Measurement& m) { sensor.fix(m); };
  static constexpr bool kTellsBearing = requires(const Sensor& sensor, const Measurement& m) { sensor.sight(m); };

  Sensor sensor_;
  ErasedMeasurement<Model> taken_;
};

template <typename Sensor>
std::unique_ptr<AnySensor> sensor_of(Sensor sensor) {
  return std::make_unique<SensorOf<Sensor>>(std::move(sensor));
}

}  // namespace truebearing
