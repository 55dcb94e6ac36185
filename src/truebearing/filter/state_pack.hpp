// SPDX-License-Identifier: Apache-2.0
// StatePack: the estimates of several targets, or of one target in several Monte Carlo runs, side by side, each in a lane
// of a register, where one filter or multiple model (tracked_state.hpp) of a kind follows all of them. A lane comes to
// what its own state would, to the last bit. What is out of the ordinary in a lane is left to its own state: the pack
// says of which lanes it is certain.
#pragma once

#include <memory>
#include <utility>

#include "truebearing/filter/any_measurement.hpp"
#include "truebearing/filter/lane_mask.hpp"
#include "truebearing/filter/tracked_state.hpp"

namespace truebearing {

class StatePack {
 public:
  virtual ~StatePack() = default;

  /// -1 where every lane holds something.
  virtual int free_lane() const = 0;
  /// The lane, which is free, holds what `state` does, which was made by fresh() from the one that the pack is of, or is
  /// that.
  virtual void enter(int lane, const TrackedState& state) = 0;
  /// `state` becomes what the lane holds, without what was done since the last keep(). The lane is free.
  virtual void leave(int lane, TrackedState& state) = 0;
  /// The lane is free.
  virtual void drop(int lane) = 0;

  /// What those lanes are dt_s[lane] > 0 later. Gives those of which it is certain; nothing is said of another.
  virtual LaneMask predict(LaneMask lanes, const double* dt_s) = 0;
  /// What they are, so predicted, with a measurement each. Likewise.
  virtual LaneMask update(LaneMask lanes, const AnyMeasurement* const* measurements) = 0;
  /// That is what those lanes hold from now on; others hold what they held.
  virtual void keep(LaneMask lanes) = 0;

  // Of what was predicted or updated, whichever came last, before keep(); of lanes of which that was certain.
  /// Those of the lanes of which x and P are finite, the first `positions` components of x at most `farthest` from zero,
  /// and their variances at most its square.
  virtual LaneMask within(LaneMask lanes, int positions, double farthest) const = 0;
  /// x (n), P (n x n, by columns).
  virtual void estimate(int lane, double* x, double* P) const = 0;
  /// What TrackedState::update() leaves behind.
  virtual void update_of(int lane, const StateUpdateTarget& update) const = 0;
  /// mu (r) of a multiple model; empty otherwise.
  virtual void mode_probabilities(int lane, ModeVector& mu) const = 0;

 protected:
  StatePack() = default;
  StatePack(const StatePack&) = delete;
  StatePack& operator=(const StatePack&) = delete;
};

/// The lane of a pack that holds a state, free again when this ends.
class PlaceInPack {
 public:
  PlaceInPack() = default;
  PlaceInPack(std::shared_ptr<StatePack> pack, int lane) : pack_(std::move(pack)), lane_(lane) {}
  PlaceInPack(PlaceInPack&& other) noexcept : pack_(std::move(other.pack_)), lane_(other.lane_) {}
  PlaceInPack& operator=(PlaceInPack&& other) noexcept {
    pack_.swap(other.pack_);
    std::swap(lane_, other.lane_);
    return *this;
  }
  ~PlaceInPack() { drop(); }

  explicit operator bool() const { return pack_ != nullptr; }
  bool is_in(const std::shared_ptr<StatePack>& pack) const { return pack_ == pack; }
  int lane() const { return lane_; }
  /// See StatePack::leave() and drop(); it is no place any more.
  void leave(TrackedState& state) {
    pack_->leave(lane_, state);
    pack_.reset();
  }
  void drop() {
    if (pack_) pack_->drop(lane_);
    pack_.reset();
  }

 private:
  std::shared_ptr<StatePack> pack_;
  int lane_ = 0;
};

/// A pack for states as that one is: Kalman filters in Joseph's form of 2, 4 or 6 states, extended ones too, and multiple
/// models of them. Nothing for others, and on processors whose registers are not known to be long enough for it to
/// be of use.
std::unique_ptr<StatePack> pack_of(const TrackedState& state);

}  // namespace truebearing
