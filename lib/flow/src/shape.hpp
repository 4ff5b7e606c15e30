#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "cleave/flow/flow.hpp"
#include "discretisation.hpp"
#include "space.hpp"

/// Triangles: their stiffness, the energy of linear functions on them, and which of them to split.
namespace cleave::flow {

using geometry::Vec3;

/// Stiffness and area of a triangle of unit transmissivity. A needle so thin that its corners' positions do not tell
/// its height any more counts as high as they can tell: what it lets through hardly hangs on it.
struct Shape {
  Stiffness stiffness{};
  double area = 0;
};
inline Shape shape_of(const Mesh& mesh, std::size_t t) {
  constexpr double thinnest = 1e-12;
  const auto& corners = mesh.triangles[t];
  std::array<Vec3, 3> across;
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    across[k] = mesh.points[corners[(k + 2) % 3]] - mesh.points[corners[(k + 1) % 3]];
    longest = std::max(longest, geometry::dot(across[k], across[k]));
  }
  const double twice = std::max(geometry::norm(geometry::cross(across[0], across[1])), thinnest * longest);
  Shape shape{.area = 0.5 * twice};
  for (std::size_t k = 0; k < 3; ++k) {
    shape.stiffness[k] = geometry::dot(across[(k + 1) % 3], across[(k + 2) % 3]) / (2 * twice);
  }
  return shape;
}

/// Values at the corners of a triangle, or of what is linear there.
using Values = std::array<double, 3>;
/// The energy that two such functions share.
inline double energy(const Stiffness& s, const Values& u, const Values& v) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    sum -= s[k] * (u[i] - u[j]) * (v[i] - v[j]);
  }
  return sum;
}

/// Marks those that have half of all shares, the largest first.
inline void mark_half(const std::vector<double>& share, std::vector<std::uint8_t>& marked) {
  const double all = std::accumulate(share.begin(), share.end(), 0.0);
  std::vector<Index> order(share.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](Index t) { return share[t]; });
  double sum = 0;
  std::size_t count = 0;
  for (const Index t : order) {
    const bool few = count < share.size() / 25;  // rounds cost as much as triangles
    if ((sum >= 0.5 * all && !few) || !(share[t] > 0)) break;
    marked[t] = 1;
    sum += share[t];
    ++count;
  }
}

}  // namespace cleave::flow
