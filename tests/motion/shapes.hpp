#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "cleave/motion/world.hpp"

/// Polyhedra that tests are made of.
namespace cleave::motion::shapes {

inline constexpr double degree = std::numbers::pi / 180;

/// Sides of a box, vertex bits 0, 1, 2 = x, y, z side. `in`: they look inwards.
inline std::vector<Facet> box_facets(std::uint32_t first, bool in = false) {
  static constexpr std::array<std::array<std::uint32_t, 4>, 6> sides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  std::vector<Facet> out;
  for (const auto& side : sides) {
    std::vector<std::uint32_t> loop;
    for (const std::uint32_t v : side) loop.push_back(first + v);
    if (in) std::ranges::reverse(loop);
    out.push_back({{loop}});
  }
  return out;
}
inline std::vector<Vec3> box_vertices(Vec3 lo, Vec3 hi) {
  std::vector<Vec3> out;
  for (unsigned v = 0; v < 8; ++v) {
    out.push_back({(v & 1U) != 0 ? hi.x : lo.x, (v & 2U) != 0 ? hi.y : lo.y, (v & 4U) != 0 ? hi.z : lo.z});
  }
  return out;
}
inline Polyhedron box(Vec3 lo, Vec3 hi) { return {box_vertices(lo, hi), box_facets(0)}; }
/// With its centroid in the origin.
inline Polyhedron block(double a, double b, double c) { return box({-a / 2, -b / 2, -c / 2}, {a / 2, b / 2, c / 2}); }

/// Over a polygon in the plane, counter-clockwise.
inline Polyhedron prism(const std::vector<std::pair<double, double>>& outline, double z0, double z1) {
  Polyhedron out;
  const auto n = static_cast<std::uint32_t>(outline.size());
  Facet low{{{}}}, high{{{}}};
  for (const auto& [x, y] : outline) out.vertices.push_back({x, y, z0});
  for (const auto& [x, y] : outline) out.vertices.push_back({x, y, z1});
  for (std::uint32_t k = 0; k < n; ++k) {
    low.loops[0].push_back(n - 1 - k);
    high.loops[0].push_back(n + k);
    const std::uint32_t next = (k + 1) % n;
    out.facets.push_back({{{k, next, n + next, n + k}}});
  }
  out.facets.push_back(low);
  out.facets.push_back(high);
  return out;
}
inline std::vector<std::pair<double, double>> regular(unsigned n, double radius) {
  std::vector<std::pair<double, double>> out;
  for (unsigned k = 0; k < n; ++k) {
    const double a = 2 * std::numbers::pi * k / n;
    out.emplace_back(radius * std::cos(a), radius * std::sin(a));
  }
  return out;
}

/// Triangles over all triples that have the rest on one side.
inline Polyhedron hull(const std::vector<Vec3>& points) {
  Polyhedron out{points, {}};
  const auto n = static_cast<std::uint32_t>(points.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = i + 1; j < n; ++j) {
      for (std::uint32_t k = j + 1; k < n; ++k) {
        const Vec3 normal = cross(points[j] - points[i], points[k] - points[i]);
        bool above = false, below = false;
        for (std::uint32_t m = 0; m < n; ++m) {
          if (m == i || m == j || m == k) continue;
          const double side = dot(normal, points[m] - points[i]);
          (side > 0 ? above : below) = true;
        }
        if (above && below) continue;
        out.facets.push_back({{above ? std::vector{i, k, j} : std::vector{i, j, k}}});
      }
    }
  }
  return out;
}
inline Polyhedron icosahedron(double edge) {
  const double p = std::numbers::phi, h = edge / 2;
  std::vector<Vec3> points;
  for (const double s : {-h, h}) {
    for (const double t : {-h * p, h * p}) {
      points.push_back({0, s, t});
      points.push_back({s, t, 0});
      points.push_back({t, 0, s});
    }
  }
  return hull(points);
}

inline Polyhedron moved(Polyhedron shape, Vec3 by, Turn turn = {}) {
  for (Vec3& v : shape.vertices) v = turn * v + by;
  return shape;
}

}  // namespace cleave::motion::shapes
