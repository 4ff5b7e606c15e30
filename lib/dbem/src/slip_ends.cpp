#include <algorithm>
#include <cmath>

#include "trial.hpp"

/// Slip that comes to its end within a step: from there on friction holds, or pulls the other way. The law of contact
/// is asked at the end of the step and pulls one way all through it; what it pulls wrongly until slip ends is an error
/// of speed of the order of the step. Such a step is done again so that it ends with the slip.
namespace cleave::dbem {
namespace {

/// Of a scene in which slips are followed: in larger ones some slip ends in every step.
constexpr std::size_t most_contacts = 300;
/// Shares of the step nearer to its ends than this are let be.
constexpr double near_an_end = 1e-3;
/// Share by which the step goes on: slip has stopped then, and the next step begins from rest.
constexpr double beyond = 1e-4;
/// Of the fastest corner of the group: slip that is slower is no part of the motion.
constexpr double slow = 1e-2;
/// Speeds below this are none, m/s.
constexpr double no_speed = 1e-9;

}  // namespace

double Trial::until_slip_ends() const {
  if (!follow_slip_ || list_.size() > most_contacts) return 1;
  double first = 1;
  for (std::size_t s = 0; s < out_.islands.size(); ++s) first = std::min(first, until_slip_ends(s));
  return first;
}

double Trial::until_slip_ends(std::size_t group) const {
  const Island& island = out_.islands[group];
  const Rows& rows = rows_[group];
  // Vibrations turn slip round as often as steps follow them.
  const auto bends = [&](std::uint32_t b) { return w_.shapes[b].modes > 0; };
  if (island.theta >= 1 || std::ranges::any_of(island.bodies, bends)) return 1;
  struct Ending {
    std::size_t contact;
    double before;  // m/s
  };
  double fastest = 0;
  for (const std::uint32_t b : island.bodies) fastest = std::max(fastest, w_.speed_bound(w_.state, b));
  const double counts = std::max(no_speed, slow * fastest);
  std::vector<Ending> ending;
  State kept;  // as it would be if friction went on as it began
  for (std::size_t k = 0; k < island.touches.size(); ++k) {
    const Touch& t = list_[island.touches[k]];
    const Vec2 p = solutions_[group].impulse[k];
    if (t.tie != no_tie || p.x <= 0 || w_.compliance_of(t).y > 0) continue;
    const double before = w_.velocity_of(rows, k, w_.state).y, after = w_.velocity_of(rows, k, out_.state).y;
    if (std::abs(before) <= counts || after / before > 1e-6) continue;
    if (ending.empty()) kept = out_.state;
    const double bound = w_.friction_of(moved_[island.touches[k]], w_.bond_of(t)) * p.x + step_ * w_.cohesion_of(t);
    w_.add_impulse(rows, k, {0, (before > 0 ? -bound : bound) - p.y}, island.theta, step_, kept);
    ending.push_back({k, before});
  }
  double first = 1;
  for (const Ending& slip : ending) {
    const double after = w_.velocity_of(rows, slip.contact, kept).y / slip.before;
    const double share = 1 / (1 - std::min(after, 0.0));
    if (share > near_an_end && share < 1 - near_an_end) first = std::min(first, (1 + beyond) * share);
  }
  return first;
}

}  // namespace cleave::dbem
