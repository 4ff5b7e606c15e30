#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cleave/geometry/box_tree.hpp"
#include "cleave/geometry/vec3.hpp"
#include "detail/lattice_polygon.hpp"
#include "detail/shared_corners.hpp"
#include "detail/weld.hpp"

namespace cleave::topology::detail {

/// What sides of joints may be drawn to end on: faces of closed surfaces, polygons and planes of joints.
struct SurfaceFaces {
  struct Face {
    exact::Plane plane;
    geometry::Vec3 normal;  ///< unit; out of the rock where that is known
    double offset;          ///< of the plane along that, sites
    Index joint = none;
  };
  struct Triangle {
    std::array<geometry::Vec3, 3> corners;
    std::uint32_t face;
  };
  std::vector<Face> faces = {};
  std::vector<Triangle> triangles = {};
  std::vector<std::uint32_t> endless = {};  ///< faces that are planes

  /// A face of a closed surface. `rock_behind`: the rock is on the side its normal points away from.
  void add(const LatticePolygon& face, bool rock_behind);
  /// A polygon of a joint, or the plane of one without an end: what ends on it may come from either side.
  void add(const LatticePolygon& face, Index joint);
  void add(const exact::Plane& plane, Index joint);

 private:
  void add_triangles(const LatticePolygon& face);
};

/// Sides of joints given on the surface of an excavation, of a domain that is not convex, or on another joint, miss it
/// by the rounding of their doubles and of its corners. What is that near is meant to reach it: its corners go just
/// beyond.
class SurfaceTouch final {
 public:
  /// `reach`: the farthest that counts as rounding, sites. No face comes to `on` any more.
  SurfaceTouch(const SurfaceFaces& on, double reach);
  SurfaceTouch(const SurfaceTouch&) = delete;  // the tree looks at the boxes
  SurfaceTouch& operator=(const SurfaceTouch&) = delete;

  /// Whether a polygon with these corners may lie on a face.
  [[nodiscard]] bool near(std::span<const exact::LatticePoint> corners) const;
  /// Looks which sides of a polygon lie on faces, and do not hold exactly there.
  void look(const LatticePolygon& polygon);
  /// On faces of these joints, with the sides that no other polygon has.
  void look(const LatticePolygon& polygon, std::span<const Index> joints, const SharedCorners& shared);
  /// Where the corners of these sides go, once all polygons were looked at.
  [[nodiscard]] Moves beyond();

 private:
  /// A corner of a side on a face, and whether it goes against the face's normal.
  struct Touching {
    exact::LatticePoint corner;
    std::uint32_t face;
    bool against;
    friend auto operator<=>(const Touching&, const Touching&) = default;
  };
  [[nodiscard]] bool in_plane(const SurfaceFaces::Face& face, geometry::Vec3 a, geometry::Vec3 b) const;
  [[nodiscard]] bool holds(const SurfaceFaces::Triangle& triangle, geometry::Vec3 a, geometry::Vec3 b) const;
  [[nodiscard]] std::vector<std::uint32_t> near(const LatticePolygon& polygon, std::span<const Index> joints) const;
  void look(const LatticePolygon& polygon, std::span<const Index> joints, const SharedCorners* shared);
  [[nodiscard]] exact::LatticePoint beyond(exact::LatticePoint corner, std::span<const Touching> on) const;

  const SurfaceFaces& on_;
  double reach_;
  std::vector<geometry::Box> boxes_;
  std::optional<geometry::BoxTree> tree_;
  std::vector<Touching> touching_;
};

}  // namespace cleave::topology::detail
