#include "touch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cleave::motion {
namespace {

/// Edges nearer to parallel than this make no contact of their own.
constexpr double parallel = 1e-6;

double lowest(const std::vector<Vec3>& points, Vec3 normal) {
  double low = std::numeric_limits<double>::infinity();
  for (const Vec3 p : points) low = std::min(low, dot(normal, p));
  return low;
}

struct Best {
  std::uint32_t side = 0;
  double gap = -std::numeric_limits<double>::infinity();
};
/// Largest distance of a cell before the sides of another one: outer sides, and all others.
void along_sides(const Placed& of, const Placed& before, Best& outer, Best& inner) {
  for (std::uint32_t s = 0; s < of.normals.size(); ++s) {
    const Side& side = of.cell->sides[s];
    const double gap = lowest(before.vertices, of.normals[s]) - dot(of.normals[s], of.vertices[side.corners[0]]);
    Best& best = side.outer ? outer : inner;
    if (gap > best.gap) best = {s, gap};
  }
}

/// Arcs of normals a-b and -c, -d cross on the sphere: the edges between those sides face each other.
bool faces(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 ba = cross(b, a), dc = cross(d, c);
  const double cba = dot(c, ba), dba = dot(d, ba), adc = dot(a, dc), bdc = dot(b, dc);
  return cba * dba < 0 && adc * bdc < 0 && cba * bdc > 0;
}

struct BestEdges {
  std::uint32_t first = 0, second = 0;
  Vec3 normal;
  double gap = -std::numeric_limits<double>::infinity();
};
BestEdges along_edges(const Placed& first, const Placed& second) {
  BestEdges best;
  const auto& edges = first.cell->edges;
  const auto& others = second.cell->edges;
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    if (!edges[e].outer) continue;
    const Vec3 a = first.normals[edges[e].left], b = first.normals[edges[e].right];
    const Vec3 p = first.vertices[edges[e].a], along = first.vertices[edges[e].b] - p;
    for (std::uint32_t f = 0; f < others.size(); ++f) {
      if (!others[f].outer) continue;
      const Vec3 c = -second.normals[others[f].left], d = -second.normals[others[f].right];
      if (!faces(a, b, c, d)) continue;
      const Vec3 q = second.vertices[others[f].a], across = second.vertices[others[f].b] - q;
      Vec3 n = cross(along, across);
      const double length = norm(n);
      if (length <= parallel * norm(along) * norm(across)) continue;
      n = n / length;
      // Out of the second cell: against the normals of the first one's sides.
      if (dot(n, a + b) > 0) n = -n;
      const double gap = dot(n, p - q);
      if (gap > best.gap) best = {e, f, n, gap};
    }
  }
  return best;
}

std::vector<Vec3> side_points(const Placed& placed, std::uint32_t side) {
  std::vector<Vec3> out;
  for (const std::uint32_t v : placed.cell->sides[side].corners) out.push_back(placed.vertices[v]);
  return out;
}

/// Of the sides at the lowest corner the one that looks most against the normal.
std::uint32_t facing_side(const Placed& placed, Vec3 normal) {
  const double low = lowest(placed.vertices, normal);
  std::uint32_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t s = 0; s < placed.normals.size(); ++s) {
    const auto& corners = placed.cell->sides[s].corners;
    const bool there = std::ranges::any_of(
        corners, [&](std::uint32_t v) { return dot(normal, placed.vertices[v]) <= low + 1e-9 * placed.size; });
    if (there && dot(placed.normals[s], normal) < least) {
      least = dot(placed.normals[s], normal);
      best = s;
    }
  }
  return best;
}

/// Part of a convex polygon over a side, whose borders are moved outwards by `wider`.
std::vector<Vec3> over_side(std::vector<Vec3> polygon, const std::vector<Vec3>& side, Vec3 normal, double wider) {
  std::vector<Vec3> out;
  for (std::size_t k = 0; k < side.size() && !polygon.empty(); ++k) {
    const Vec3 a = side[k], along = side[(k + 1) % side.size()] - a;
    const double length = norm(along);
    if (!(length > 0)) continue;
    const Vec3 outward = cross(along, normal) / length;
    const double offset = dot(outward, a) + wider;
    out.clear();
    for (std::size_t m = 0; m < polygon.size(); ++m) {
      const Vec3 p = polygon[m], q = polygon[(m + 1) % polygon.size()];
      const double dp = dot(outward, p) - offset, dq = dot(outward, q) - offset;
      if (dp <= 0) out.push_back(p);
      if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) out.push_back(p + dp / (dp - dq) * (q - p));
    }
    polygon.swap(out);
  }
  return polygon;
}

/// Equal points, and points on the line of their neighbours, carry nothing of their own.
void thin_out(std::vector<Vec3>& polygon, double tolerance) {
  for (std::size_t k = 0; k < polygon.size() && polygon.size() > 1;) {
    const std::size_t n = polygon.size();
    const Vec3 before = polygon[(k + n - 1) % n], here = polygon[k], after = polygon[(k + 1) % n];
    const Vec3 span = after - before;
    const bool double_point = norm(here - before) <= tolerance;
    const bool between = n > 2 && dot(here - before, after - here) > 0 &&
                         norm(cross(here - before, span)) <= tolerance * std::max(norm(span), tolerance);
    if (double_point || between) {
      polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(k));
    } else {
      ++k;
    }
  }
}

