#include "supported_body.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "resistance.hpp"

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

/// The body with a share of the help, strengths and help reduced by the target.
AtShare with_share(const Body& body, const Help& help, double share, const Settings& settings) {
  const Vec3 force = share / body.target * help.force;
  Resultant r = body.resultant;
  r.add(force, norm(force));
  const Verdict v = judge(body.contacts, r, settings);
  return {v.driving - (v.resistance.least + help.resistance) / body.target, v.driving, v.mode};
}

/// Where a function with one valley is least on [low, high]; the best of the points looked at.
template <class Function>
double valley(double low, double high, Function&& of) {
  constexpr double golden = 0.6180339887498949;
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double at_a = of(a), at_b = of(b);
  for (int i = 0; i < 80 && a < b; ++i) {
    if (at_a <= at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - golden * (high - low);
      at_a = of(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + golden * (high - low);
      at_b = of(b);
    }
  }
  return at_a <= at_b ? a : b;
}

/// Friction that each newton of a force makes in the planes which press, as a vector: 0 where fewer than one or more
/// than two do.
Vec3 pressed_by(const Body& body) {
  const Verdict& v = body.bare;
  const auto& pressing = v.resistance.pressing;
  const auto normal = [&](std::size_t k) { return body.contacts.cone.groups()[pressing[k].first].unit(); };
  const auto tan = [&](std::size_t k) { return body.contacts.groups[pressing[k].first].tan_at(pressing[k].second); };
  if (v.mode != Mode::sliding && v.mode != Mode::wedge) return {};
  if (pressing.size() == 1) return tan(0) * normal(0);
  if (pressing.size() != 2) return {};
  // What turns a force into the reactions of the two: the vectors dual to their normals.
  const Vec3 first = cross(normal(1), v.direction), second = cross(normal(0), v.direction);
  const double a = dot(normal(0), first), b = dot(normal(1), second);
  if (!(a != 0) || !(b != 0)) return {};
  return tan(0) / a * first + tan(1) / b * second;
}

}  // namespace

void keep_cohesion_of(const Verdict& bare, const Resultant& resultant, bool parallel_contact, Contacts& contacts) {
  if (!moves(bare.mode)) return;
  const double load = norm(resultant.newtons());
  for (std::uint32_t group = 0; group < contacts.groups.size(); ++group) {
    const double opens = dot(contacts.cone.groups()[group].unit(), bare.direction);
    contacts.groups[group].cohesion *=
        cohesion_shares(bare.resistance.pressing, group, load, opens, parallel_contact).counted;
  }
}

double target_of(Mode mode, const SupportPlan& plan) {
  return mode == Mode::falling || mode == Mode::lifting ? plan.target_falling : plan.target_sliding;
}

std::optional<Share> least_share(const Body& body, const Help& help, const Settings& settings, double limit) {
  const auto at = [&](double share) { return with_share(body, help, share, settings); };
  const auto holds = [&](const AtShare& there) { return there.lack <= rounding * body.bare.driving; };
  if (const AtShare none = at(0); holds(none)) return Share{0, none.mode};
  if (help.force == Vec3{}) return std::nullopt;
  constexpr int steps = 32;
  std::vector<std::pair<double, double>> looked;  // share, lack
  const auto look = [&](double share) {
    const AtShare there = at(share);
    looked.insert(std::ranges::lower_bound(looked, std::pair{share, there.lack}), {share, there.lack});
    return holds(there);
  };
  bool found = false;
  for (int i = 1; i <= steps && !found; ++i) found = look(limit * i / steps);
  if (!found) found = look(valley(0, limit, [&](double share) { return at(share).driving; }));
  if (!found) {
    // Between the two neighbours of the best of them.
    const auto best = std::ranges::min_element(looked, {}, &std::pair<double, double>::second);
    const double low = best == looked.begin() ? 0 : std::prev(best)->first;
    const double high = std::next(best) == looked.end() ? limit : std::next(best)->first;
    found = look(valley(low, high, [&](double share) { return at(share).lack; }));
  }
  if (!found) return std::nullopt;
  const auto first =
      std::ranges::find_if(looked, [&](const auto& there) { return there.second <= rounding * body.bare.driving; });
  double above = first->first, below = first == looked.begin() ? 0 : std::prev(first)->first;
  for (int k = 0; k < 60 && above - below > 1e-13 * limit; ++k) {
    const double middle = 0.5 * (below + above);
    (holds(at(middle)) ? above : below) = middle;
  }
  return Share{above, at(above).mode};
}

double factor_with(Body body, const Help& help, const Settings& settings) {
  if (help.force == Vec3{} && help.resistance == 0) return body.bare.factor_of_safety;
  constexpr double most = 1e6;
  const double target = body.target;
  const auto held = [&](double factor) {
    body.target = factor;
    return least_share(body, help, settings).has_value();
  };
  double low = 0, high = target;
  if (held(target)) {
    low = target;
    for (high = 2 * low; high < most && held(high); high *= 2) low = high;
    if (high >= most) return infinite;
  } else {
    low = std::min(target, body.bare.factor_of_safety);  // strength alone
  }
  while (high - low > 1e-6 * high) {
    const double middle = 0.5 * (low + high);
    (held(middle) ? low : high) = middle;
  }
  return low;
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

Vec3 spot_direction(const Body& body) {
  const bool one_plane = body.bare.resistance.pressing.size() == 1;
  return geometry::normalized(-body.bare.direction - (one_plane ? pressed_by(body) : Vec3{}));
}

SingleForce best_force(const Body& body, const Settings& settings) {
  const double most = 1.05 * body.target * body.bare.driving;
  const auto along = [&](Vec3 direction) {
    const auto least = least_share(body, {.force = most * direction}, settings);
    return SingleForce{direction, least ? most * least->share : infinite};
  };
  const SingleForce straight = along(-body.bare.direction);
  const Vec3 pressed = pressed_by(body);
  if (pressed == Vec3{}) return straight;
  const SingleForce aside = along(geometry::normalized(-body.bare.direction - pressed / body.target));
  return aside.force < straight.force ? aside : straight;
}

}  // namespace cleave::stability
