#pragma once

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "cleave/core/vec2.hpp"
#include "cleave/dfn/sample.hpp"

namespace cleave::dfn::detail {

/// A plane with axes of its own.
struct FlatFrame {
  geometry::Vec3 origin, normal, x, y;  ///< m; unit, x cross y = normal

  [[nodiscard]] Vec2 flat(geometry::Vec3 p) const noexcept { return {dot(p - origin, x), dot(p - origin, y)}; }
  [[nodiscard]] double above(geometry::Vec3 p) const noexcept { return dot(p - origin, normal); }
};
/// Precondition: `normal` is not zero.
[[nodiscard]] FlatFrame flat_frame(geometry::Vec3 origin, geometry::Vec3 normal) noexcept;

/// A stretch of a line, m.
using Stretch = std::pair<geometry::Vec3, geometry::Vec3>;

/// A face as traces are looked for on it.
struct Face {
  FlatFrame frame;
  std::vector<Vec2> outline;
  geometry::Box box;
};
[[nodiscard]] Face face_of(const MappedFace& face);

/// A joint with its corners, none of a plane without end.
struct SolidJoint {
  geometry::Vec3 centre, normal;
  std::vector<std::vector<geometry::Vec3>> polygons;
  geometry::Box box;
};
[[nodiscard]] SolidJoint solid_joint(const SampledJoint& joint);

/// The traces of a joint on a face, however short.
[[nodiscard]] std::vector<MappedTrace> all_traces(const SolidJoint& joint, const Face& face, std::size_t number);
/// Where a hole goes through a joint.
[[nodiscard]] std::optional<geometry::Vec3> crossing(const SolidJoint& joint, const MappedHole& hole);

[[nodiscard]] inline double length(const MappedTrace& trace) noexcept { return norm(trace.ends[1] - trace.ends[0]); }

}  // namespace cleave::dfn::detail
