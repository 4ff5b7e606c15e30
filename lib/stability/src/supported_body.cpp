#include "supported_body.hpp"

#include <algorithm>
#include <cmath>

namespace cleave::stability {
namespace {

using geometry::dot;
using geometry::norm;
using geometry::Vec3;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double rounding = 0x1p-40;

struct AtShare {
  double lack;  ///< T - R / target, N; <= 0: held
  double driving;
  Mode mode;
};

/// The body with an extra force, strength and force both reduced by the target.
AtShare with_force(const Body& body, Vec3 force, const Settings& settings) {
  Resultant r = body.resultant;
  r.add(force / body.target, norm(force) / body.target);
  const Verdict v = judge(body.contacts, r, settings);
  return {v.driving - v.resistance.least / body.target, v.driving, v.mode};
}

}  // namespace

double target_of(Mode mode, const SupportPlan& plan) {
  return mode == Mode::falling || mode == Mode::lifting ? plan.target_falling : plan.target_sliding;
}

Least least_share(const Body& body, Vec3 force, const Settings& settings, double limit) {
  const auto holds = [&](double share, Mode& mode) {
    const AtShare at = with_force(body, share * force, settings);
    mode = at.mode;
    return at.lack <= rounding * body.bare.driving;
  };
  Mode mode = Mode::stable;
  double below = 0;
  if (holds(0, mode)) return {0, mode};
  constexpr int steps = 32;
  for (int i = 1; i <= steps; ++i) {
    double above = limit * i / steps;
    if (!holds(above, mode)) {
      below = above;
      continue;
    }
    for (int k = 0; k < 60 && above - below > 1e-13 * limit; ++k) {
      const double middle = 0.5 * (below + above);
      Mode there = Mode::stable;
      if (holds(middle, there)) {
        above = middle;
        mode = there;
      } else {
        below = middle;
      }
    }
    return {above, mode};
  }
  return {};
}

double fixed_mode_factor(const Body& body, Vec3 bolts, bool active) {
  const Verdict& v = body.bare;
  if (!moves(v.mode)) return infinite;
  const double along = -dot(bolts, v.direction);
  double resistance = v.resistance.least;
  const auto& pressing = v.resistance.pressing;
  const auto swap_friction = [&](std::size_t k, double reaction) {
    const Contact& group = body.contacts.groups[pressing[k].first];
    const double old = pressing[k].second;
    resistance += reaction * group.tan_at(reaction) - old * group.tan_at(old);
  };
  if (pressing.size() == 1) {
    const Vec3 n = body.contacts.cone.groups()[pressing[0].first].unit();
    swap_friction(0, std::max(0.0, pressing[0].second - dot(bolts, n)));
  } else if (pressing.size() == 2) {
    Resultant r = body.resultant;
    r.add(bolts, norm(bolts));
    if (const auto both = reactions(body.contacts.cone, r, pressing[0].first, pressing[1].first)) {
      swap_friction(0, both->first);
      swap_friction(1, both->second);
    }
  }
  if (!active) return (resistance + along) / v.driving;
  return v.driving > along ? resistance / (v.driving - along) : infinite;
}

Vec3 best_direction(const Body& body) {
  const Verdict& v = body.bare;
  if (v.mode != Mode::sliding || v.resistance.pressing.size() != 1) return -v.direction;
  const auto [group, reaction] = v.resistance.pressing[0];
  const double b = std::atan(body.contacts.groups[group].tan_at(reaction));
  return geometry::normalized(-std::cos(b) * v.direction - std::sin(b) * body.contacts.cone.groups()[group].unit());
}

}  // namespace cleave::stability
