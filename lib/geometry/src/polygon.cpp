#include "cleave/geometry/polygon.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/triangulate.hpp"
#include "outline.hpp"
#include "predicates.hpp"

namespace cleave::geometry {
namespace {

bool is_convex(const Outline& outline) {
  const std::size_t n = outline.corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (orient2d(outline.seen(i), outline.seen((i + 1) % n), outline.seen((i + 2) % n)) == exact::Sign::negative) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::expected<Polygon, PolygonError> Polygon::make(std::vector<Vec3> corners) {
  CLEAVE_TRY(Outline outline, Outline::measure(corners));
  if (outline.distance > outline.allowed) {
    return std::unexpected(NotPlanar{outline.furthest, metres(outline.distance), metres(outline.allowed)});
  }
  const bool convex = is_convex(outline);
  return Polygon{std::move(outline.corners), convex};
}

std::expected<std::vector<Polygon>, PolygonError> Polygon::triangulated(std::vector<Vec3> corners) {
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  CLEAVE_TRY(const Triangles triangles, triangulate(corners));
  std::vector<Polygon> pieces;
  pieces.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) {
    pieces.push_back(Polygon{{flushed(corners[a]), flushed(corners[b]), flushed(corners[c])}, true});
  }
  return pieces;
}

std::string describe(const PolygonError& error) {
  return std::visit(
      overloaded{
          [](TooFewCorners e) {
            return fmt::format("a polygon needs at least three corners, this one has {}; add the missing corners",
                               e.corners);
          },
          [](NonFiniteCorner e) {
            return fmt::format(
                "corner {} is not a usable position (not a number, infinite, or beyond 1e12 m); correct its "
                "coordinates",
                e.corner);
          },
          [](ZeroArea) {
            return std::string{
                "all corners lie on one line or in one point, so the polygon has no area; give at least three "
                "corners that are not on one line"};
          },
          [](NotPlanar e) {
            return fmt::format(
                "corner {} lies {:.3g} m off the best-fit plane, allowed is {:.3g} m; correct the corners, or set "
                "nonplanar = "
                "\"triangulate\"",
                e.corner, e.distance.si(), e.allowed.si());
          },
          [](SelfCrossing e) {
            return fmt::format(
                "edges {} and {} cross, touch or overlap (edge i starts at corner i, counted from 0); list the corners "
                "in order "
                "around the outline",
                e.first_edge, e.second_edge);
          },
      },
      error);
}

}  // namespace cleave::geometry
