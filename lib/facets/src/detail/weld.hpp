#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "cleave/exact/plane.hpp"

namespace cleave::topology::detail {

/// Corners that `snap` makes one: sites within the distance of each other, and so on from each to the next. A class
/// becomes the smallest of its sites, of those of solids if it has any: whichever order they were added in.
class Weld final {
 public:
  explicit Weld(double distance_sites) : distance_{distance_sites} {}
  void add(exact::LatticePoint site, bool of_solid) { sites_.emplace_back(site, !of_solid); }
  void finish();
  /// Precondition: it was added.
  [[nodiscard]] exact::LatticePoint operator()(exact::LatticePoint site) const;

 private:
  double distance_;
  std::vector<std::pair<exact::LatticePoint, bool>> sites_;  ///< with "of a joint"; sorted once finished
  std::vector<exact::LatticePoint> becomes_;
};

/// The site that a corner of several polygons becomes; by corner. Others stay.
class Moves final {
 public:
  void add(exact::LatticePoint from, exact::LatticePoint to) { moves_.emplace_back(from, to); }
  void finish();
  [[nodiscard]] bool empty() const noexcept { return moves_.empty(); }
  [[nodiscard]] exact::LatticePoint operator()(exact::LatticePoint site) const;

 private:
  std::vector<std::pair<exact::LatticePoint, exact::LatticePoint>> moves_;
};

}  // namespace cleave::topology::detail
