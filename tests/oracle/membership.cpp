#include "membership.hpp"

#include <stdexcept>

namespace cleave::oracle {

using testing::IntegerPoint;
using testing::IntegerPolygon;
using testing::IntegerSolid;

bool contains(const IntegerPolygon& polygon, const PlaneEquation& plane, const HomogeneousPoint& point) {
  // Drop a coordinate along which the plane is not vertical, then count the edges crossed by a ray.
  const std::size_t drop = plane[2] != 0 ? 2 : plane[1] != 0 ? 1 : 0;
  const std::size_t first = drop == 0 ? 1 : 0, second = drop == 2 ? 1 : 2;
  const auto flat = [&](IntegerPoint p) {
    const std::array<Int, 3> all{p.x, p.y, p.z};
    return std::array<Int, 2>{all[first] * point[3], all[second] * point[3]};
  };
  const Int &x = point[first], &y = point[second];
  bool in = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto a = flat(polygon[i]), b = flat(polygon[(i + 1) % polygon.size()]);
    if ((a[1] > y) == (b[1] > y)) continue;
    const int turn = sign((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]));
    if (turn == 0) throw std::logic_error("oracle: point on a polygon's outline");
    if ((turn > 0) == (b[1] > a[1])) in = !in;
  }
  return in;
}

IntegerPolygon face_polygon(const IntegerSolid& solid, std::size_t face) {
  IntegerPolygon out;
  for (const std::uint32_t v : solid.faces[face]) out.push_back(solid.vertices[v]);
  return out;
}

namespace {

// +1, -1: the ray meets the face, 0: it misses it; nothing: it meets the outline or lies in the plane.
std::optional<int> hits(const IntegerPolygon& polygon, const HomogeneousPoint& from, const std::array<Int, 3>& ray) {
  const PlaneEquation plane = plane_of(polygon);
  const Int slope = plane[0] * ray[0] + plane[1] * ray[1] + plane[2] * ray[2];
  if (slope == 0) return std::nullopt;
  const Int at = evaluate(plane, from);
  if (sign(at) == sign(slope)) return 0;
  // from + t ray with t = -at/(slope w)
  HomogeneousPoint p{from[0] * slope - at * ray[0], from[1] * slope - at * ray[1], from[2] * slope - at * ray[2],
                     from[3] * slope};
  if (p[3] < 0) {
    for (Int& c : p) c = -c;
  }
  for (const PlaneEquation& outline : outline_planes(polygon)) {
    if (evaluate(outline, p) == 0) return std::nullopt;
  }
  return contains(polygon, plane, p) ? 1 : 0;
}

}  // namespace

bool contains(const IntegerSolid& solid, const HomogeneousPoint& point) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    const std::array<Int, 3> ray{1009 + 17 * attempt, 317 - 29 * attempt, 101 + 13 * attempt * attempt};
    int crossings = 0;
    bool clear = true;
    for (std::size_t f = 0; f < solid.faces.size() && clear; ++f) {
      const auto hit = hits(face_polygon(solid, f), point, ray);
      clear = hit.has_value();
      if (clear) crossings += *hit;
    }
    if (clear) return crossings % 2 == 1;
  }
  throw std::logic_error("oracle: no ray in general position");
}

}  // namespace cleave::oracle
