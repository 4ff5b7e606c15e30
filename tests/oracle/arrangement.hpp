#pragma once

/// Convex cells of all the planes in a box, with exact rational vertices. Slow and simple.

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "integer_scene.hpp"

namespace cleave::oracle {

/// Throws on overflow, so that a number too large can never pass unseen.
using Int = boost::multiprecision::checked_int512_t;
using Rational = boost::multiprecision::cpp_rational;

/// a x + b y + c z + d = 0 without common factor, the first coefficient that is not zero positive: equal planes are
/// equal.
using PlaneEquation = std::array<Int, 4>;
/// (x, y, z, w), w > 0, without common factor: equal points are equal.
using HomogeneousPoint = std::array<Int, 4>;

using Loop = std::vector<std::uint32_t>;

struct CellFace {
  std::uint32_t plane;
  int side;   ///< +1: the cell lies where the plane's equation is positive
  Loop loop;  ///< counter-clockwise seen from outside the cell
};
using Cell = std::vector<CellFace>;

/// Plane through three points that are not on one line.
[[nodiscard]] std::optional<PlaneEquation> plane_through(testing::IntegerPoint a, testing::IntegerPoint b,
                                                         testing::IntegerPoint c);
/// Plane of a polygon: its first three corners that are not on one line.
[[nodiscard]] PlaneEquation plane_of(const testing::IntegerPolygon& polygon);
/// Planes through the polygon's edges along its normal.
[[nodiscard]] std::vector<PlaneEquation> outline_planes(const testing::IntegerPolygon& polygon);

class Arrangement final {
 public:
  Arrangement(testing::IntegerPoint min, testing::IntegerPoint max);
  /// Splits every cell that the plane crosses. A plane twice is nothing new.
  void insert(const PlaneEquation& plane);

  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
  [[nodiscard]] const PlaneEquation& plane(std::uint32_t p) const { return planes_[p]; }
  [[nodiscard]] const HomogeneousPoint& vertex(std::uint32_t v) const { return vertices_[v]; }
  [[nodiscard]] std::optional<std::uint32_t> find(const PlaneEquation& plane) const;

  /// Parts of a convex loop on the negative and the positive side; empty when there is no area.
  [[nodiscard]] std::pair<Loop, Loop> split(const Loop& loop, const PlaneEquation& plane);
  /// A point strictly inside a convex loop.
  [[nodiscard]] HomogeneousPoint inside(const Loop& loop) const;
  /// A point strictly inside a cell.
  [[nodiscard]] HomogeneousPoint inside(const Cell& cell) const;

 private:
  static constexpr std::int8_t unknown = 2;

  void divide_by(const PlaneEquation& plane);
  [[nodiscard]] int side(std::uint32_t vertex);  ///< of the divider
  std::uint32_t intern(HomogeneousPoint point);
  std::uint32_t crossing(std::uint32_t a, std::uint32_t b);
  [[nodiscard]] Loop part(const Loop& loop, int keep);
  [[nodiscard]] Cell part(const Cell& cell, std::uint32_t plane, int keep);

  std::vector<PlaneEquation> planes_;
  std::map<PlaneEquation, std::uint32_t> plane_numbers_;
  std::vector<HomogeneousPoint> vertices_;
  std::map<HomogeneousPoint, std::uint32_t> vertex_numbers_;
  std::vector<Cell> cells_;
  PlaneEquation divider_;           // the plane that splits at the moment
  std::vector<std::int8_t> sides_;  // of vertices, as far as asked for
};

[[nodiscard]] int sign(const Int& value);
/// Value of the plane's equation at the point, times w.
[[nodiscard]] Int evaluate(const PlaneEquation& plane, const HomogeneousPoint& point);

}  // namespace cleave::oracle
