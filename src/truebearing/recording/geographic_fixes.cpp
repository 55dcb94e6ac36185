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

// A fix at the end of a chain of those that the target could have reached one from another.
struct Link {
  std::size_t fix;
  Eigen::Vector3d position_m;
  double time_s;
  double since_s;  // when it was first there: receivers repeat a position until they have another
  int before = -1;
  int length = 1;

  bool reaches(const Link& next, double max_speed_mps) const {
    return (next.position_m - position_m).norm() <= max_speed_mps * (next.time_s - since_s);
  }
  Eigen::Vector3d velocity_to(const Link& next) const {
    const double dt_s = next.time_s - since_s;
    return dt_s > 0.0 ? Eigen::Vector3d((next.position_m - position_m) / dt_s) : Eigen::Vector3d::Constant(kInfinity);
  }
};

// The longest chain through the fixes of a target. A fix may go on with each of the latest, so that a wrong one before
// it does not take it away, and with the ends of what stands further back.
class LongestChain {
 public:
  LongestChain(const std::vector<GeographicFix>& fixes, double max_speed_mps) : max_speed_mps_(max_speed_mps) {
    for (std::size_t k = 0; k < fixes.size(); ++k)
      if (!fixes[k].is_missing()) links_.push_back({k, geocentric(fixes[k]), fixes[k].time_s, fixes[k].time_s});
    for (int k = 0; k < count(); ++k) append(k);
  }

  std::vector<std::size_t> fixes() const {
    std::vector<std::size_t> kept;
    int last = count() - 1;
    for (int k = last - 1; k >= 0; --k)
      if (at(k).length > at(last).length || (at(k).length == at(last).length && end_bend(k) < end_bend(last))) last = k;
    for (int k = last; k >= 0; k = at(k).before) kept.push_back(at(k).fix);
    return kept;
  }

 private:
  static constexpr int kLatest = 8;
  static constexpr std::size_t kMostEnds = 8;  // the shortest gives way

  int count() const { return static_cast<int>(links_.size()); }
  const Link& at(int k) const { return links_[static_cast<std::size_t>(k)]; }

  void append(int k) {
    Link& link = links_[static_cast<std::size_t>(k)];
    for (const int end : ends_) consider(end, k);
    for (int latest = k - 1; latest >= std::max(k - kLatest, 0); --latest) consider(latest, k);
    if (link.before >= 0) {
      link.length = at(link.before).length + 1;
      if (at(link.before).position_m == link.position_m) link.since_s = at(link.before).since_s;
    }
    std::erase(ends_, link.before);
    const auto is_shorter = [&](int a, int b) { return at(a).length < at(b).length; };
    if (ends_.size() == kMostEnds) ends_.erase(std::min_element(ends_.begin(), ends_.end(), is_shorter));
    ends_.push_back(k);
  }

  // Of two first fixes, a wrong one and the right one after it, order says nothing: the one from which the target goes on
  // into the next fixes as it came is the target's. Later on the one that has been reached first is.
  void consider(int before, int k) {
    Link& link = links_[static_cast<std::size_t>(k)];
    if (before == link.before || !at(before).reaches(link, max_speed_mps_)) return;
    if (link.before >= 0) {
      const int now = link.before;
      if (at(before).length < at(now).length) return;
      const bool is_tie = at(before).length == at(now).length;
      if (is_tie && !(at(now).length == 1 ? bend(before, k) < bend(now, k) : before < now)) return;
    }
    link.before = before;
  }

  // By how much the velocity changes at fix k, which goes on to the next one elsewhere that it could have reached; at the
  // fix before, where there is none.
  double bend(int before, int k) const {
    const Eigen::Vector3d velocity = at(before).velocity_to(at(k));
    for (int next = k + 1; next < std::min(k + kLatest, count()); ++next)
      if (at(next).position_m != at(k).position_m && at(k).reaches(at(next), max_speed_mps_))
        return (at(k).velocity_to(at(next)) - velocity).norm();
    return bend_at(before, velocity);
  }

  double bend_at(int k, const Eigen::Vector3d& after_mps) const {
    return at(k).before < 0 ? kInfinity : (after_mps - at(at(k).before).velocity_to(at(k))).norm();
  }

  double end_bend(int k) const {
    return at(k).before < 0 ? kInfinity : bend_at(at(k).before, at(at(k).before).velocity_to(at(k)));
  }

  std::vector<Link> links_;
  std::vector<int> ends_;
  double max_speed_mps_;
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
  std::vector<bool> is_kept(target.fixes.size(), false);
  for (const std::size_t k : LongestChain(target.fixes, max_speed_mps).fixes()) is_kept[k] = true;
  for (std::size_t k = 0; k < target.fixes.size(); ++k) {
    GeographicFix& fix = target.fixes[k];
    if (fix.is_missing() || is_kept[k]) continue;
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
