// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/suggestion.hpp"

#include <algorithm>
#include <numeric>

namespace truebearing {
namespace {

// Levenshtein distance, one row at a time.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

// In small letters, words joined by single underscores.
std::string plain_form(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (letter || (c >= 'A' && c <= 'Z'))
      plain += letter ? c : static_cast<char>(c - 'A' + 'a');
    else if (!plain.empty() && plain.back() != '_')
      plain += '_';
  }
  if (plain.ends_with('_')) plain.pop_back();
  return plain;
}

}  // namespace

std::string near_miss(std::string_view name, const std::vector<std::string>& valid) {
  constexpr std::size_t kLongest = 80, kLettersPerSlip = 5;
  if (name.size() > kLongest) return {};
  const std::string plain = plain_form(name);
  for (const std::string& candidate : valid) {
    const std::size_t slips = candidate.size() / kLettersPerSlip;
    if (plain.size() > candidate.size() + slips || candidate.size() > plain.size() + slips) continue;
    if (edit_distance(plain, candidate) <= slips ||
        std::is_permutation(plain.begin(), plain.end(), candidate.begin(), candidate.end()))
      return candidate;
  }
  return {};
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& valid) {
  const std::string_view shortened = name.substr(0, 80);  // a hostile key must not cost quadratic time
  std::string nearest;
  std::size_t best = std::max<std::size_t>(2, shortened.size() / 2) + 1;
  for (const std::string& candidate : valid) {
    const std::size_t distance = edit_distance(shortened, candidate);
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string suggestion(std::string_view name, const std::vector<std::string>& valid) {
  constexpr std::size_t kMaxListed = 24;
  const std::string nearest = nearest_name(name, valid);
  std::string line;
  if (!nearest.empty()) line = "did you mean \"" + nearest + "\"? one of ";
  for (std::size_t i = 0; i < valid.size(); ++i) {
    if (i == kMaxListed) return line + ", ...";
    line += (i == 0 ? "" : ", ") + valid[i];
  }
  return line;
}

}  // namespace truebearing
