#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "cleave/dfn/joint_set.hpp"
#include "cleave/facets/cut_input.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::dfn {

/// Around the domain, m. Precondition of its users: finite, min < max in each axis.
using DomainBox = geometry::Box;

/// A persistent joint.
struct InfinitePlane {
  geometry::Vec3 through;
  geometry::Vec3 normal;  ///< unit, z >= 0
};

/// A joint as it was drawn: a rectangle with half sides `first` and `second` (sides = 0), or a disc, ellipse or regular
/// polygon whose corner i of `sides` lies at centre + first cos(2 pi i/sides) along + second sin(2 pi i/sides) across.
/// `with_polygons` writes the corners out, which takes longer than drawing.
struct JointOutline {
  geometry::Vec3 along, across;  ///< unit; along x across = the joint's normal
  double first, second;          ///< half sides, or half axes of the ellipse through the corners (m)
  std::uint32_t sides;
};

struct SampledJoint {
  /// Several polygons: triangles of one face whose corners other joints share (mosaic).
  std::variant<geometry::Polygon, InfinitePlane, std::vector<geometry::Polygon>, JointOutline> shape;
  geometry::Vec3 centre;
  geometry::Vec3 normal;  ///< unit, z >= 0
  std::uint32_t index;    ///< number of the joint in its set: the `index` of its random streams (friction and so on)
};

struct TooManyJoints {
  double expected;  ///< mean number to draw
  double allowed;
};
/// A joint too small to be a polygon at the scene's coordinates.
struct JointTooSmall {
  std::uint64_t index;
  geometry::PolygonError reason;
};
using SampleError = std::variant<TooManyJoints, JointTooSmall>;
[[nodiscard]] std::string describe(const SampleError& error);

/// The joints of one set in one realization, in order of their index.
///
/// Joint i depends only on (seed, realization, set_index, i): other sets, threads and the rest of the scene change
/// nothing. Joints drawn outside the box (in its grown region) that cannot reach it are left out; indices keep their
/// gaps. `set_index` is the number of the [[joint_set]] in the scene, from 0. `older`: the joints of the sets that the
/// model's `terminate_at` names, in its order, as polygons (enhanced Baecher and hierarchical models; others need
/// none). Round joints come as outlines where their polygons are certain to be valid.
[[nodiscard]] std::expected<std::vector<SampledJoint>, SampleError> sample(
    const JointSet& set, std::size_t set_index, const DomainBox& domain, std::uint64_t seed, std::uint64_t realization,
    std::span<const std::span<const SampledJoint>> older = {});

/// The same joints, with the corners of every outline written out.
[[nodiscard]] std::vector<SampledJoint> with_polygons(std::vector<SampledJoint> joints);

/// A joint for the cutter (`topology::CutInput::joints`): its polygons, of an outline those that `with_polygons`
/// writes, or its plane.
[[nodiscard]] std::variant<topology::Joint, topology::PersistentJoint> joint_of(SampledJoint joint);

/// The sets a model of this set ends at.
[[nodiscard]] std::span<const std::size_t> terminates_at(const JointSet& set) noexcept;

/// Mean number of joints that `sample` draws, kept or not (the cost of a scene).
[[nodiscard]] double expected_draws(const JointSet& set, const DomainBox& domain) noexcept;

}  // namespace cleave::dfn