void along_side(const Placed& reference, const Placed& incident, std::uint32_t side, double reach, bool strict,
                std::vector<Touch>& out) {
  const Vec3 normal = reference.normals[side];
  const double size = std::min(reference.size, incident.size);
  const std::uint32_t facing = facing_side(incident, normal);
  const std::vector<Vec3> base = side_points(reference, side);
  const std::vector<Vec3> polygon = side_points(incident, facing);
  if (strict && over_side(polygon, base, normal, -1e-6 * size).empty()) return;
  std::vector<Vec3> points = over_side(polygon, base, normal, 1e-12 * size);
  thin_out(points, 1e-9 * size);
  Touch touch{.body = incident.body,
              .other = reference.body,
              .cell = incident.number,
              .other_cell = reference.number,
              .point = {},
              .normal = normal,
              .gap = 0,
              .surface = incident.cell->sides[facing].surface,
              .other_surface = reference.cell->sides[side].surface,
              .size = size};
  for (const Vec3 p : points) {
    touch.gap = dot(normal, p - base[0]);
    touch.point = p;
    if (touch.gap <= reach) out.push_back(touch);
  }
}

/// Where edges cross that belong to sides nearly parallel, the sides meet elsewhere with the least turn: the corners of
/// what they share, seen along the normal, whose gaps are within reach.
void around_crossing(const Placed& first, const Placed& second, const Touch& crossing, double reach,
                     std::vector<Touch>& out) {
  const Vec3 normal = crossing.normal;
  const std::uint32_t facing = facing_side(first, normal), side = facing_side(second, -normal);
  const double steep = dot(second.normals[side], normal);
  if (!(steep > 0) || !(dot(first.normals[facing], normal) < 0)) return;
  const std::vector<Vec3> base = side_points(second, side);
  std::vector<Vec3> points = over_side(side_points(first, facing), base, normal, 1e-12 * crossing.size);
  thin_out(points, 1e-9 * crossing.size);
  Touch touch = crossing;
  touch.surface = first.cell->sides[facing].surface;
  touch.other_surface = second.cell->sides[side].surface;
  for (const Vec3 p : points) {
    touch.gap = dot(second.normals[side], p - base[0]) / steep;
    touch.point = p;
    if (touch.gap <= reach && norm(cross(p - crossing.point, normal)) > 1e-6 * crossing.size) out.push_back(touch);
  }
}

void along_edge_pair(const Placed& first, const Placed& second, const Axis& axis, double reach, bool strict,
                     std::vector<Touch>& out) {
  if (axis.gap > reach) return;
  const Edge &e = first.cell->edges[axis.first], &f = second.cell->edges[axis.second];
  const Vec3 p = first.vertices[e.a], u = first.vertices[e.b] - p;
  const Vec3 q = second.vertices[f.a], v = second.vertices[f.b] - q;
  const Vec3 n = cross(u, v), between = q - p;
  const double square = dot(n, n);
  const double s = dot(cross(between, v), n) / square, t = dot(cross(between, u), n) / square;
  const double rim = strict ? 1e-6 : -1e-9;
  if (s < rim || s > 1 - rim || t < rim || t > 1 - rim) return;
  Touch touch{.body = first.body,
              .other = second.body,
              .cell = first.number,
              .other_cell = second.number,
              .point = 0.5 * (p + s * u + q + t * v),
              .normal = axis.normal,
              .gap = axis.gap,
              .surface = first.cell->sides[e.left].surface,
              .other_surface = second.cell->sides[f.left].surface,
              .size = std::min(first.size, second.size)};
  out.push_back(touch);
  around_crossing(first, second, touch, reach, out);
}

}  // namespace

void place(Placed& placed, Vec3 centroid, Turn turn) {
  const Cell& cell = *placed.cell;
  placed.vertices.resize(cell.vertices.size());
  placed.normals.resize(cell.sides.size());
  placed.box = {};
  for (std::size_t v = 0; v < cell.vertices.size(); ++v) {
    placed.vertices[v] = centroid + turn * cell.vertices[v];
    placed.box.add(placed.vertices[v]);
  }
  for (std::size_t s = 0; s < cell.sides.size(); ++s) placed.normals[s] = turn * cell.sides[s].normal;
}

std::optional<Axis> widest_axis(const Placed& first, const Placed& second) {
  const double size = std::min(first.size, second.size);
  Best outer_first, outer_second, inner;
  along_sides(first, second, outer_first, inner);
  along_sides(second, first, outer_second, inner);
  const BestEdges edges = along_edges(first, second);
  const double sides = std::max(outer_first.gap, outer_second.gap);
  const double tolerance = 1e-7 * size;
  if (inner.gap > tolerance && std::max(sides, edges.gap) < -tolerance) return {};
  Axis axis;
  if (edges.gap > sides + tolerance) {
    axis = {Axis::Kind::edges, edges.first, edges.second, edges.normal, edges.gap};
  } else if (outer_second.gap >= outer_first.gap - 1e-9 * size) {
    const std::uint32_t s = outer_second.side;
    axis = {Axis::Kind::side_of_second, s, s, second.normals[s], outer_second.gap};
  } else {
    const std::uint32_t s = outer_first.side;
    axis = {Axis::Kind::side_of_first, s, s, -first.normals[s], outer_first.gap};
  }
  if (!std::isfinite(axis.gap)) return {};  // no skin to touch
  return axis;
}

void touches_along(const Placed& first, const Placed& second, const Axis& axis, double reach, bool strict,
                   std::vector<Touch>& out) {
  switch (axis.kind) {
    case Axis::Kind::side_of_first: along_side(first, second, axis.first, reach, strict, out); break;
    case Axis::Kind::side_of_second: along_side(second, first, axis.first, reach, strict, out); break;
    case Axis::Kind::edges: along_edge_pair(first, second, axis, reach, strict, out); break;
  }
}

}  // namespace cleave::motion
