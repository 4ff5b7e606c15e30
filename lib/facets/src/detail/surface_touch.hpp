#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "cleave/geometry/box_tree.hpp"
#include "cleave/geometry/vec3.hpp"
#include "detail/lattice_polygon.hpp"
#include "detail/weld.hpp"

namespace cleave::topology::detail {

/// Sides of joints given on the surface of an excavation, or of a domain that is not convex, miss it by the rounding of
/// their doubles and of its corners. What is that near is meant to reach it: its corners go just beyond.
class SurfaceTouch final {
 public:
  SurfaceTouch() = default;
  SurfaceTouch(const SurfaceTouch&) = delete;  // the tree looks at the boxes
  SurfaceTouch& operator=(const SurfaceTouch&) = delete;

  /// A face of a closed surface. `rock_behind`: the rock is on the side its normal points away from.
  void add(const LatticePolygon& face, bool rock_behind);
  /// All are added; `reach`: the farthest that counts as rounding, sites.
  void finish(double reach);

  /// Whether a polygon with these corners may lie on a face.
  [[nodiscard]] bool near(std::span<const exact::LatticePoint> corners) const;
  /// Looks which sides of a polygon lie on faces, and do not hold exactly there.
  void look(const LatticePolygon& polygon);
  /// Where the corners of these sides go, once all polygons were looked at.
  [[nodiscard]] Moves beyond();

 private:
  struct Face {
    exact::Plane plane;
    geometry::Vec3 out_of_rock;  ///< unit
    double offset;               ///< of the plane along that, sites
  };
  struct Triangle {
    std::array<geometry::Vec3, 3> corners;
    std::uint32_t face;
  };
  [[nodiscard]] bool holds(const Triangle& triangle, geometry::Vec3 a, geometry::Vec3 b) const;
  [[nodiscard]] exact::LatticePoint beyond(exact::LatticePoint corner,
                                           std::span<const std::pair<exact::LatticePoint, std::uint32_t>> on) const;

  std::vector<Face> faces_;
  std::vector<Triangle> triangles_;
  std::vector<geometry::Box> boxes_;
  std::optional<geometry::BoxTree> tree_;
  double reach_ = 0;
  std::vector<std::pair<exact::LatticePoint, std::uint32_t>> touching_;  ///< corner and face
};

}  // namespace cleave::topology::detail
