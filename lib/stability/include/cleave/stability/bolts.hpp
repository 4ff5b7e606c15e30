#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <variant>

#include "cleave/geometry/vec3.hpp"

namespace cleave::stability {

/// A bar in grout over its whole length.
struct GroutedBar {
  double bond = 0;   ///< N/m, the weaker of grout-rock and grout-bar
  double shear = 0;  ///< N across the bar; 0: not counted
};
/// A tube that the rock clamps over its whole length (split set, Swellex): it slips at `bond`.
struct FrictionTube {
  double bond = 0;   ///< N/m
  double shear = 0;  ///< N across the tube; 0: not counted
};
/// Strands in grout, free in a sleeve behind the head; too flexible for shear.
struct Cable {
  double bond = 0;         ///< N/m
  double free_length = 0;  ///< m from the collar
};
/// Held at its end over the anchorage (expansion shell, resin), free up to the plate. Loose in its hole: no shear.
struct MechanicalAnchor {
  double capacity = 0;  ///< N of the whole anchor
};
using BoltKind = std::variant<GroutedBar, FrictionTube, Cable, MechanicalAnchor>;
/// By index of the variant.
inline constexpr std::array<std::string_view, 4> bolt_kind_names{"grouted", "friction", "cable", "mechanical"};

/// What of its capacity a bolt gives at the angle t between its axis and the movement, 0 in pure tension. Tension a T
/// and shear b V lie on the ellipse a^2 + b^2 = 1.
enum class AngleLaw : std::uint8_t {
  full,    ///< the pair that does the most work; without shear all of the tension whatever the angle
  cosine,  ///< a = cos t
  linear,  ///< a = 1 - t / 90 degrees
};

/// What a bolt can carry (Windsor and Thompson 1992): tendon, plate, and what its kind holds on both sides of a
/// section.
struct BoltType {
  double tendon = 0;     ///< N
  double plate = 0;      ///< N at the head; 0: no plate
  double anchorage = 0;  ///< m gripped for a block to count
  BoltKind kind = GroutedBar{};
  AngleLaw angle = AngleLaw::full;
};

struct Bolt {
  geometry::Vec3 collar;     ///< m, on a free face
  geometry::Vec3 direction;  ///< unit, into the rock
  double length = 0;         ///< m
  BoltType type;
  std::uint32_t group = 0;        ///< pattern it belongs to
  std::uint32_t after_stage = 0;  ///< of excavation: it is there in the next one
};

enum class BoltLimit : std::uint8_t { head, tendon, anchor, shear };
[[nodiscard]] std::string_view name(BoltLimit limit) noexcept;

/// How much of the bolt from `from` to `to` (m from its collar) its kind grips; m.
[[nodiscard]] double gripped_length(const BoltType& type, double length, double from, double to);
/// Whether `metres` of grip are an anchorage.
[[nodiscard]] bool anchors(const BoltType& type, double metres);

/// Axial capacity at a section of a bolt that grips `before` metres on the collar's side of it and `behind` metres
/// beyond: the least of head (plate and grip), tendon and anchor; N.
struct Capacity {
  double force;
  BoltLimit limit;
};
[[nodiscard]] Capacity capacity(const BoltType& type, bool plate_on_block, double before, double behind);

/// What a bolt does against a movement: along its axis into the rock, and across it straight against the movement.
struct BoltForce {
  geometry::Vec3 force = {};  ///< N
  BoltLimit limit = BoltLimit::tendon;
};
/// `tension`: its axial capacity; a movement that shortens the bolt finds no tension. `dowel`: gripped on both sides
/// of the joint, so that its kind's shear counts. `movement` is a unit vector.
[[nodiscard]] BoltForce force_against(const Bolt& bolt, Capacity tension, bool dowel, geometry::Vec3 movement);

}  // namespace cleave::stability
