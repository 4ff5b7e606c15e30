#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
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

// ---- what has been mapped -------------------------------------------------------------------------------------------

// Random joints that honour what has been seen of them. The joints of a Poisson process that meet none of the faces and
// holes mapped are independent of those that do: the first are the joints of `sample` less those that would have been
// seen (`unseen`), the second are drawn anew, each given its traces and picks (`honour`).

/// A plane face of rock on which the traces of all joints were mapped.
struct MappedFace {
  geometry::Polygon outline;
};
/// A straight hole, or line along rock, all of whose joints were picked.
struct MappedHole {
  geometry::Vec3 from, to;
};
/// The trace of one joint on one face.
struct MappedTrace {
  std::size_t face = 0;
  std::array<geometry::Vec3, 2> ends;         ///< m, in the face's plane
  std::array<bool, 2> goes_on{false, false};  ///< the joint does not end there: the face does
  std::optional<geometry::Vec3> normal = {};  ///< unit, of the joint as it was measured there
};
/// Where a hole goes through a joint.
struct MappedPick {
  std::size_t hole = 0;
  geometry::Vec3 at;
  std::optional<geometry::Vec3> normal = {};  ///< unit, as it was measured
};
/// All that was seen of one joint: at least one trace or pick.
struct MappedJoint {
  std::optional<std::size_t> set = {};  ///< number of its set; none: not known, any of those mapped
  std::vector<MappedTrace> traces = {};
  std::vector<MappedPick> picks = {};
};

struct Mapping {
  std::vector<MappedFace> faces = {};
  std::vector<MappedHole> holes = {};
  std::vector<MappedJoint> joints = {};
  Length shortest = metres(0);  ///< shorter traces were not mapped
  Length error = metres(0.1);   ///< of the ends of a trace, and of what a joint shows beside what was mapped
  Angle<RotationKind> turn = Angle<RotationKind>::degrees(3);  ///< error of the direction of a trace on its face
};

/// Why the joints of a set cannot be drawn so that they honour a mapping; none where they can: centres by a Poisson
/// process (Baecher's model with an intensity, not a number), with ends.
[[nodiscard]] std::optional<ModelMismatch> cannot_honour(const JointSet& set);

/// The traces of a joint on a face longer than `shortest`; `goes_on` where the face's border ends them.
[[nodiscard]] std::vector<MappedTrace> traces_on(const SampledJoint& joint, const Mapping& mapping, std::size_t face);
/// Where a hole goes through a joint.
[[nodiscard]] std::optional<MappedPick> pick_in(const SampledJoint& joint, const Mapping& mapping, std::size_t hole);
/// Faces and holes as they are, with what these joints would show on them, each a joint of the set `set`.
void map(std::span<const SampledJoint> joints, std::size_t set, Mapping& mapping);

/// Those that show no trace and no pick: what is left of a set's joints beside those mapped.
[[nodiscard]] std::vector<SampledJoint> unseen(std::vector<SampledJoint> joints, const Mapping& mapping);

/// A joint drawn for what was seen of it.
struct HonouredJoint {
  std::size_t mapped;  ///< number in `Mapping::joints`
  std::size_t set;     ///< given, or drawn
  SampledJoint joint;  ///< its index: 2^31 + `mapped`
  /// The farthest that an end or a pick lies from what was mapped, or the longest trace that was not; infinite: a hole
  /// goes through that picked nothing, or misses what it picked.
  Length misfit;
  bool honours;  ///< misfit at most Mapping::error, and its set has joints that would be seen so
};

/// One joint for each of `Mapping::joints`, in their order: a draw of the laws of its set given what was seen of it.
/// Joint i depends only on (seed, realization, i), the mapping and the laws. Candidates are drawn by the laws, laid on
/// the longest trace, weighed by how likely they would show it, and rejected where they do not show the rest; where
/// none of many thousands does, the nearest one is taken and `honours` is false. Planes seen in several places are
/// fitted to them by least squares. Error: no candidate is a polygon at these coordinates. Precondition: sets of mapped
/// joints exist, and `cannot_honour` none of `sets` that is not null; null: not mapped.
[[nodiscard]] std::expected<std::vector<HonouredJoint>, SampleError> honour(std::span<const JointSet* const> sets,
                                                                            const Mapping& mapping, std::uint64_t seed,
                                                                            std::uint64_t realization);

/// The longest trace that a joint of this set can leave (m).
[[nodiscard]] Length longest_trace(const JointSet& set);

/// Joins mapped joints that meet at the border of two faces: the trace of one goes on where that of the other does,
/// within `Mapping::error`, nearest first. For each joint of before: its number now.
std::vector<std::size_t> join_round_corners(Mapping& mapping);

}  // namespace cleave::dfn
