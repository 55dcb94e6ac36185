// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/samples.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "truebearing/core/constants.hpp"

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
  const auto count = [this](double counted) {
    ++bins_[bin_of(counted)];
    ++count_;
  };
  if (!bins_.empty()) return count(value);
  values_.push_back(value);
  if (values_.size() <= kept_apart_) return;
  bins_.resize(kBins);
  for (const double kept : std::exchange(values_, {})) count(kept);
}

double MedianOf::value() const {
  if (bins_.empty()) return median_of(values_);
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
