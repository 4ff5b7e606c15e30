#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "cleave/facets/prepared.hpp"
#include "detail/lattice_polygon.hpp"

namespace cleave::topology::detail {

using Side = std::pair<exact::LatticePoint, exact::LatticePoint>;
/// The side between two corners, whichever way it is walked.
[[nodiscard]] inline Side side_of(exact::LatticePoint a, exact::LatticePoint b) {
  return a < b ? Side{a, b} : Side{b, a};
}

/// Which corners and sides joint polygons have in common, by site. A polygon given twice counts once: repeating a joint
/// changes nothing.
class SharedCorners final {
 public:
  void add(std::span<const exact::LatticePoint> corners);
  /// Forgets the polygons, not the surfaces.
  void clear();
  /// A side of a face of a closed surface, which holds it exactly.
  void add_surface_side(exact::LatticePoint a, exact::LatticePoint b) { surface_sides_.push_back(side_of(a, b)); }
  /// All are added.
  void finish();

  [[nodiscard]] bool any() const noexcept { return !sites_.empty(); }
  [[nodiscard]] bool any_side() const noexcept { return !sides_.empty(); }
  /// All corners that more than one polygon has, sorted.
  [[nodiscard]] std::span<const exact::LatticePoint> sites() const noexcept { return sites_; }
  /// Whether more than one polygon has the corner.
  [[nodiscard]] bool shared(exact::LatticePoint corner) const;
  /// Whether another polygon or a closed surface has the side.
  [[nodiscard]] bool shared(exact::LatticePoint a, exact::LatticePoint b) const;
  /// Whether a closed surface has the side.
  [[nodiscard]] bool of_surface(exact::LatticePoint a, exact::LatticePoint b) const {
    return std::ranges::binary_search(surface_sides_, side_of(a, b));
  }
  /// Which of these corners are shared.
  [[nodiscard]] std::vector<std::size_t> among(std::span<const exact::LatticePoint> corners) const;
  /// The first polygon added that has the same corners; itself where it is the first.
  [[nodiscard]] Index first_like(Index polygon) const;

 private:
  struct Repeated {
    Index polygon, first;
  };
  void find_sides(std::span<const Index> distinct);

  std::vector<exact::LatticePoint> corners_;  ///< of all polygons, in their order
  std::vector<std::size_t> begin_{0};
  std::vector<exact::LatticePoint> sites_;   ///< shared, sorted
  std::vector<Side> sides_, surface_sides_;  ///< sorted
  std::vector<Repeated> repeated_;           ///< by polygon
};

}  // namespace cleave::topology::detail
