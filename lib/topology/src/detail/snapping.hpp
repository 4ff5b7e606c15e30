#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "cleave/exact/lattice.hpp"
#include "cleave/geometry/box_tree.hpp"
#include "cleave/geometry/vec3.hpp"
#include "detail/lattice_polygon.hpp"
#include "detail/prepared.hpp"

namespace cleave::topology::detail {

/// The only tolerance of the cutter, at its border: with a snapping distance > 0, corners closer than it become one
/// lattice site, a polygon all of whose corners lie that close to the plane of an earlier polygon near it takes that
/// plane, and a joint's side that lies that close to another polygon ends on that polygon's plane. Polygons are near
/// each other when their boxes, grown by the distance, meet; a tree over the boxes finds them, so the cost is O(n log
/// n) where few do. With distance 0 it only rounds to the lattice. What was moved is recorded.
class Snapper final {
 public:
  Snapper(const exact::Lattice& lattice, double distance_m);

  [[nodiscard]] bool active() const noexcept { return distance_ > 0; }
  [[nodiscard]] exact::LatticePoint site(geometry::Vec3 p);
  /// From here on moves are put down to this joint.
  void begin_joint(Index joint) noexcept { joint_ = joint; }
  /// A surface that later polygons may snap to.
  void remember(const LatticePolygon& polygon);
  void remember(const exact::Plane& persistent);
  /// All polygons that may take other planes, once the solids and persistent joints are remembered.
  void begin_merging(std::span<const LatticePolygon* const> polygons);
  /// For each of them, in that order.
  void merge_plane(LatticePolygon& polygon);
  /// For each side of the polygon (corner i to i + 1) the half-space it ends on, if any.
  [[nodiscard]] std::vector<std::optional<HalfSpace>> adopt_edges(
      const LatticePolygon& polygon, const std::function<std::pair<Index, bool>(const exact::Plane&)>& number_of);

  [[nodiscard]] double largest_move() const noexcept { return largest_move_; }
  /// The joints that were changed, by number.
  [[nodiscard]] std::vector<SnappedJoint> changed() const;
  [[nodiscard]] std::uint64_t merged_planes() const noexcept { return merged_planes_; }
  [[nodiscard]] std::uint64_t adopted_edges() const noexcept { return adopted_edges_; }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& cell) const noexcept;
  };
  [[nodiscard]] double distance_sites(const exact::Plane& plane, exact::LatticePoint p) const;
  [[nodiscard]] bool near_polygon(const LatticePolygon& polygon, exact::LatticePoint p) const;
  [[nodiscard]] geometry::Bounds bounds_of(std::span<const exact::LatticePoint> corners) const;
  /// Numbers of the surfaces near a box, persistent ones too, ascending.
  [[nodiscard]] std::vector<std::size_t> near(const geometry::Bounds& box) const;

  /// Puts a move down to the joint in hand.
  SnappedJoint& note(double moved_m);

  exact::Lattice lattice_;
  double distance_;                                                             ///< m
  double distance_sites_;                                                       ///< lattice sites
  std::unordered_map<Cell, std::vector<exact::LatticePoint>, CellHash> cells_;  ///< sites given so far
  std::vector<LatticePolygon> surfaces_;  ///< solids, persistent joints, then polygons as their planes are settled
  std::vector<std::size_t> persistent_;   ///< which of them have no end
  std::vector<std::size_t> boxed_;        ///< which surface each box is of
  std::vector<geometry::Bounds> boxes_;
  std::unique_ptr<geometry::BoxTree> tree_;  ///< over `boxes_`
  Index joint_ = none;
  std::map<Index, SnappedJoint> changed_;
  double largest_move_ = 0;
  std::uint64_t merged_planes_ = 0, adopted_edges_ = 0;
};

}  // namespace cleave::topology::detail
