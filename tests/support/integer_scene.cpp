#include "integer_scene.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

namespace cleave::testing {

namespace {

using Vector = std::array<std::int64_t, 3>;

Vector difference(IntegerPoint a, IntegerPoint b) {
  return {std::int64_t{b.x} - a.x, std::int64_t{b.y} - a.y, std::int64_t{b.z} - a.z};
}
Vector cross(const Vector& u, const Vector& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}
std::int64_t dot(const Vector& u, const Vector& v) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; }

/// Twice the polygon's face vector.
Vector newell(const IntegerPolygon& p) {
  Vector sum{};
  for (std::size_t i = 2; i < p.size(); ++i) {
    const Vector c = cross(difference(p[0], p[i - 1]), difference(p[0], p[i]));
    for (std::size_t k = 0; k < 3; ++k) sum[k] += c[k];
  }
  return sum;
}

int turn(const Vector& normal, IntegerPoint a, IntegerPoint b, IntegerPoint c) {
  const std::int64_t d = dot(normal, cross(difference(a, b), difference(a, c)));
  return d > 0 ? 1 : d < 0 ? -1 : 0;
}
bool between(IntegerPoint a, IntegerPoint b, IntegerPoint p) {  // p on the line ab
  return dot(difference(p, a), difference(p, b)) <= 0;
}
bool segments_touch(const Vector& n, IntegerPoint a, IntegerPoint b, IntegerPoint c, IntegerPoint d) {
  const int abc = turn(n, a, b, c), abd = turn(n, a, b, d), cda = turn(n, c, d, a), cdb = turn(n, c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && between(a, b, c)) || (abd == 0 && between(a, b, d)) || (cda == 0 && between(c, d, a)) ||
         (cdb == 0 && between(c, d, b));
}

std::int32_t& coordinate(IntegerPoint& p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

template <class Map>
void for_each_point(IntegerScene& scene, const Map& map) {
  for (IntegerPolygon& joint : scene.joints) {
    for (IntegerPoint& p : joint) p = map(p);
  }
  for (IntegerSolid& solid : scene.excavations) {
    for (IntegerPoint& p : solid.vertices) p = map(p);
  }
  if (scene.domain) {
    for (IntegerPoint& p : scene.domain->vertices) p = map(p);
  }
  scene.min = map(scene.min);
  scene.max = map(scene.max);
}

}  // namespace

IntegerSolid integer_box(IntegerPoint min, IntegerPoint max) {
  IntegerSolid solid;
  for (int i = 0; i < 8; ++i) {
    solid.vertices.push_back(
        {(i & 1) != 0 ? max.x : min.x, (i & 2) != 0 ? max.y : min.y, (i & 4) != 0 ? max.z : min.z});
  }
  solid.faces = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  return solid;
}

IntegerPolygon rectangle(int axis, int at, int lo0, int lo1, int hi0, int hi1) {
  const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
  IntegerPolygon out;
  for (const auto& [s, t] : {std::pair{lo0, lo1}, {hi0, lo1}, {hi0, hi1}, {lo0, hi1}}) {
    IntegerPoint p;
    coordinate(p, axis) = at;
    coordinate(p, first) = s;
    coordinate(p, second) = t;
    out.push_back(p);
  }
  return out;
}

IntegerPolygon covering_plane(IntegerPoint through, IntegerPoint n, int reach) {
  // Two vectors of the plane at right angles: u integer, v = n x u; both at least one long, so `reach` times each is
  // enough.
  const IntegerPoint u = n.x != 0 || n.y != 0 ? IntegerPoint{-n.y, n.x, 0} : IntegerPoint{1, 0, 0};
  const IntegerPoint v{n.y * u.z - n.z * u.y, n.z * u.x - n.x * u.z, n.x * u.y - n.y * u.x};
  const IntegerPoint s = reach * u, t = reach * v;
  return {through - s - t, through + s - t, through + s + t, through - s + t};
}

void add_closed_box(IntegerScene& scene, IntegerPoint lo, IntegerPoint hi) {
  for (const int x : {lo.x, hi.x}) scene.joints.push_back(rectangle(0, x, lo.y, lo.z, hi.y, hi.z));
  for (const int y : {lo.y, hi.y}) scene.joints.push_back(rectangle(1, y, lo.x, lo.z, hi.x, hi.z));
  for (const int z : {lo.z, hi.z}) scene.joints.push_back(rectangle(2, z, lo.x, lo.y, hi.x, hi.y));
}

bool is_valid_polygon(const IntegerPolygon& p) {
  const std::size_t n = p.size();
  if (n < 3) return false;
  const Vector normal = newell(p);
  if (normal == Vector{}) return false;
  for (const IntegerPoint corner : p) {
    if (dot(normal, difference(p[0], corner)) != 0) return false;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const IntegerPoint a = p[i], b = p[(i + 1) % n], c = p[(i + 2) % n];
    if (a == b) return false;
    if (turn(normal, a, b, c) == 0 && dot(difference(a, b), difference(b, c)) < 0) return false;  // folds back
    for (std::size_t j = i + 2; j < n; ++j) {
      if ((j + 1) % n == i) continue;
      if (segments_touch(normal, a, b, p[j], p[(j + 1) % n])) return false;
    }
  }
  return true;
}

IntegerScene translated(IntegerScene scene, IntegerPoint by) {
  for_each_point(scene, [&](IntegerPoint p) { return p + by; });
  return scene;
}

IntegerScene axes_rotated(IntegerScene scene) {
  for_each_point(scene, [](IntegerPoint p) { return IntegerPoint{p.z, p.x, p.y}; });
  return scene;
}

IntegerScene axes_swapped(IntegerScene scene) {
  for_each_point(scene, [](IntegerPoint p) { return IntegerPoint{p.y, p.x, p.z}; });
  const auto mirror = [](IntegerSolid& solid) {
    for (auto& face : solid.faces) std::ranges::reverse(face);
  };
  for (IntegerSolid& solid : scene.excavations) mirror(solid);
  if (scene.domain) mirror(*scene.domain);
  return scene;
}

std::string describe(const IntegerScene& scene) {
  std::ostringstream out;
  const auto point = [&](IntegerPoint p) { out << '[' << p.x << ", " << p.y << ", " << p.z << ']'; };
  const auto points = [&](const std::vector<IntegerPoint>& all) {
    out << '[';
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i > 0) out << ", ";
      point(all[i]);
    }
    out << "]\n";
  };
  out << "box ";
  point(scene.min);
  out << " - ";
  point(scene.max);
  out << '\n';
  if (scene.domain) {
    out << "domain ";
    points(scene.domain->vertices);
  }
  for (const IntegerPolygon& joint : scene.joints) {
    out << "joint ";
    points(joint);
  }
  for (const IntegerSolid& solid : scene.excavations) {
    out << "excavation ";
    points(solid.vertices);
  }
  return out.str();
}

}  // namespace cleave::testing
