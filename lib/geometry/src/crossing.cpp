#include "crossing.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "cleave/geometry/box_tree.hpp"
#include "cleave/geometry/predicates.hpp"

namespace cleave::geometry {
namespace {

using exact::Sign;
using Corners = std::array<std::uint32_t, 3>;

bool has(const Corners& triangle, std::uint32_t vertex) {
  return std::ranges::find(triangle, vertex) != triangle.end();
}

/// Does an edge of `s` that shares no vertex with `t` meet `t`?
bool free_edge_meets(std::span<const Vec3> p, const Corners& s, const Corners& t) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t a = s[i];
    const std::uint32_t b = s[(i + 1) % 3];
    if (has(t, a) || has(t, b)) continue;
    if (segment_meets_triangle(p[a], p[b], p[t[0]], p[t[1]], p[t[2]])) return true;
  }
  return false;
}

/// Two triangles on the edge a b, with third corners c and d: folded onto each other?
bool folded(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  if (orient3d(a, b, c, d) != Sign::zero) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const Sign c_side = orient2d(drop(a, axis), drop(b, axis), drop(c, axis));
    if (c_side == Sign::zero) continue;  // c is off the edge, so some axis shows it
    return orient2d(drop(a, axis), drop(b, axis), drop(d, axis)) == c_side;
  }
  return false;
}

bool clash(std::span<const Vec3> p, const Corners& s, const Corners& t) {
  const auto is_shared = [&](std::uint32_t v) { return has(t, v); };
  const auto shared = std::ranges::count_if(s, is_shared);
  if (shared == 3) return true;
  if (shared == 2) {
    const std::uint32_t c = *std::ranges::find_if_not(s, is_shared);
    const std::uint32_t d = *std::ranges::find_if_not(t, [&](std::uint32_t v) { return has(s, v); });
    Corners edge = s;
    std::ranges::remove(edge, c);
    return folded(p[edge[0]], p[edge[1]], p[c], p[d]);
  }
  return free_edge_meets(p, s, t) || free_edge_meets(p, t, s);
}

}  // namespace

std::optional<std::pair<std::uint32_t, std::uint32_t>> first_crossing_faces(
    std::span<const Vec3> vertices, std::span<const SurfaceTriangle> triangles) {
  std::vector<Box> boxes;
  boxes.reserve(triangles.size());
  for (const SurfaceTriangle& t : triangles) {
    Box& box = boxes.emplace_back();
    for (const std::uint32_t v : t.corners) box.add(vertices[v]);
  }
  const BoxTree tree{boxes};
  std::optional<std::pair<std::uint32_t, std::uint32_t>> found;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    tree.overlapping(boxes[i], [&](std::uint32_t j) {
      if (j <= i || triangles[i].face == triangles[j].face) return;
      const std::pair candidate{std::min(triangles[i].face, triangles[j].face),
                                std::max(triangles[i].face, triangles[j].face)};
      if (found && *found <= candidate) return;
      if (clash(vertices, triangles[i].corners, triangles[j].corners)) found = candidate;
    });
  }
  return found;
}

}  // namespace cleave::geometry
