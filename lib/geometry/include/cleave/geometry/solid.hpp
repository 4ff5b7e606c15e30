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
  std::size_t vertex;  ///< not finite
};
struct BadFace {
  std::size_t face;  ///< fewer than three corners, an index out of range, or a corner twice
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
  Volume volume;  ///< negative
};
struct NoVolume {
  Volume volume;
};
struct FacesCross {
  std::size_t first, second;  ///< two faces without a common vertex that cross
};
using SolidError = std::variant<NoFaces, BadVertex, BadFace, OpenEdge, NonManifoldEdge, InconsistentEdge, InsideOut,
                                NoVolume, FacesCross>;
[[nodiscard]] std::string describe(const SolidError& error);

/// A closed polyhedral surface, one or several shells, faces outwards.
///
/// Invariant: every edge is used by exactly two faces, once in each direction; volume > 0; faces without a common
/// vertex do not cross. Faces of four and more corners may be slightly bent: whoever cuts with it uses exact triangles then.
class Solid final {
 public:
  [[nodiscard]] static std::expected<Solid, SolidError> make(std::vector<Vec3> vertices, std::vector<SolidFace> faces,
                                                             std::vector<std::string> tags = {});

  [[nodiscard]] std::span<const Vec3> vertices() const noexcept { return vertices_; }
  [[nodiscard]] std::span<const SolidFace> faces() const noexcept { return faces_; }
  [[nodiscard]] std::span<const std::string> tags() const noexcept { return tags_; }
  /// Signed volume by the divergence theorem about the first vertex; > 0.
  [[nodiscard]] Volume volume() const noexcept;
  /// True for a hexahedron or box whose six faces are meant as half-spaces: the cutter then takes the six planes
  /// (each through three corners of its face) and their common inside, so a quad that is bent by rounding stays one face.
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

/// Axis-parallel box; tags west east south north bottom top (x-, x+, y-, y+, z-, z+) in this order. min < max in each axis.
[[nodiscard]] std::expected<Solid, SolidError> make_box(Vec3 min, Vec3 max);

/// Hexahedron on eight corners; bit 0, 1, 2 of the index = x, y, z side. Faces carry the box's tags by these bits. The
/// corners must make a convex body with planar faces (within the tolerance of Polygon); else a SolidError.
[[nodiscard]] std::expected<Solid, SolidError> make_hexahedron(const std::array<Vec3, 8>& corners);

}  // namespace cleave::geometry
