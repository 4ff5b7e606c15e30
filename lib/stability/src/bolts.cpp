#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "bolt_grips.hpp"
#include "cleave/core/fields.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/stability/support.hpp"

namespace cleave::stability {
namespace {

using geometry::dot;
using geometry::norm;
using geometry::Vec3;

double shear_of(const BoltType& type) {
  return std::visit(
      overloaded{[](const GroutedBar& k) { return k.shear.si(); }, [](const FrictionTube& k) { return k.shear.si(); },
                 [](const Cable&) { return 0.0; }, [](const MechanicalAnchor&) { return 0.0; }},
      type.kind);
}

/// m from the collar at which the kind begins to grip.
double grip_begins(const BoltType& type, double length) {
  return std::visit(overloaded{[](const GroutedBar&) { return 0.0; }, [](const FrictionTube&) { return 0.0; },
                               [](const Cable& k) { return k.free_length.si(); },
                               [&](const MechanicalAnchor&) { return std::max(0.0, length - type.anchorage.si()); }},
                    type.kind);
}

/// Shares of tension and shear on their ellipse.
struct Shares {
  double tension, shear;
};
Shares shares(AngleLaw law, double tension, double shear, double along, double across) {
  switch (law) {
    case AngleLaw::full: {
      const double work = std::hypot(tension * along, shear * across);
      if (!(work > 0)) return {1, 0};
      return {tension * along / work, shear * across / work};
    }
    case AngleLaw::cosine: return {along, across};
    case AngleLaw::linear: {
      const double a = 1 - std::atan2(across, along) * (2 * std::numbers::inv_pi);
      return {a, std::sqrt(std::max(0.0, (1 - a) * (1 + a)))};
    }
  }
  std::unreachable();
}

}  // namespace

double bond_of(const BoltType& type) {
  return std::visit(
      overloaded{[](const GroutedBar& k) { return k.bond.si(); }, [](const FrictionTube& k) { return k.bond.si(); },
                 [](const Cable& k) { return k.bond.si(); },
                 [&](const MechanicalAnchor& k) {
                   return type.anchorage > metres(0) ? (k.capacity / type.anchorage).si() : 0.0;
                 }},
      type.kind);
}

std::string_view name(BoltLimit limit) noexcept { return enum_name(limit); }

double gripped_length(const BoltType& type, double length, double from, double to) {
  return std::max(0.0, to - std::max(from, grip_begins(type, length)));
}

bool anchors(const BoltType& type, double grip) {
  // An anchor at the end is whole or nothing: its length is a difference of two.
  const bool end = std::holds_alternative<MechanicalAnchor>(type.kind);
  return grip > 0 && grip >= (end ? type.anchorage * (1 - 1e-12) : type.anchorage).si();
}

Capacity capacity(const BoltType& type, bool plate_on_block, double before, double behind) {
  const double bond = bond_of(type);
  const double head = (plate_on_block ? type.plate.si() : 0) + bond * before;
  const double anchor = bond * behind;
  Capacity least{head, BoltLimit::head};
  if (type.tendon.si() < least.force) least = {type.tendon.si(), BoltLimit::tendon};
  if (anchor < least.force) least = {anchor, BoltLimit::anchor};
  return least;
}

BoltForce force_against(const Bolt& bolt, Capacity tension, bool dowel, Vec3 movement) {
  const double shear = dowel ? shear_of(bolt.type) : 0;
  const double along = -dot(bolt.direction, movement);
  const Vec3 sideways = movement + along * bolt.direction;
  const double across = norm(sideways);
  const Vec3 against = across > 1e-12 ? -sideways / across : Vec3{};
  if (along < 0) return {shear * against, shear > 0 ? BoltLimit::shear : tension.limit};
  const Shares part = shares(bolt.type.angle, tension.force, shear, along, across);
  const double pull = part.tension * tension.force, dowelled = part.shear * shear;
  return {pull * bolt.direction + dowelled * against, dowelled > pull ? BoltLimit::shear : tension.limit};
}

}  // namespace cleave::stability
