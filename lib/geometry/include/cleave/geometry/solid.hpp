#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::geometry {

/// One flat face of a solid: indices into the solid's vertices, counter-clockwise seen from outside. No holes.
struct SolidFace {
  std::vector<std::uint32_t> corners;
  /// What the user calls this face; index into the solid's `tags()` ("top", "west", "wall", ...).
  std::uint32_t tag = 0;
};

struct NoFaces {};
struct BadVertex {
  std::size_t vertex;  ///< not a number, infinite, or a coordinate beyond 1e12 m
};
/// What can be wrong with one face by itself.
enum class FaceFault : std::uint8_t { too_few_corners, index_out_of_range, corner_twice, no_area, crosses_itself };
struct BadFace {
  std::size_t face;
  FaceFault fault = FaceFault::too_few_corners;
};
struct OpenEdge {
  std::uint32_t from, to;  ///< vertex numbers from 0
  Vec3 a, b;
};
struct NonManifoldEdge {
  std::uint32_t from, to;
  std::size_t uses;  ///< more than two faces
  Vec3 a, b;
};
struct InconsistentEdge {  ///< two faces use it in the same sense
  std::uint32_t from, to;
  Vec3 a, b;
};
struct InsideOut {
  Volume volume;  ///< of the shell that looks the wrong way: negative, or positive for a cavity that faces outwards
};
struct NoVolume {
  Volume volume;
};
struct FacesCross {
  std::size_t first, second;  ///< two faces that cross, overlap, or touch elsewhere than in the vertices they share
};
struct FaceNotPlanar {  ///< only make_hexahedron asks for planar faces
  std::size_t face;
  std::uint32_t vertex;  ///< the one furthest off
  Length distance;       ///< from the best-fit plane
  Length allowed;
};
struct NotConvex {  ///< only make_hexahedron asks for it
  std::size_t face;
  std::uint32_t vertex;  ///< lies on or beyond the plane of that face
};
using SolidError = std::variant<NoFaces, BadVertex, BadFace, OpenEdge, NonManifoldEdge, InconsistentEdge, InsideOut,
                                NoVolume, FacesCross, FaceNotPlanar, NotConvex>;
/// "what is wrong; what to do", in words for an engineer. Vertices and faces are numbered from 0.
[[nodiscard]] std::string describe(const SolidError& error);

/// A closed polyhedral surface, one or several shells, faces outwards.
///
/// Invariant: every edge is used by exactly two faces, once in each direction; each shell looks outwards, or inwards
/// when it lies in another one (a cavity); volume > 0; two faces have nothing in common but vertices and edges they
/// share. Vertices at one place count as shared. Faces of four and more corners may be bent: whoever cuts with it then
/// uses the triangles of `triangulate`, the ones that were checked here.
class Solid final {
 public:
  /// The face tags index `tags`; without tags all must be 0. Of several faults the first found is reported, looked for
  /// in this order: vertices, corner lists, edges (lowest vertex numbers first), areas of faces, volume, crossings,
  /// shells. O(n log n).
  [[nodiscard]] static std::expected<Solid, SolidError> make(std::vector<Vec3> vertices, std::vector<SolidFace> faces,
                                                             std::vector<std::string> tags = {});

  [[nodiscard]] std::span<const Vec3> vertices() const noexcept { return vertices_; }
  [[nodiscard]] std::span<const SolidFace> faces() const noexcept { return faces_; }
  [[nodiscard]] std::span<const std::string> tags() const noexcept { return tags_; }
  /// By the divergence theorem about the first vertex (bent faces: the fan about their first corner), compensated sum;
  /// > 0.
  [[nodiscard]] Volume volume() const noexcept;
  /// True for a hexahedron or box whose six faces are meant as half-spaces: the cutter then takes the six planes
  /// (each through three corners of its face) and their common inside, so a quad that is bent by rounding stays one
  /// face.
  [[nodiscard]] bool from_half_spaces() const noexcept { return half_spaces_; }
  [[nodiscard]] Solid with_half_spaces() && {
    half_spaces_ = true;
    return std::move(*this);
  }

 private:
  Solid(std::vector<Vec3> vertices, std::vector<SolidFace> faces, std::vector<std::string> tags)
      : vertices_{std::move(vertices)}, faces_{std::move(faces)}, tags_{std::move(tags)} {}
  std::vector<Vec3> vertices_;
  std::vector<SolidFace> faces_;
  std::vector<std::string> tags_;
  bool half_spaces_ = false;
};

/// Axis-parallel box as half-spaces; tags west east south north bottom top (x-, x+, y-, y+, z-, z+) in this order, one
/// face each; vertex bits 0, 1, 2 = x, y, z side. min < max in each axis, else NoVolume.
[[nodiscard]] std::expected<Solid, SolidError> make_box(Vec3 min, Vec3 max);

/// Hexahedron on eight corners as half-spaces; bit 0, 1, 2 of the index = x, y, z side. Faces carry the box's tags by
/// these bits, whatever way they look; an order of corners that mirrors the body is put right. The corners must make a
/// convex body with planar faces (within the tolerance of Polygon); else BadFace, FaceNotPlanar, NotConvex or NoVolume.
/// With BentFaces::triangulate a body with a bent face is a closed surface as any other, which need not be convex.
enum class BentFaces : std::uint8_t { refuse, triangulate };
[[nodiscard]] std::expected<Solid, SolidError> make_hexahedron(const std::array<Vec3, 8>& corners,
                                                               BentFaces bent = BentFaces::refuse);

}  // namespace cleave::geometry
