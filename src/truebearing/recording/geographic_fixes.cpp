// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/geographic_fixes.hpp"

#include <algorithm>
#include <GeographicLib/Geocentric.hpp>
#include <utility>

namespace truebearing {
namespace {

Eigen::Vector3d geocentric(const GeographicFix& fix) {
  Eigen::Vector3d position_m;
  GeographicLib::Geocentric::WGS84().Forward(fix.latitude_deg, fix.longitude_deg, 0.0, position_m.x(), position_m.y(),
                                             position_m.z());
  return position_m;
}

// Fixes of one target that it could have reached one from another.
struct Chain {
  Eigen::Vector3d position_m;  // of the last one
  double since_s;              // when it was first there: receivers repeat a position until they have another
  int length = 0;
};

}  // namespace

void put_in_order(GeographicTarget& target) {
  std::vector<GeographicFix>& fixes = target.fixes;
  std::stable_sort(fixes.begin(), fixes.end(),
                   [](const GeographicFix& a, const GeographicFix& b) { return a.time_s < b.time_s; });
  const auto end = std::unique(fixes.begin(), fixes.end());
  target.repeated += static_cast<int>(fixes.end() - end);
  fixes.erase(end, fixes.end());
}

std::size_t remove_null_island(GeographicTarget& target) {
  constexpr double kNear_deg = 1.0;
  const auto is_origin = [](const GeographicFix& fix) { return fix.latitude_deg == 0.0 && fix.longitude_deg == 0.0; };
  const auto is_near = [&](const GeographicFix& fix) {
    return std::abs(fix.latitude_deg) < kNear_deg && std::abs(fix.longitude_deg) < kNear_deg && !is_origin(fix);
  };
  if (std::any_of(target.fixes.begin(), target.fixes.end(), is_near)) return 0;
  std::size_t removed = 0;
  for (GeographicFix& fix : target.fixes) {
    if (!is_origin(fix)) continue;
    fix.latitude_deg = fix.longitude_deg = kNaN;
    ++removed;
  }
  return removed;
}

void remove_without_altitude(GeographicTarget& target) {
  for (GeographicFix& fix : target.fixes)
    if (std::isnan(fix.altitude_m)) fix.latitude_deg = fix.longitude_deg = kNaN;
}

void remove_glitches(GeographicTarget& target, double max_speed_mps) {
  constexpr std::size_t kMostChains = 8;  // the shortest gives way
  const auto is_shorter = [](const auto& a, const auto& b) { return a.second.length < b.second.length; };
  std::vector<std::pair<int, Chain>> chains;  // with their numbers
  std::vector<int> chain_of(target.fixes.size(), -1);
  int begun = 0;
  for (std::size_t k = 0; k < target.fixes.size(); ++k) {
    const GeographicFix& fix = target.fixes[k];
    if (fix.is_missing()) continue;
    const Eigen::Vector3d position_m = geocentric(fix);
    std::pair<int, Chain>* longest = nullptr;
    for (auto& chain : chains) {
      const double reach_m = max_speed_mps * (fix.time_s - chain.second.since_s);
      const bool is_reached = (position_m - chain.second.position_m).norm() <= reach_m;
      if (is_reached && (!longest || is_shorter(*longest, chain))) longest = &chain;
    }
    if (!longest) {
      if (chains.size() == kMostChains) chains.erase(std::min_element(chains.begin(), chains.end(), is_shorter));
      longest = &chains.emplace_back(begun++, Chain{position_m, fix.time_s});
    }
    Chain& chain = longest->second;
    if (position_m != chain.position_m) chain.since_s = fix.time_s;
    chain.position_m = position_m;
    ++chain.length;
    chain_of[k] = longest->first;
  }
  if (chains.empty()) return;
  const int kept = std::max_element(chains.begin(), chains.end(), is_shorter)->first;
  for (std::size_t k = 0; k < target.fixes.size(); ++k) {
    GeographicFix& fix = target.fixes[k];
    if (fix.is_missing() || chain_of[k] == kept) continue;
    fix.latitude_deg = fix.longitude_deg = kNaN;
    ++target.glitches;
  }
}

void remove_wrong_velocities(GeographicTarget& target, double max_speed_mps) {
  for (GeographicFix& fix : target.fixes) {
    if (!(fix.velocity_mps.norm() > max_speed_mps)) continue;
    fix.velocity_mps.setConstant(kNaN);
    ++target.wrong_velocities;
  }
}

}  // namespace truebearing
