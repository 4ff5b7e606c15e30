#include "arrangement.hpp"

#include <algorithm>
#include <stdexcept>

namespace cleave::oracle {

using testing::IntegerPoint;
using testing::IntegerPolygon;

namespace {

std::array<Int, 3> cross(const std::array<Int, 3>& u, const std::array<Int, 3>& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

std::array<Int, 3> vector_from(IntegerPoint a, IntegerPoint b) {
  return {Int{b.x} - a.x, Int{b.y} - a.y, Int{b.z} - a.z};
}

PlaneEquation canonical(const std::array<Int, 3>& n, IntegerPoint through) {
  PlaneEquation p{n[0], n[1], n[2], -(n[0] * through.x + n[1] * through.y + n[2] * through.z)};
  Int g = gcd(gcd(p[0], p[1]), gcd(p[2], p[3]));
  const auto first = std::ranges::find_if(p, [](const Int& c) { return c != 0; });
  if (*first < 0) g = -g;
  for (Int& c : p) c /= g;
  return p;
}

HomogeneousPoint canonical(HomogeneousPoint p) {
  Int g = gcd(gcd(p[0], p[1]), gcd(p[2], p[3]));
  if (p[3] < 0) g = -g;
  for (Int& c : p) c /= g;
  return p;
}

HomogeneousPoint mean_of(const std::vector<HomogeneousPoint>& points) {
  HomogeneousPoint sum{0, 0, 0, 1};
  for (const HomogeneousPoint& p : points) {
    for (std::size_t i = 0; i < 3; ++i) sum[i] = sum[i] * p[3] + p[i] * sum[3];
    sum[3] *= p[3];
  }
  sum[3] *= Int{points.size()};
  return canonical(sum);
}

/// (b - a) times both denominators.
std::array<Int, 3> difference(const HomogeneousPoint& a, const HomogeneousPoint& b) {
  return {b[0] * a[3] - a[0] * b[3], b[1] * a[3] - a[1] * b[3], b[2] * a[3] - a[2] * b[3]};
}

}  // namespace

int sign(const Int& value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

Int evaluate(const PlaneEquation& plane, const HomogeneousPoint& point) {
  return plane[0] * point[0] + plane[1] * point[1] + plane[2] * point[2] + plane[3] * point[3];
}

std::optional<PlaneEquation> plane_through(IntegerPoint a, IntegerPoint b, IntegerPoint c) {
  const auto n = cross(vector_from(a, b), vector_from(a, c));
  if (n[0] == 0 && n[1] == 0 && n[2] == 0) return std::nullopt;
  return canonical(n, a);
}

PlaneEquation plane_of(const IntegerPolygon& polygon) {
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    if (const auto plane = plane_through(polygon[0], polygon[i - 1], polygon[i])) return *plane;
  }
  throw std::logic_error("polygon without area in an oracle scene");
}

std::vector<PlaneEquation> outline_planes(const IntegerPolygon& polygon) {
  const PlaneEquation plane = plane_of(polygon);
  std::vector<PlaneEquation> out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const IntegerPoint a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    out.push_back(canonical(cross(vector_from(a, b), {plane[0], plane[1], plane[2]}), a));
  }
  return out;
}

Arrangement::Arrangement(IntegerPoint min, IntegerPoint max) {
  const auto corner = [&](int bits) {
    return intern({Int{(bits & 1) != 0 ? max.x : min.x}, Int{(bits & 2) != 0 ? max.y : min.y},
                   Int{(bits & 4) != 0 ? max.z : min.z}, Int{1}});
  };
  Cell box;
  const auto add = [&](PlaneEquation plane, int side, std::array<int, 4> bits) {
    CellFace face{static_cast<std::uint32_t>(planes_.size()), side, {}};
    for (const int b : bits) face.loop.push_back(corner(b));
    box.push_back(face);
    plane_numbers_.emplace(plane, face.plane);
    planes_.push_back(std::move(plane));
  };
  add({1, 0, 0, -min.x}, 1, {0, 4, 6, 2});
  add({1, 0, 0, -max.x}, -1, {1, 3, 7, 5});
  add({0, 1, 0, -min.y}, 1, {0, 1, 5, 4});
  add({0, 1, 0, -max.y}, -1, {2, 6, 7, 3});
  add({0, 0, 1, -min.z}, 1, {0, 2, 3, 1});
  add({0, 0, 1, -max.z}, -1, {4, 5, 7, 6});
  cells_.push_back(std::move(box));
}

std::optional<std::uint32_t> Arrangement::find(const PlaneEquation& plane) const {
  const auto it = plane_numbers_.find(plane);
  return it == plane_numbers_.end() ? std::nullopt : std::optional{it->second};
}

int Arrangement::side(std::uint32_t vertex) {
  if (sides_.size() < vertices_.size()) sides_.resize(vertices_.size(), unknown);
  if (sides_[vertex] == unknown) sides_[vertex] = static_cast<std::int8_t>(sign(evaluate(divider_, vertices_[vertex])));
  return sides_[vertex];
}

void Arrangement::divide_by(const PlaneEquation& plane) {
  divider_ = plane;
  sides_.assign(vertices_.size(), unknown);
}

std::uint32_t Arrangement::intern(HomogeneousPoint point) {
  const auto [it, fresh] = vertex_numbers_.try_emplace(point, static_cast<std::uint32_t>(vertices_.size()));
  if (fresh) vertices_.push_back(std::move(point));
  return it->second;
}

std::uint32_t Arrangement::crossing(std::uint32_t a, std::uint32_t b) {
  const Int at_a = evaluate(divider_, vertices_[a]), at_b = evaluate(divider_, vertices_[b]);
  HomogeneousPoint p;
  for (std::size_t i = 0; i < 4; ++i) p[i] = at_a * vertices_[b][i] - at_b * vertices_[a][i];
  return intern(canonical(std::move(p)));
}

Loop Arrangement::part(const Loop& loop, int keep) {
  Loop out;
  bool strictly = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const std::uint32_t a = loop[i], b = loop[(i + 1) % loop.size()];
    const int sa = side(a) * keep, sb = side(b) * keep;
    if (sa >= 0) out.push_back(a);
    if (sa > 0) strictly = true;
    if (sa * sb < 0) out.push_back(crossing(a, b));
  }
  return strictly ? out : Loop{};
}

