#include <algorithm>
#include <cmath>
#include <limits>

#include "trial.hpp"

/// Slip that comes to its end within a step: from there on friction holds, or pulls the other way. The law of contact
/// is asked at the end of the step and pulls one way all through it; what it pulls wrongly until slip ends is an error
/// of speed of the order of the step. Such a step is done again so that it ends with the slip. When that is comes from
/// what friction would do if it went on, with normal forces as they are; where it then ends too early, from how slip
/// slowed down until there.
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
  if (!slip_ends_.followed || list_.size() > most_contacts) return 1;
  double first = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < out_.islands.size(); ++s) first = std::min(first, until_slip_ends(s));
  const bool matters = first > near_an_end && std::abs(first - 1) > near_an_end && first * step_ < slip_ends_.within;
  const bool at_first = slip_ends_.within == 0 && first > near_an_end && first < 1 - near_an_end;
  return matters || at_first ? (1 + beyond) * first : 1;
}

double Trial::until_slip_ends(std::size_t group) const {
  constexpr double never = std::numeric_limits<double>::infinity();
  const Island& island = out_.islands[group];
  const Rows& rows = rows_[group];
  // Vibrations turn slip round as often as steps follow them.
  const auto bends = [&](std::uint32_t b) { return w_.shapes[b].modes > 0; };
  if (island.theta >= 1 || std::ranges::any_of(island.bodies, bends)) return never;
  double fastest = 0;
  for (const std::uint32_t b : island.bodies) fastest = std::max(fastest, w_.speed_bound(w_.state, b));
  const double counts = std::max(no_speed, slow * fastest);
  struct Ending {
    std::size_t contact;
    double before;  // m/s
  };
  std::vector<Ending> ending;
  State kept;  // as it would be if friction went on as it began
  double first = never;
  for (std::size_t k = 0; k < island.touches.size(); ++k) {
    const ContactCandidate& t = list_[island.touches[k]];
    const Vec2 p = solutions_[group].impulse[k];
    if (t.tie != no_tie || p.x <= 0 || w_.compliance_of(t).y > 0) continue;
    const double before = w_.velocity_of(rows, k, w_.state).y, after = w_.velocity_of(rows, k, out_.state).y;
    if (std::abs(before) <= counts) continue;
    if (after / before > 1e-6) {  // it goes on; where it should have ended, how it slows tells when it does
      if (slip_ends_.within > 0 && after / before < 1) first = std::min(first, 1 / (1 - after / before));
      continue;
    }
    if (ending.empty()) kept = out_.state;
    const double bound = w_.friction_of(moved_[island.touches[k]], w_.bond_of(t)) * p.x + step_ * w_.cohesion_of(t);
    w_.add_impulse(rows, k, {0, (before > 0 ? -bound : bound) - p.y}, island.theta, step_, kept);
    ending.push_back({k, before});
  }
  for (const Ending& slip : ending) {
    const double after = w_.velocity_of(rows, slip.contact, kept).y / slip.before;
    if (after < 0) first = std::min(first, 1 / (1 - after));
  }
  return first;
}

}  // namespace cleave::dbem
