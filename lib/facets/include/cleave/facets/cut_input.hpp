#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cleave/core/id.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/solid.hpp"

/// What the cutter is given, what can be wrong with it, and what is said about it: the floor below the cutter, which
/// makes convex facets on a lattice of it. It shares the namespace of the cutter.
namespace cleave::topology {

using JointId = Id<struct JointTag>;  ///< a joint of the scene, in scene order

/// One joint (discontinuity): a polygon, or several that make one surface (a triangulated fault, a triangulated bent
/// quad).
struct Joint {
  std::vector<geometry::Polygon> polygons;
  /// Holes of each polygon, in its plane (within the tolerance of Polygon), inside it and apart from each other; as
  /// many entries as polygons, or fewer where the rest has none.
  std::vector<std::vector<geometry::Polygon>> holes = {};
};

/// `joint` ends on `at`: the part of it beyond the plane of `at` is taken away, exactly. What stays is the part that
/// holds its middle (for a persistent joint: the point it goes through). The plane counts, however far `at` itself
/// reaches.
struct Termination {
  JointId joint, at;
};

/// A persistent joint is given as a plane through a point with a unit normal; it cuts the whole domain.
struct PersistentJoint {
  geometry::Vec3 through;
  geometry::Vec3 normal;
};

/// An axis-parallel box, m.
struct Window {
  geometry::Vec3 min, max;  ///< min < max in each component
};

/// Everything the block cutter needs, in metres, validated piece by piece by the geometry types.
struct CutInput {
  geometry::Solid domain;
  std::vector<std::variant<Joint, PersistentJoint>> joints = {};  ///< JointId = index
  std::vector<geometry::Solid> excavations = {};  ///< in order; they may overlap each other and leave the domain
  /// Domain faces (by tag index of the domain solid) that are free; all others are fixed.
  std::vector<std::uint32_t> free_domain_tags = {};
  /// > 0: near-coincident planes are merged and joint edges within this distance of another joint adopt its plane.
  Length snap = metres(0);
  std::vector<Termination> terminations = {};
  /// Where joints lie on one another their face is of the one with the smallest number here, of equals of the first
  /// joint. One a joint; joints beyond its end come last, by number.
  std::vector<std::uint32_t> precedence = {};
  /// Keeps the parts of joints that separate nothing (BlockComplex::dangling). The blocks are the same.
  bool keep_dangling = false;
  /// Keeps the joints cut along each other, in triangles (BlockComplex::network). The blocks are the same.
  bool keep_network = false;
  /// Only what lies in this box is cut, on the lattice of the whole scene: blocks that do not reach the window's sides
  /// are those of the whole scene, with the same corners; the others are marked truncated.
  std::optional<Window> window = {};
};

// ---- What is wrong with it
// -------------------------------------------------------------------------------------------

struct JointCollapsed {  ///< a joint polygon too small for the lattice
  JointId joint;
  Length pitch;
};
struct SolidCollapsed {  ///< a face of the domain (no excavation index) or of an excavation too small for the lattice
  std::optional<std::uint32_t> excavation;
  std::uint32_t face;
  Length pitch;
};
struct TerminationUndecided {  ///< a joint ends on another whose plane passes through its middle, or is no one plane
  JointId joint, at;
};
struct DomainSwallowed {};  ///< the excavations leave no rock
struct WindowOutside {};    ///< the window and the domain's box have no volume in common
struct TooLarge {           ///< more than 2^31 vertices, edges or faces
  std::string what;
};
struct NotFinite {  ///< a number that is none, or infinite; a normal without length counts
  std::string what;
  std::optional<JointId> joint;
};
struct SnapNegative {
  Length snap;
};
struct UnknownTag {  ///< of a free side that the domain does not have
  std::uint32_t tag;
};
struct UnknownJoint {  ///< of a termination
  JointId joint;
};
using CutError = std::variant<JointCollapsed, SolidCollapsed, TerminationUndecided, DomainSwallowed, WindowOutside,
                              TooLarge, NotFinite, SnapNegative, UnknownTag, UnknownJoint>;
[[nodiscard]] std::string describe(const CutError& error);

// ---- What is said about it
// -------------------------------------------------------------------------------------------

/// What CutInput::snap changed of a joint.
struct SnappedJoint {
  JointId joint;
  Length moved;       ///< the farthest that a corner, or a corner of a side, was from where it is now meant to be
  bool plane_merged;  ///< one of its polygons took an earlier polygon's plane
  std::uint32_t adopted_edges;  ///< sides that now end on another polygon's plane
};

/// Sides of joints that end less than 1e-6 of the domain's extent from another polygon without touching it: rock that
/// was perhaps meant to be parted there is not. `CutInput::snap` of a little more than the largest closes them.
struct NearMisses {
  std::uint64_t sides = 0;
  Length largest;
  JointId joint = JointId{0U};   ///< whose side is the farthest off
  std::optional<JointId> other;  ///< from this joint; none: from the domain or an excavation
};

/// Polygons with sides shorter than twice CutInput::snap: their corners become one or pass each other, so that what
/// they part may be other than what was meant. A `snap` of less than half the shortest keeps all of them as they are.
struct CoarseSnap {
  std::uint64_t polygons = 0;
  Length shortest;              ///< side
  JointId joint = JointId{0U};  ///< whose side that is
};

}  // namespace cleave::topology
