// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/samples.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace truebearing {
namespace {

// Bins of MedianOf: a power of two has 2^kBinBits, from 2^kLeast on; below and above, the first and the last one.
constexpr int kBinBits = 12;
constexpr int kLeast = -40, kGreatest = 60;
constexpr int kMantissaBits = 52;
constexpr std::size_t kBins = std::size_t{kGreatest - kLeast} << kBinBits;

std::uint64_t first_bits() {
  return std::bit_cast<std::uint64_t>(std::ldexp(1.0, kLeast)) >> (kMantissaBits - kBinBits);
}

std::size_t bin_of(double value) {
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(value) >> (kMantissaBits - kBinBits);
  return bits < first_bits() ? 0 : std::min<std::size_t>(bits - first_bits(), kBins - 1);
}

double beginning_of(std::size_t bin) {
  return std::bit_cast<double>((first_bits() + bin) << (kMantissaBits - kBinBits));
}

}  // namespace

void RunErrors::add(const SquaredErrors& run) {
  if (run.count == 0.0) return;  // it is passed over
  if (in_last_ == 0) {
    if (groups_.size() == kMostRunsApart) {
      for (std::size_t i = 0; i < groups_.size() / 2; ++i) {
        groups_[i] = groups_[2 * i];
        groups_[i].add(groups_[2 * i + 1]);
      }
      groups_.resize(groups_.size() / 2);
      group_size_ *= 2;
    }
    groups_.emplace_back();
  }
  groups_.back().add(run);
  in_last_ = (in_last_ + 1) % group_size_;
}

void MedianOf::add(double value) {
  ++count_;
  if (!bins_.empty()) ++bins_[bin_of(value)];
  if (value < low_) {
    ++below_;
  } else if (value <= high_) {
    values_.push_back(value);
    if (values_.size() > kept_apart_) narrow();
  }
}

// Keeps the half of them that is about the middle of all. Runs that are like those so far move the middle by less the
// more there were.
void MedianOf::narrow() {
  if (bins_.empty()) {
    bins_.resize(kBins);
    for (const double value : values_) ++bins_[bin_of(value)];
  }
  const std::size_t size = values_.size(), middle = count_ / 2, quarter = size / 4;
  if (quarter == 0 || middle < below_ || middle - below_ >= size) {
    values_ = {};
    low_ = kInfinity;
    high_ = -kInfinity;
    return;
  }
  const std::size_t at = middle - below_, begin = at - std::min(at, quarter), last = std::min(at + quarter, size - 1);
  const auto place = [&](std::size_t k) { return values_.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(values_.begin(), place(begin), values_.end());
  low_ = values_[begin];
  std::nth_element(place(begin), place(last), values_.end());
  high_ = values_[last];
  below_ += begin;
  values_.erase(place(last + 1), values_.end());
  values_.erase(values_.begin(), place(begin));
}

double MedianOf::value() const {
  if (bins_.empty()) return median_of(values_);
  const std::size_t upper = count_ / 2, lower = (count_ - 1) / 2;
  if (lower >= below_ && upper - below_ < values_.size()) {
    std::vector<double> values = values_;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(upper - below_);
    std::nth_element(values.begin(), middle, values.end());
    return lower == upper ? *middle : 0.5 * (*middle + *std::max_element(values.begin(), middle));
  }
  // The value at half of the way through, as if those of a bin lay evenly in it.
  double left = 0.5 * static_cast<double>(count_);
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    const double inside = bins_[bin];
    if (inside >= left && inside > 0.0)
      return beginning_of(bin) + left / inside * (beginning_of(bin + 1) - beginning_of(bin));
    left -= inside;
  }
  return kNaN;
}

void Samples::Moments::add(double value) {
  n += 1.0;
  const double off = value - mean;
  mean += off / n;
  squares += off * (value - mean);
}

Estimate Samples::Moments::estimate() const {
  return {mean, n > 1.0 ? std::sqrt(squares / (n - 1.0) / n) : kNaN};
}

void Samples::take(double value) {
  x_.add(value);
  squared_.add(value * value);
  about_centre_.add((value - centre_) * (value - centre_));
}

void Samples::add(double value) {
  if (!is_all_apart()) return take(value);
  values_.push_back(value);
  if (values_.size() <= kMostRunsApart) return;
  centre_ = mean_of(values_).value;
  for (const double kept : values_) take(kept);
  values_ = {};
}

Estimate Samples::mean() const {
  return is_all_apart() ? mean_of(values_) : x_.estimate();
}

// To first order the jackknife of a root is the error of what it is taken of over twice the root.
Estimate Samples::rmse() const {
  if (is_all_apart()) return rmse_of(values_);
  const Estimate square = squared_.estimate();
  const double root = std::sqrt(square.value);
  return {root, square.se / (2.0 * root)};
}

Estimate Samples::standard_deviation() const {
  if (is_all_apart()) return standard_deviation_of(values_);
  const double deviation = std::sqrt(x_.squares / (x_.n - 1.0));
  return {deviation, about_centre_.estimate().se / (2.0 * deviation)};
}

}  // namespace truebearing
