#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "bolt_grips.hpp"
#include "cleave/stability/support.hpp"

/// Bolts as ties: what they carry along their axes between any pieces of rock that they go through.
namespace cleave::stability {
namespace {

using geometry::Vec3;
using topology::BlockId;

/// What one body, or rock that stays, has of a bolt.
struct Stretch {
  std::optional<std::uint32_t> body;
  BlockId first, last;
  double to = 0;        ///< m from the collar
  double grip = 0;      ///< m
  double moment = 0;    ///< m2: grip times where it is
  double capacity = 0;  ///< N: bond, and plate
  std::optional<double> plate = {};
};

std::vector<Stretch> stretches_of(const BoltResult& result, const OwnerOf& owner) {
  const BoltType& type = result.bolt.type;
  const double length = result.bolt.length.si();
  std::vector<Stretch> out;
  for (const Pierced& p : result.pierced) {
    const auto there = owner(p.block);
    if (!there) continue;
    if (out.empty() || out.back().body != *there) out.push_back({.body = *there, .first = p.block, .last = p.block});
    Stretch& own = out.back();
    const double grip = gripped_length(type, length, p.from, p.to);
    own.last = p.block;
    own.to = p.to;
    own.grip += grip;
    own.moment += grip * (p.to - grip / 2);
    own.capacity += bond_of(type) * grip;
    if (&p != &result.pierced.front() || !(type.plate > newtons(0))) continue;
    own.plate = p.from;
    own.capacity += type.plate.si();
  }
  return out;
}

/// m from the collar.
double middle_of_grip(const Stretch& s) { return s.grip > 0 ? s.moment / s.grip : s.to; }

}  // namespace

std::vector<BoltPull> pulls_of(const BoltResult& bolt, const OwnerOf& owner) {
  const BoltType& type = bolt.bolt.type;
  std::vector<BoltPull> out;
  std::vector<Stretch> all = stretches_of(bolt, owner);
  if (all.size() < 2) return out;
  std::vector<double> tendon(all.size() - 1, type.tendon.si());  // behind each of them
  const auto pull_from = [&](std::size_t i, double before) {
    Stretch& near = all[i];
    double behind = 0;
    for (std::size_t j = all.size(); --j > i && near.capacity > 0;) {
      Stretch& deep = all[j];
      behind += deep.grip;
      const bool anchored = (near.plate || anchors(type, before)) && anchors(type, behind);
      if (!anchored || near.body == deep.body) continue;
      const auto crossed = std::span{tendon}.subspan(i, j - i);
      const double steel = std::ranges::min(crossed);
      const double force = std::min({near.capacity, deep.capacity, steel});
      if (!(force > 0)) continue;
      const BoltLimit limit = force == steel           ? BoltLimit::tendon
                              : force == deep.capacity ? BoltLimit::anchor
                                                       : BoltLimit::head;
      near.capacity -= force;
      deep.capacity -= force;
      for (double& left : crossed) left -= force;
      out.push_back({.body = near.body,
                     .other = deep.body,
                     .block = near.last,
                     .behind = deep.first,
                     .leaves = near.to,
                     .held = near.plate ? *near.plate : middle_of_grip(near),
                     .anchored = middle_of_grip(deep),
                     .force = newtons(force),
                     .limit = limit});
    }
  };
  for (const bool moves : {true, false}) {
    double before = 0;
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
      before += all[i].grip;
      if (all[i].body.has_value() == moves) pull_from(i, before);
    }
  }
  return out;
}

std::optional<double> share_at_angle(const Bolt& bolt, Vec3 apart) {
  if (bolt.type.angle == AngleLaw::full) return 1.0;
  const double along = -dot(apart, bolt.direction);
  const double across = norm(apart + along * bolt.direction);
  if (!(along > 0)) return std::nullopt;
  if (bolt.type.angle == AngleLaw::cosine) return along / std::hypot(along, across);
  return 1 - std::atan2(across, along) * (2 * std::numbers::inv_pi);
}

}  // namespace cleave::stability
