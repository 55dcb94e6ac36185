// SPDX-License-Identifier: Apache-2.0
// The filters of a multiple model, one for each mode, as the one thing that its equations are written for. Two hold
// them: SeparateModes whatever they are, each behind its own seam; PackedModes (packed_modes.hpp) those of one kind,
// worked on together.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "truebearing/core/bounded.hpp"
#include "truebearing/filter/any_measurement.hpp"
#include "truebearing/filter/tracked_state.hpp"

namespace truebearing {

class ModeBank {
 public:
  using Modes = std::vector<std::unique_ptr<TrackedState>>;

  virtual ~ModeBank() = default;

  /// Every mode begins with (x, P) of the longest state (n), by columns, or as much of it as its own has.
  virtual void begin(const double* x, const double* P, int n) = 0;
  /// Mode j alone, with (x, P) of as many components as it has.
  virtual void begin_mode(int mode, const double* x, const double* P) = 0;
  /// Mode j begins with the mixture of all by the weights in column j (r x r), then crosses dt_s seconds. False where
  /// one fails: all are as they were.
  virtual bool mix_and_predict(const ModeMatrix& weights, double dt_s) = 0;
  /// What each would come to with the measurement; log_likelihood (r) of its innovation, minus infinity where its
  /// arithmetic failed. Nothing is taken before keep().
  virtual void update(const AnyMeasurement& measurement, ModeVector& log_likelihood) = 0;
  virtual void keep() = 0;
  /// Of the last update(): nu and S of the mixture of the modes that have a weight, which sum to one.
  virtual void mix_innovations(const ModeVector& weights, BoundedVector& nu, BoundedMatrix& S) const = 0;
  /// The weighted gain K (n x m), n the longest state; what a mode's state lacks is zero in it.
  virtual void mix_gains(const ModeVector& weights, BoundedMatrix& K) const = 0;
  /// Mean x (n) and covariance P (n x n, by columns) of the mixture; what a mode's state lacks is zero in it.
  virtual void mix(const ModeVector& weights, double* x, double* P) const = 0;
  /// Becomes a copy of `other`, which was made by fresh() from this one or from the same.
  virtual void assign(const ModeBank& other) = 0;
  virtual std::unique_ptr<ModeBank> fresh() const = 0;
  /// As filters of their own, for those who look back.
  virtual std::span<const std::unique_ptr<TrackedState>> modes() const = 0;

 protected:
  ModeBank() = default;
  ModeBank(const ModeBank&) = delete;
  ModeBank& operator=(const ModeBank&) = delete;
};

/// `modes` (r >= 1) in whichever bank holds them best.
std::unique_ptr<ModeBank> bank_of(ModeBank::Modes modes);

}  // namespace truebearing
