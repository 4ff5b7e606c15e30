#include "cleave/stability/strength.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "cleave/core/overloaded.hpp"

namespace cleave::stability {
namespace {

std::string text(geometry::Vec3 v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); }

bool negative_or_not_finite(Stress s) noexcept { return !std::isfinite(s.si()) || s.si() < 0; }

}  // namespace

std::string describe(const StrengthError& error) {
  return std::visit(
      overloaded{
          [](const FrictionOutOfRange& e) {
            return fmt::format(
                "friction {} is not an angle from 0 up to (not including) 90 degrees; give degrees, not a coefficient",
                e.friction.degrees());
          },
          [](const BadCohesion& e) {
            return fmt::format("cohesion {} Pa is not a finite number >= 0; use 0 for none", e.cohesion.si());
          },
          [](const BadTension& e) {
            return fmt::format("tensile strength {} Pa is not a finite number >= 0; use 0 for none", e.tension.si());
          },
          [](const BadRoughness& e) {
            return fmt::format("JRC {} and JCS {} Pa: JRC must lie in [0, 20] and JCS above 0", e.jrc, e.jcs.si());
          },
          [](const BadDensity& e) {
            return fmt::format("density {} kg/m3 is not a finite number > 0; rock has 2000 to 3000", e.density.si());
          },
          [](const BadGravity& e) {
            return fmt::format("gravity {} m/s2 is not finite; use 9.81 or a vector such as [0, 0, -9.81]",
                               text(e.gravity));
          },
          [](const BadSeismic& e) {
            return fmt::format("seismic coefficient {} is not finite; give force / weight, such as [0.1, 0, 0]",
                               text(e.coefficient));
          },
          [](const BadPartialFactor& e) {
            return fmt::format("partial factor {} on {} is not a finite number > 0; use 1 for none", e.value, e.which);
          }},
      error);
}

JointStrength::JointStrength(FrictionAngle friction, Stress cohesion, Stress tension) noexcept
    : friction_{friction}, tan_friction_{std::tan(friction.radians())}, cohesion_{cohesion}, tension_{tension} {}

std::expected<JointStrength, StrengthError> JointStrength::make(FrictionAngle friction, Stress cohesion,
                                                                Stress tension) {
  if (!(friction.degrees() >= 0 && friction.degrees() < 90)) return std::unexpected(FrictionOutOfRange{friction});
  if (negative_or_not_finite(cohesion)) return std::unexpected(BadCohesion{cohesion});
  if (negative_or_not_finite(tension)) return std::unexpected(BadTension{tension});
  return JointStrength{friction, cohesion, tension};
}

std::expected<JointStrength, StrengthError> JointStrength::barton_bandis(FrictionAngle residual, double jrc, Stress jcs,
                                                                         Stress tension) {
  auto made = make(residual, pascals(0), tension);
  if (!made) return made;
  if (!(jrc >= 0 && jrc <= 20) || !std::isfinite(jcs.si()) || !(jcs.si() > 0)) {
    return std::unexpected(BadRoughness{jrc, jcs});
  }
  made->jrc_ = jrc;
  made->jcs_ = jcs;
  return made;
}

double JointStrength::tan_friction(Stress normal) const noexcept {
  if (!curved()) return tan_friction_;
  // At no stress the law has no value; its limit is the cap.
  constexpr double cap = 70;
  const double highest = std::max(cap, friction_.degrees());
  const double ratio = normal.si() > 0 ? jcs_.si() / normal.si() : std::numeric_limits<double>::infinity();
  const double rise = ratio > 1 ? jrc_ * std::log10(ratio) : 0;
  return std::tan(FrictionAngle::degrees(std::min(highest, friction_.degrees() + rise)).radians());
}

void StrengthTable::set(topology::JointId joint, JointStrength strength) {
  if (by_joint_.size() <= joint.index()) by_joint_.resize(joint.index() + 1);
  by_joint_[joint.index()] = strength;
}

double StrengthTable::least_tan_friction() const noexcept {
  double least = fallback_.tan_friction();
  for (const auto& strength : by_joint_) {
    if (strength) least = std::min(least, strength->tan_friction());
  }
  return least;
}

const JointStrength& StrengthTable::of(std::optional<topology::JointId> joint) const noexcept {
  if (!joint || joint->index() >= by_joint_.size()) return fallback_;
  const auto& entry = by_joint_[joint->index()];
  return entry ? *entry : fallback_;
}

std::expected<RockMass, StrengthError> RockMass::make(Density density) {
  if (!std::isfinite(density.si()) || !(density.si() > 0)) return std::unexpected(BadDensity{density});
  return RockMass{density};
}

std::expected<Loads, StrengthError> Loads::make(geometry::Vec3 gravity, geometry::Vec3 seismic) {
  if (!geometry::is_finite(gravity)) return std::unexpected(BadGravity{gravity});
  if (!geometry::is_finite(seismic)) return std::unexpected(BadSeismic{seismic});
  return Loads{gravity, seismic};
}

std::expected<PartialFactors, StrengthError> PartialFactors::make(double friction, double cohesion, double weight) {
  for (const auto& [which, value] : {std::pair{"friction", friction}, {"cohesion", cohesion}, {"weight", weight}}) {
    if (!std::isfinite(value) || !(value > 0)) return std::unexpected(BadPartialFactor{which, value});
  }
  PartialFactors factors;
  factors.friction_ = friction;
  factors.cohesion_ = cohesion;
  factors.weight_ = weight;
  return factors;
}

}  // namespace cleave::stability
