#pragma once

#include <cstddef>
#include <expected>
#include <vector>

#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/predicates.hpp"

namespace cleave::geometry {

/// A closed ring of corners, measured: what Polygon and the triangulation both need to know about it.
/// Invariant: at least three corners, none repeated in a row, in range, wider than rounding, and no two edges meet when
/// seen along the dominant axis of `normal`. How far it is from planar is reported, not judged.
struct Outline {
  std::vector<Vec3> corners;        ///< repeated ones removed
  std::vector<std::size_t> source;  ///< number of each corner in the list that was given
  Vec3 normal;                      ///< unit, best-fit plane; corners turn counter-clockwise seen from its tip
  int axis = 2;                     ///< dominant axis of `normal`
  bool flipped = false;             ///< dropping `axis` shows the corners clockwise
  double allowed = 0;               ///< m, distance from the best-fit plane up to which it counts as planar
  double distance = 0;              ///< m, of the furthest corner from that plane
  std::size_t furthest = 0;         ///< that corner, as given

  [[nodiscard]] Vec2 seen(std::size_t i) const noexcept {
    const Vec2 p = drop(corners[i], axis);
    return flipped ? Vec2{p.y, p.x} : p;
  }

  /// Any PolygonError but NotPlanar.
  [[nodiscard]] static std::expected<Outline, PolygonError> measure(const std::vector<Vec3>& given);
};

}  // namespace cleave::geometry
