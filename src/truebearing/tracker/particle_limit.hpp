// SPDX-License-Identifier: Apache-2.0
// The Bayes limit of a family of planar flights, as a tracker: a particle filter that knows how the flights are drawn
// and how they are measured (particle_cloud.hpp). No tracker of that family has a lower RMSE than the mean of the
// posterior, which this approaches as the particles grow in number. What it does not know: where the site stands, that
// the flight begins at the first measurement's true place, the recorder's jitter. It begins with the first
// measurement; the track of a target whose flight is not that of the family, or whose likely particles have all died,
// is begun afresh from the last few measurements.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/tracker/any_sensor.hpp"
#include "truebearing/tracker/flight_modes.hpp"
#include "truebearing/tracker/particle_cloud.hpp"
#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

struct ParticleLimitOptions {
  PlanarFlight flight;
  int particles = 20000;
  std::uint64_t seed = 1;
  double flown_s = 0.0;  ///< at most, before the first measurement
  double flight_s =
      600.0;  ///< a track that is begun afresh may have flown so long, and one that was not seen for longer is
};

class ParticleLimit final : public Tracker {
 public:
  /// The sensor measures positions in the plane, or what is converted to them.
  ParticleLimit(std::unique_ptr<AnySensor> sensor, ParticleLimitOptions options);

  std::span<const StepRecord> step(const Measurement& measurement) override;
  void reset() override;
  std::unique_ptr<Tracker> fresh() const override {
    return std::make_unique<ParticleLimit>(sensor_->fresh(), options_);
  }
  const StateSpace& space() const override { return plane_space(); }
  std::optional<Measured> measures() const override { return sensor_->measured(); }
  RecordBlocks blocks() const override {
    return {.prediction = true,
            .innovation = true,
            .mode_probabilities = true,
            .measures_position = sensor_->measures_position()};
  }
  TrackerCounts counts() const override { return guard_.counts; }

  /// How often likely particles had died out, since reset().
  int fresh_starts() const { return fresh_starts_; }

 private:
  static constexpr std::size_t kRemembered = 6;  // measurements that a fresh start takes

  bool begin(const Measurement& measurement, double flown_s);
  bool use(const Measurement& measurement);
  bool start_afresh();
  void settle();
  bool publish(StepStatus status, const ParticleCloud& cloud);
  std::span<const StepRecord> give_up();

  std::unique_ptr<AnySensor> sensor_;
  ParticleLimitOptions options_;
  FlightModes modes_;
  StreamGuard guard_;
  RandomStream stream_;
  ParticleCloud cloud_;  // at the last used measurement
  ParticleCloud moved_;
  bool begun_ = false;
  double used_time_s_ = 0.0;
  Prediction prediction_;
  std::optional<Innovation> innovation_;
  std::vector<Measurement> remembered_;  // the last that were used
  int fresh_starts_ = 0;
  StepRecord record_;
};

}  // namespace truebearing
