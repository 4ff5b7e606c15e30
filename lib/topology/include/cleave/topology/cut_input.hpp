#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/topology/ids.hpp"

namespace cleave::topology {

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
  /// Keeps the parts of joints that separate nothing (BlockComplex::Data::dangling). The blocks are the same.
  bool keep_dangling = false;
  /// Only what lies in this box is cut, on the lattice of the whole scene: blocks that do not reach the window's sides
  /// are those of the whole scene, with the same corners; the others are marked truncated.
  std::optional<Window> window = {};
};

}  // namespace cleave::topology
