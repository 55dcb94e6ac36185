// SPDX-License-Identifier: Apache-2.0
// What is kept of many runs for their statistics (statistics.hpp). Of as many as comparisons usually have it is all of
// them, and figures are exact; of more it is what memory can hold whatever their number, and figures are as good as
// can be told from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/statistics.hpp"
#include "truebearing/evaluation/tally_stream.hpp"

namespace truebearing {

/// So many runs are kept one by one.
inline constexpr std::size_t kMostRunsApart = std::size_t{1} << 16;
/// Of errors of all steps of all runs, of all trackers and quantities together, so many are kept one by one for
/// medians:
/// 160 megabytes.
inline constexpr std::size_t kMostValuesApart = std::size_t{5} << 22;

inline void exchange(SquaredErrors& errors, TallyStream& stream) {
  stream.sum(errors.sum);
  stream.sum(errors.count);
}

/// Errors are written with a block of runs as so many groups at most, where the stream is compact.
inline constexpr std::size_t kGroupsOfBlock = 16;

/// Squared errors run by run. Beyond kMostRunsApart neighbours are taken together, and the jackknife leaves out groups.
class RunErrors {
 public:
  void add(const SquaredErrors& run);
  Estimate rmse() const { return pooled_rmse(groups_); }
  Estimate mse() const { return pooled_mse(groups_); }
  void exchange(TallyStream& stream);

 private:
  std::vector<SquaredErrors> groups_;
  std::size_t group_size_ = 1;
  std::size_t in_last_ = 0;
};

/// The middle of values >= 0. So many are kept one by one; of more, those about the middle, and those on either side
/// are counted. Where the middle wanders away from what was kept, or where blocks of runs come as bins
/// (TallyStream::compact, or more values in a block than are kept), it is told from bins as wide as 1/4096 of what they
/// hold.
class MedianOf {
 public:
  explicit MedianOf(std::size_t kept_apart = kMostRunsApart) : kept_apart_(kept_apart) {}
  void add(double value);
  void add(std::span<const double> values);  ///< those of them that are numbers
  double value() const;
  void exchange(TallyStream& stream);

 private:
  void narrow();
  void begin_bins();
  void write_bins(TallyStream& stream) const;
  void add_bins(TallyStream& stream);

  std::size_t kept_apart_;
  std::vector<double> values_;  // all from low_ to high_
  double low_ = -kInfinity, high_ = kInfinity;
  std::size_t below_ = 0;            // values that are left of those
  std::size_t count_ = 0;            // of all
  std::vector<std::uint64_t> bins_;  // of all; empty while all are kept
};

/// Runs for which something is so, of those that count.
class Share {
 public:
  void add(bool is) {
    ones_ += is ? 1.0 : 0.0;
    count_ += 1.0;
  }
  bool empty() const { return count_ == 0.0; }
  Estimate share() const { return share_of(ones_, count_); }
  void exchange(TallyStream& stream) {
    stream.sum(ones_);
    stream.sum(count_);
  }

 private:
  double ones_ = 0.0;
  double count_ = 0.0;
};

/// One value per run. Beyond kMostRunsApart it is their moments that are kept.
class Samples {
 public:
  void add(double value);
  bool empty() const { return values_.empty() && x_.n == 0.0; }
  Estimate mean() const;
  Estimate rmse() const;
  Estimate standard_deviation() const;
  void exchange(TallyStream& stream);

 private:
  // Number, mean, and sums of powers about it (Chan, Golub and LeVeque 1983; of the third and fourth, Pebay 2008).
  struct Moments {
    double n = 0.0, mean = 0.0, squares = 0.0, cubes = 0.0, fourths = 0.0;
    void add(const Moments& later);
  };
  bool is_all_apart() const { return x_.n == 0.0; }
  void take_together();

  std::vector<double> values_;  // one by one
  Moments x_;
};

}  // namespace truebearing
