#include "shells.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "cleave/geometry/box_tree.hpp"

namespace cleave::geometry {
namespace {

struct Shell {
  std::vector<std::uint32_t> triangles;
  Box box;
  double volume = 0;  ///< signed, m3
};

/// Solid angle of triangle a b c seen from the origin (van Oosterom and Strackee 1983).
double solid_angle(Vec3 a, Vec3 b, Vec3 c) {
  const double la = norm(a), lb = norm(b), lc = norm(c);
  const double numerator = dot(a, cross(b, c));
  const double denominator = la * lb * lc + dot(a, b) * lc + dot(a, c) * lb + dot(b, c) * la;
  return 2 * std::atan2(numerator, denominator);
}

}  // namespace

std::optional<InsideOut> wrong_shell(std::span<const Vec3> vertices, std::span<const SurfaceTriangle> triangles,
                                     std::span<const std::uint32_t> shell_of_face, std::uint32_t shells) {
  std::vector<Shell> all(shells);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Shell& shell = all[shell_of_face[triangles[t].face]];
    shell.triangles.push_back(static_cast<std::uint32_t>(t));
    const auto& [a, b, c] = triangles[t].corners;
    for (const std::uint32_t v : {a, b, c}) shell.box.add(vertices[v]);
    const Vec3 about = vertices[triangles[shell.triangles.front()].corners[0]];
    shell.volume += dot(vertices[a] - about, cross(vertices[b] - about, vertices[c] - about)) / 6;
  }
  std::vector<Box> boxes;
  for (const Shell& shell : all) boxes.push_back(shell.box);
  const BoxTree tree{boxes};
  for (std::size_t s = 0; s < all.size(); ++s) {
    // A point in the middle of a triangle is on no other shell, because shells share at most vertices and edges.
    const auto& [a, b, c] = triangles[all[s].triangles.front()].corners;
    const Vec3 probe = (vertices[a] + vertices[b] + vertices[c]) / 3;
    bool held_by_odd = false;
    tree.overlapping(Box{probe, probe}, [&](std::uint32_t other) {
      if (other == s) return;
      double angle = 0;
      for (const std::uint32_t t : all[other].triangles) {
        const auto& [u, v, w] = triangles[t].corners;
        angle += solid_angle(vertices[u] - probe, vertices[v] - probe, vertices[w] - probe);
      }
      // A whole number of turns: 0 outside, +1 or -1 inside.
      const bool inside = std::abs(std::round(angle / (4 * std::numbers::pi))) > 0.5;
      if (inside) held_by_odd = !held_by_odd;
    });
    if ((all[s].volume < 0) != held_by_odd) return InsideOut{cubic_metres(all[s].volume)};
  }
  return std::nullopt;
}

}  // namespace cleave::geometry
