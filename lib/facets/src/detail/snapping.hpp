#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "cleave/exact/plane.hpp"
#include "cleave/geometry/box_tree.hpp"
#include "cleave/geometry/vec3.hpp"
#include "detail/joint_polygon.hpp"
#include "detail/shared_corners.hpp"
#include "detail/weld.hpp"

namespace cleave::topology::detail {

/// The only tolerance of the cutter, at its border. With a snapping distance d > 0
///   1. corners closer than d, and those closer than d to these, become one lattice site (Weld);
///   2. polygons near each other whose corners lie within d of the plane of one of them take that plane, unless a side
///      that they share with others would come off it;
///   3. a joint's side of its own that lies within d of another polygon ends on that polygon's plane.
/// Nothing depends on the order of the joints. Polygons are near each other when their boxes, grown by d, meet; a tree
/// over the boxes finds them. With distance 0 it only rounds to the lattice. What was moved is recorded.
class Snapper final {
 public:
  Snapper(const exact::Lattice& lattice, double distance_m);

  [[nodiscard]] bool active() const noexcept { return distance_ > 0; }
  /// All corners first, those of solids and of joints; then `weld`; then `site` says what became of each.
  void add_corner(geometry::Vec3 p, bool of_solid);
  void weld() { weld_.finish(); }
  [[nodiscard]] exact::LatticePoint site(geometry::Vec3 p, Index joint);
  /// Notes a polygon with a side so short that its ends may be moved past each other.
  void compare(std::span<const geometry::Vec3> corners, Index joint);
  /// A surface that polygons may snap to.
  /// `reached_by_corners`: polygons that are not convex end on it by their corners, not by its plane.
  void remember(const LatticePolygon& polygon, bool reached_by_corners);
  void remember(const exact::Plane& persistent);

  /// Gives polygons that are meant to lie on one plane that plane.
  void merge_planes(std::vector<JointPolygon>& polygons, const SharedCorners& shared);
  /// After the planes: for each side of the polygon (corner i to i + 1) the half-space it ends on, if any.
  [[nodiscard]] std::vector<std::optional<HalfSpace>> adopt_edges(
      std::span<const JointPolygon> polygons, std::size_t which, const SharedCorners& shared,
      const std::function<std::pair<Index, bool>(const exact::Plane&)>& number_of);
  /// Where shared corners go that lie within the distance of another polygon: just through it, if all polygons there
  /// are on one side of it.
  [[nodiscard]] Moves moves_through(std::span<const JointPolygon> polygons, const SharedCorners& shared);

  [[nodiscard]] double largest_move() const noexcept { return largest_move_; }
  [[nodiscard]] const CoarseSnap& coarse() const noexcept { return coarse_; }
  /// The joints that were changed, by number.
  [[nodiscard]] std::vector<SnappedJoint> changed() const;
  [[nodiscard]] std::uint64_t merged_planes() const noexcept { return merged_planes_; }
  [[nodiscard]] std::uint64_t adopted_edges() const noexcept { return adopted_edges_; }

 private:
  void index(std::span<const JointPolygon> polygons);
  [[nodiscard]] const LatticePolygon& surface(std::span<const JointPolygon> polygons, std::size_t k) const {
    return k < surfaces_.size() ? surfaces_[k] : polygons[k - surfaces_.size()].polygon;
  }
  [[nodiscard]] bool near_polygon(const LatticePolygon& polygon, exact::LatticePoint p) const;
  [[nodiscard]] bool near_plane(const LatticePolygon& polygon, const exact::Plane& plane) const;
  [[nodiscard]] geometry::Box bounds_of(std::span<const exact::LatticePoint> corners) const;
  /// Numbers of the surfaces near a box, persistent ones too, ascending.
  [[nodiscard]] std::vector<std::size_t> near(const geometry::Box& box) const;
  [[nodiscard]] std::vector<std::size_t> group_about(std::span<const JointPolygon> polygons, std::size_t leader,
                                                     const std::vector<std::uint8_t>& taken) const;
  void take_plane(JointPolygon& entry, const LatticePolygon& leader);

  /// Puts a move down to a joint.
  SnappedJoint& note(Index joint, double moved_m);

  exact::Lattice lattice_;
  double distance_;        ///< m
  double distance_sites_;  ///< lattice sites
  Weld weld_;
  std::vector<LatticePolygon> surfaces_;  ///< faces of solids and persistent joints; joint polygons are numbered on
  std::vector<std::size_t> persistent_;   ///< which of them have no end
  std::vector<std::size_t> by_corners_;   ///< which of them polygons that are not convex reach by their corners
  std::vector<std::size_t> boxed_;        ///< which surface each box is of
  std::vector<geometry::Box> boxes_;
  std::unique_ptr<geometry::BoxTree> tree_;  ///< over `boxes_`
  std::map<Index, SnappedJoint> changed_;
  CoarseSnap coarse_;
  double largest_move_ = 0;
  std::uint64_t merged_planes_ = 0, adopted_edges_ = 0;
};

}  // namespace cleave::topology::detail
