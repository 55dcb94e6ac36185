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

void MedianOf::add(std::span<const double> values) {
  const auto is_number = [](double value) { return !std::isnan(value); };
  if (!bins_.empty() || values_.size() + values.size() > kept_apart_) {
    for (const double value : values)
      if (is_number(value)) add(value);
    return;
  }
  const std::size_t before = values_.size(), size = before + values.size();
  // Much at once: a copy of what there is takes time, and fresh memory that has never been written takes none.
  if (size > values_.capacity()) values_.reserve(std::min(8 * size, kept_apart_));
  values_.resize(size);
  const auto first = values_.begin() + static_cast<std::ptrdiff_t>(before);
  values_.erase(std::copy_if(values.begin(), values.end(), first, is_number), values_.end());
  count_ += values_.size() - before;
}

// Keeps the half of them that is about the middle of all. Runs that are like those so far move the middle by less the
// more there were.
void MedianOf::narrow() {
  begin_bins();
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
  if (lower >= below_ && upper - below_ < values_.size()) return middle_of(values_, lower - below_, upper - below_);
  // The value at half of the way through, as if those of a bin lay evenly in it.
  double left = 0.5 * static_cast<double>(count_);
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    const auto inside = static_cast<double>(bins_[bin]);
    if (inside >= left && inside > 0.0)
      return beginning_of(bin) + left / inside * (beginning_of(bin + 1) - beginning_of(bin));
    left -= inside;
  }
  return kNaN;
}

void MedianOf::begin_bins() {
  if (!bins_.empty()) return;
  bins_.resize(kBins);
  for (const double value : values_) ++bins_[bin_of(value)];
}

void MedianOf::exchange(TallyStream& stream) {
  if (stream.writes()) {
    const bool as_bins = stream.compact() || !bins_.empty();  // of which values_ are the middle at best
    stream.whole(as_bins ? 1 : 0);
    if (as_bins) return write_bins(stream);
    stream.write(values_);
    return;
  }
  if (stream.whole(0) != 0) return add_bins(stream);
  add(stream.read());
}

// Which bins hold anything, each as its distance from the one before, and how much.
void MedianOf::write_bins(TallyStream& stream) const {
  std::vector<std::pair<std::size_t, std::uint64_t>> held;  // bin, count
  if (bins_.empty()) {
    std::vector<std::size_t> bins;
    for (const double value : values_) bins.push_back(bin_of(value));
    std::sort(bins.begin(), bins.end());
    for (const std::size_t bin : bins) {
      if (held.empty() || held.back().first != bin) held.emplace_back(bin, 0);
      ++held.back().second;
    }
  } else {
    for (std::size_t bin = 0; bin < bins_.size(); ++bin)
      if (bins_[bin] > 0) held.emplace_back(bin, bins_[bin]);
  }
  stream.length(held.size());
  std::size_t last = 0;
  for (const auto& [bin, count] : held) {
    stream.small(bin - last);
    stream.small(count);
    last = bin;
  }
}

// From here on all is told from bins.
void MedianOf::add_bins(TallyStream& stream) {
  begin_bins();
  values_ = {};
  low_ = kInfinity;
  high_ = -kInfinity;
  const std::size_t held = stream.length(0);
  std::size_t bin = 0;
  for (std::size_t i = 0; i < held; ++i) {
    bin = std::min<std::size_t>(bin + std::min<std::uint64_t>(stream.small(0), kBins), kBins - 1);
    const std::uint64_t count = stream.small(0);
    bins_[bin] += count;
    count_ += count;
  }
}

void RunErrors::exchange(TallyStream& stream) {
  const std::size_t together =
      stream.compact() ? (groups_.size() + kGroupsOfBlock - 1) / kGroupsOfBlock : std::size_t{1};
  const std::size_t count = stream.length(together > 1 ? (groups_.size() + together - 1) / together : groups_.size());
  for (std::size_t i = 0; i < count; ++i) {
    SquaredErrors group;
    if (stream.writes())
      for (std::size_t k = i * together; k < std::min((i + 1) * together, groups_.size()); ++k) group.add(groups_[k]);
    const double sum = stream.value(group.sum), size = stream.value(group.count);
    if (!stream.writes()) add({sum, size});
  }
}

void Samples::Moments::add(const Moments& later) {
  const double na = n, nb = later.n, off = later.mean - mean, all = na + nb;
  if (nb == 0.0) return;
  if (na == 0.0) {
    *this = later;
    return;
  }
  const double step = off / all, pairs = na * nb * off * step;
  fourths += later.fourths + pairs * step * step * (na * na - na * nb + nb * nb) +
             6.0 * step * step * (na * na * later.squares + nb * nb * squares) +
             4.0 * step * (na * later.cubes - nb * cubes);
  cubes += later.cubes + pairs * step * (na - nb) + 3.0 * step * (na * later.squares - nb * squares);
  squares += later.squares + pairs;
  mean += step * nb;
  n = all;
}

void Samples::take_together() {
  for (const double value : values_) x_.add({1.0, value});
  values_ = {};
}

void Samples::add(double value) {
  if (!is_all_apart()) return x_.add({1.0, value});
  values_.push_back(value);
  if (values_.size() > kMostRunsApart) take_together();
}

void Samples::exchange(TallyStream& stream) {
  if (stream.compact()) take_together();
  const std::size_t count = stream.length(values_.size());
  if (stream.writes()) {
    for (const double value : values_) stream.value(value);
  } else {
    for (std::size_t i = 0; i < count; ++i) add(stream.value(0.0));
  }
  Moments others;
  for (const auto& [own, other] :
       {std::pair{&x_.n, &others.n}, std::pair{&x_.mean, &others.mean}, std::pair{&x_.squares, &others.squares},
        std::pair{&x_.cubes, &others.cubes}, std::pair{&x_.fourths, &others.fourths}})
    *other = stream.value(*own);
  if (stream.writes() || others.n == 0.0) return;
  if (is_all_apart()) take_together();
  x_.add(others);
}

Estimate Samples::mean() const {
  if (is_all_apart()) return mean_of(values_);
  return {x_.mean, x_.n > 1.0 ? std::sqrt(x_.squares / (x_.n - 1.0) / x_.n) : kNaN};
}

// To first order the jackknife of a root is the error of what it is taken of over twice the root. Of a square that is
// x^2 = mu^2 + 2 mu d + d^2, d = x - mu.
Estimate Samples::rmse() const {
  if (is_all_apart()) return rmse_of(values_);
  const double mu = x_.mean, m2 = x_.squares / x_.n, m3 = x_.cubes / x_.n, m4 = x_.fourths / x_.n;
  const double root = std::sqrt(mu * mu + m2), variance = 4.0 * mu * (mu * m2 + m3) + m4 - m2 * m2;
  return {root, std::sqrt(std::max(variance, 0.0) / (x_.n - 1.0)) / (2.0 * root)};
}

Estimate Samples::standard_deviation() const {
  if (is_all_apart()) return standard_deviation_of(values_);
  const double m2 = x_.squares / x_.n, m4 = x_.fourths / x_.n;
  const double deviation = std::sqrt(x_.squares / (x_.n - 1.0));
  return {deviation, std::sqrt(std::max(m4 - m2 * m2, 0.0) / (x_.n - 1.0)) / (2.0 * deviation)};
}

}  // namespace truebearing
