#include "cleave/geometry/polygon.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/predicates.hpp"
#include "cleave/geometry/triangulate.hpp"
#include "outline.hpp"

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

/// What `flushed` gives back bit by bit.
bool is_plain(double x) { return std::abs(x) >= 1e-60 || (x == 0 && !std::signbit(x)); }

/// True for a ring that `Outline` finds fine and convex by a wide margin: flat, far from thin, turning at every corner
/// the same way and once around. Most rings are, and many are drawn: this looks at them without a copy. False says
/// nothing.
bool plainly_convex(std::span<const Vec3> ring) {
  const std::size_t n = ring.size();
  if (n < 3) return false;
  Box box;
  Vec3 area{}, sum{};
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 p = ring[i];
    if (!in_range(p) || !is_plain(p.x) || !is_plain(p.y) || !is_plain(p.z)) return false;
    box.add(p);
    sum += p - ring[0];
    if (i >= 2) area += cross(ring[i - 1] - ring[0], p - ring[0]);
  }
  const auto& [low, high] = box;
  const double size = norm(box.size()), twice_area = norm(area);
  const double largest = std::max(
      {std::abs(low.x), std::abs(low.y), std::abs(low.z), std::abs(high.x), std::abs(high.y), std::abs(high.z)});
  // Ten times what `Outline` calls rounding: 8 units in the last place of the largest coordinate.
  const double rounding = 80 * std::numeric_limits<double>::epsilon() * largest;
  if (!(twice_area > 1e-2 * size * size) || !(twice_area > 8 * size * rounding)) return false;
  const Vec3 normal = area / twice_area, mean = sum / static_cast<double>(n);
  const double allowed = 0.5e-6 * size;
  const int axis = dominant_axis(normal);
  const auto seen = [&](std::size_t i) { return drop(ring[i], axis); };
  Vec2 a = seen(n - 2), b = seen(n - 1);
  const exact::Sign sense = orient2d(a, b, seen(0));
  if (sense == exact::Sign::zero) return false;
  // Around a ring that always turns the same way u rises and falls once for every full turn.
  int turns = 0, before = (b.x > a.x) - (b.x < a.x);
  if (before == 0) before = (a.x > seen(n - 3).x) - (a.x < seen(n - 3).x);
  for (std::size_t j = 0; j < n; ++j) {
    if (std::abs(dot(normal, ring[j] - ring[0] - mean)) > allowed) return false;
    const Vec2 c = seen(j);
    if (orient2d(a, b, c) != sense) return false;
    const int now = (c.x > b.x) - (c.x < b.x);
    if (now != 0 && now != before) {
      ++turns;
      before = now;
    }
    a = b;
    b = c;
  }
  return turns == 2;
}

}  // namespace

std::expected<Polygon, PolygonError> Polygon::make(std::vector<Vec3> corners) {
  if (plainly_convex(corners)) return Polygon{std::move(corners), true};
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