std::pair<Loop, Loop> Arrangement::split(const Loop& loop, const PlaneEquation& plane) {
  divide_by(plane);
  return {part(loop, -1), part(loop, 1)};
}

Cell Arrangement::part(const Cell& cell, std::uint32_t plane, int keep) {
  Cell out;
  std::map<std::uint32_t, std::uint32_t> next;  // of the new face
  for (const CellFace& face : cell) {
    Loop loop = part(face.loop, keep);
    if (loop.empty()) continue;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::uint32_t a = loop[i], b = loop[(i + 1) % loop.size()];
      if (side(a) == 0 && side(b) == 0) next.emplace(b, a);
    }
    out.push_back({face.plane, face.side, std::move(loop)});
  }
  CellFace cap{plane, keep, {}};
  const std::uint32_t start = next.begin()->first;
  for (std::uint32_t v = start; cap.loop.empty() || v != start; v = next.at(v)) cap.loop.push_back(v);
  if (cap.loop.size() != next.size()) throw std::logic_error("the section of a convex cell is not one loop");
  out.push_back(std::move(cap));
  return out;
}

void Arrangement::insert(const PlaneEquation& plane) {
  const auto number = static_cast<std::uint32_t>(planes_.size());
  if (!plane_numbers_.try_emplace(plane, number).second) return;
  planes_.push_back(plane);
  divide_by(plane);
  const std::size_t count = cells_.size();
  for (std::size_t c = 0; c < count; ++c) {
    bool below = false, above = false;
    for (const CellFace& face : cells_[c]) {
      for (const std::uint32_t v : face.loop) {
        const int s = side(v);
        below |= s < 0;
        above |= s > 0;
      }
    }
    if (!below || !above) continue;
    Cell lower = part(cells_[c], number, -1);
    Cell upper = part(cells_[c], number, 1);
    cells_[c] = std::move(lower);
    cells_.push_back(std::move(upper));
  }
}

HomogeneousPoint Arrangement::inside(const Loop& loop) const {
  for (std::size_t i = 2; i < loop.size(); ++i) {
    const HomogeneousPoint &a = vertices_[loop[0]], &b = vertices_[loop[i - 1]], &c = vertices_[loop[i]];
    const auto n = cross(difference(a, b), difference(a, c));
    if (n[0] != 0 || n[1] != 0 || n[2] != 0) return mean_of({a, b, c});
  }
  throw std::logic_error("a cell face without area");
}

HomogeneousPoint Arrangement::inside(const Cell& cell) const {
  const CellFace& base = cell.front();
  for (const CellFace& face : cell) {
    for (const std::uint32_t v : face.loop) {
      if (evaluate(planes_[base.plane], vertices_[v]) == 0) continue;
      return mean_of({inside(base.loop), vertices_[v]});
    }
  }
  throw std::logic_error("a cell without volume");
}

}  // namespace cleave::oracle
