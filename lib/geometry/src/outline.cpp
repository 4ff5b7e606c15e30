#include "outline.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "cleave/geometry/triangulate.hpp"

namespace cleave::geometry {
namespace {

double largest_magnitude(const std::vector<Vec3>& points) {
  double largest = 0;
  for (const Vec3& p : points) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

double ulp(double x) { return std::nextafter(x, std::numeric_limits<double>::infinity()) - x; }

double box_diagonal(const std::vector<Vec3>& points) { return norm(box_of(points).size()); }

Vec3 furthest_from(Vec3 centre, const std::vector<Vec3>& points) {
  return *std::ranges::max_element(points, {}, [&](Vec3 p) { return dot(p - centre, p - centre); });
}

/// A normal that does not depend on the order of the corners: of the line between two far corners and the corner
/// furthest off it. Its length is (length of that line) x (distance from it).
Vec3 spread_normal(const std::vector<Vec3>& corners) {
  const Vec3 a = furthest_from(corners.front(), corners);
  const Vec3 b = furthest_from(a, corners);
  Vec3 best{};
  for (const Vec3& c : corners) {
    const Vec3 n = cross(b - a, c - a);
    if (dot(n, n) > dot(best, best)) best = n;
  }
  const double length = norm(b - a);
  return length > 0 ? best / length : best;  // now as long as the distance only, so that no square overflows
}

/// Pairs of edges that meet where they may not; the pair of the lowest numbers. Sweep over the edges sorted by their
/// left end.
std::optional<std::pair<std::size_t, std::size_t>> first_crossing(const std::vector<Vec2>& ring) {
  const std::size_t n = ring.size();
  const auto next = [n](std::size_t i) { return i + 1 == n ? 0 : i + 1; };
  std::optional<std::pair<std::size_t, std::size_t>> found;
  const auto report = [&](std::size_t i, std::size_t j) {
    const auto pair = std::minmax(i, j);
    const std::pair<std::size_t, std::size_t> candidate{pair.first, pair.second};
    if (!found || candidate < *found) found = candidate;
  };
  for (std::size_t i = 0; i < n; ++i) {  // neighbours may share their corner and nothing else
    const Vec2 a = ring[i];
    const Vec2 b = ring[next(i)];
    const Vec2 c = ring[next(next(i))];
    const bool backwards = (b.x - a.x) * (c.x - b.x) < 0 || (b.y - a.y) * (c.y - b.y) < 0 || (b == c) || (a == b);
    if (backwards && orient2d(a, b, c) == exact::Sign::zero) report(i, next(i));
  }
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto left = [&](std::size_t i) { return std::min(ring[i].x, ring[next(i)].x); };
  const auto right = [&](std::size_t i) { return std::max(ring[i].x, ring[next(i)].x); };
  std::ranges::sort(order, [&](std::size_t i, std::size_t j) { return std::pair{left(i), i} < std::pair{left(j), j}; });
  for (std::size_t s = 0; s < n; ++s) {
    const std::size_t i = order[s];
    const double end = right(i);
    const auto [low, high] = std::minmax(ring[i].y, ring[next(i)].y);
    for (std::size_t t = s + 1; t < n && left(order[t]) <= end; ++t) {
      const std::size_t j = order[t];
      if (next(i) == j || next(j) == i) continue;
      if (std::max(ring[j].y, ring[next(j)].y) < low || std::min(ring[j].y, ring[next(j)].y) > high) continue;
      if (segments_meet(ring[i], ring[next(i)], ring[j], ring[next(j)])) report(i, j);
    }
  }
  return found;
}

/// True when the simple ring turns clockwise, decided at its lowest corner.
bool clockwise(const std::vector<Vec2>& ring) {
  const auto lowest = std::ranges::min_element(ring, {}, [](Vec2 p) { return std::pair{p.x, p.y}; });
  const auto at = static_cast<std::size_t>(lowest - ring.begin());
  const std::size_t n = ring.size();
  // The lowest corner of a simple ring is convex; only flat neighbours could hide it, and they are not lowest.
  return orient2d(ring[(at + n - 1) % n], ring[at], ring[(at + 1) % n]) == exact::Sign::negative;
}

}  // namespace

std::expected<Outline, PolygonError> Outline::measure(const std::vector<Vec3>& given) {
  if (given.size() < 3) return std::unexpected(TooFewCorners{given.size()});
  Outline out;
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (!in_range(given[i])) return std::unexpected(NonFiniteCorner{i});  // also false for NaN
    const Vec3 p = flushed(given[i]);
    if (!out.corners.empty() && out.corners.back() == p) continue;
    out.corners.push_back(p);
    out.source.push_back(i);
  }
  while (out.corners.size() > 1 && out.corners.back() == out.corners.front()) {
    out.corners.pop_back();
    out.source.pop_back();
  }
  if (out.corners.size() < 3) return std::unexpected(ZeroArea{});

  const double rounding = 8 * ulp(largest_magnitude(out.corners));
  const Vec3 spread = spread_normal(out.corners);
  if (!(norm(spread) > rounding)) return std::unexpected(ZeroArea{});

  const double size = box_diagonal(out.corners);
  out.allowed = std::max(1e-6 * size, rounding);
  // A ring that crosses itself may have no area vector; the spread then shows the crossing.
  const Vec3 area = area_vector(out.corners);
  out.normal = normalized(norm(area) > 1e-3 * size * norm(spread) ? area : spread);
  Vec3 mean{};
  for (const Vec3& p : out.corners) mean += p - out.corners.front();
  mean = mean / static_cast<double>(out.corners.size());
  for (std::size_t i = 0; i < out.corners.size(); ++i) {
    const double distance = std::abs(dot(out.normal, out.corners[i] - out.corners.front() - mean));
    if (distance > out.distance) {
      out.distance = distance;
      out.furthest = out.source[i];
    }
  }

  out.axis = dominant_axis(out.normal);
  std::vector<Vec2> ring(out.corners.size());
  for (std::size_t i = 0; i < ring.size(); ++i) ring[i] = out.seen(i);
  if (const auto crossing = first_crossing(ring)) {
    return std::unexpected(SelfCrossing{out.source[crossing->first], out.source[crossing->second]});
  }
  out.flipped = clockwise(ring);
  const std::array towards{out.normal.x, out.normal.y, out.normal.z};
  const bool looks_back = towards[static_cast<std::size_t>(out.axis)] < 0;
  if (looks_back != out.flipped) out.normal = -out.normal;
  return out;
}

}  // namespace cleave::geometry
