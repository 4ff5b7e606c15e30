#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

/// Water at rest below a table: p = unit_weight * depth, depth measured against gravity; 0 above the table.
struct WaterTable {
  /// m: -x.g/|g| on the table; with gravity straight down the z of the table.
  double level = 0;
  UnitWeight unit_weight = newtons_per_cubic_metre(9810);
  /// Also on free faces (a lake, a flooded opening). Without it whatever is open is drained.
  bool on_free_faces = false;
};

/// A free surface: all of it, one named domain side, or the walls of one excavation.
struct AnyFreeFace {};
struct DomainSide {
  std::uint32_t tag;  ///< tag index of the domain solid
};
struct ExcavationWall {
  std::uint32_t excavation;  ///< index into CutInput::excavations
};
using FreeSurface = std::variant<AnyFreeFace, DomainSide, ExcavationWall>;

/// Water in the joints of one cut as a computation of flow found it, in place of a table. Pressures are unit weight
/// times head of pressure.
struct FlowWater {
  /// What water in the contact of two blocks does to one of them.
  struct Contact {
    topology::BlockId block, neighbour;
    geometry::Vec3 heads;  ///< m3: integral of the head of pressure over the contact, towards `block`
    geometry::Vec3 at;     ///< m: where the resultant acts
  };
  /// Still water before a free side of the domain.
  struct Standing {
    std::uint32_t tag;  ///< of the domain solid
    double level;       ///< m, z
  };
  UnitWeight unit_weight = newtons_per_cubic_metre(9810);
  std::vector<Contact> contacts = {};  ///< by block, ascending
  std::vector<Standing> standing = {};
};

using geometry::Box;

/// A load on the part of a free surface inside a box. `traction` acts as given; `pressure` pushes against the rock
/// along each face's normal (support pressure is positive).
struct Surcharge {
  FreeSurface on = AnyFreeFace{};
  std::optional<Box> within = {};
  geometry::Vec3 traction = {};  ///< Pa
  Stress pressure = {};
};

/// A force at a point of a free face; a free face must lie within `reach`.
struct PointForce {
  geometry::Vec3 at;     ///< m
  geometry::Vec3 force;  ///< N
};
/// A force per length along a straight line on free faces.
struct LineForce {
  geometry::Vec3 from, to;   ///< m
  geometry::Vec3 per_metre;  ///< N/m
};
/// How far off a free face a point or a line may lie, m.
inline constexpr double reach = 0.05;

/// What acts on blocks beside gravity and seismic force.
struct ActionSpec {
  std::optional<WaterTable> water = {};
  /// Mean water pressure (Pa) in a joint, in place of the table there; by joint number, shorter lists end with none.
  std::vector<std::optional<double>> joint_pressure = {};
  /// By joint number, shorter lists end with 0: 1 where the table counts, too, on contacts where it presses more.
  std::vector<std::uint8_t> or_table = {};
  /// Beside neither table nor joint pressures.
  std::optional<FlowWater> flow = {};
  std::vector<Surcharge> surcharges = {};
  std::vector<PointForce> points = {};
  std::vector<LineForce> lines = {};
};

struct BadAction {
  std::string which;  ///< "water", "surcharge 2", ...
  std::string what;
};
[[nodiscard]] std::string describe(const BadAction& error);

/// Checked actions. Invariant: finite; unit weights and joint pressures >= 0; water of one kind; contacts of flow in
/// order; boxes and lines not reversed or empty.
class Actions final {
 public:
  Actions() = default;
  [[nodiscard]] static std::expected<Actions, BadAction> make(ActionSpec spec);
  [[nodiscard]] const ActionSpec& spec() const noexcept { return spec_; }
  /// No water at all, so that what acts on a block does not depend on its neighbours.
  [[nodiscard]] bool dry() const noexcept { return !spec_.water && !spec_.flow && spec_.joint_pressure.empty(); }
  /// The same with the water table, where there is one, at this level. Precondition: finite.
  [[nodiscard]] Actions with_water_level(double level) const;
  /// The same with this water in the joints. Precondition: no other; finite, unit weight >= 0, contacts in order.
  [[nodiscard]] Actions with_flow(FlowWater water) const;
  /// The same with the pressure of entry `from[k]` in joint k; an entry beyond the list is none.
  [[nodiscard]] Actions with_pressures_of(std::span<const std::size_t> from) const;

 private:
  ActionSpec spec_;
};

/// Where forces found no free face.
struct Misplaced {
  enum class Kind : std::uint8_t { surcharge, point, line } kind;
  std::size_t index;  ///< into surcharges, points or lines
  Length off;         ///< distance of the point; length of the line that lies on no free face; of surcharges nothing
};
[[nodiscard]] std::vector<Misplaced> misplaced(const topology::BlockComplex& complex, const Actions& actions);
/// Surcharges (by index) that in all pull at the free faces they act on: what a wrong sign looks like.
[[nodiscard]] std::vector<std::size_t> pulling_surcharges(const topology::BlockComplex& complex,
                                                          const Actions& actions);

/// A force on one block at a point: of what acts beside gravity and seismic force.
struct LoadOnBlock {
  topology::BlockId block;
  std::optional<topology::BlockId> neighbour = {};  ///< across the joint in which water presses; none: a free face
  geometry::Vec3 force;                             ///< N
  geometry::Vec3 at;                                ///< m: where the resultant acts
  Area contact = {};                                ///< of the two blocks, where there is a neighbour
};
/// All forces on these blocks (ascending), one by one, with the rock as it was cut; water in the joint of two of them
/// is listed for each. Where the table stands on free faces, too, it is all about a block: what is listed then is what
/// the joints have more, or less (pulls), than the table.
[[nodiscard]] std::vector<LoadOnBlock> loads_on(const topology::BlockComplex& complex, const Actions& actions,
                                                geometry::Vec3 gravity, std::span<const topology::BlockId> blocks);

}  // namespace cleave::stability
