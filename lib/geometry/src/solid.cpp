#include "cleave/geometry/solid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "cleave/core/disjoint_sets.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/predicates.hpp"
#include "cleave/geometry/triangulate.hpp"
#include "crossing.hpp"
#include "shells.hpp"

namespace cleave::geometry {
namespace {

std::expected<void, SolidError> check_face(const SolidFace& face, std::size_t number, std::size_t vertices,
                                           std::size_t tags) {
  if (face.corners.size() < 3) return std::unexpected(BadFace{number, FaceFault::too_few_corners});
  for (const std::uint32_t v : face.corners) {
    if (v >= vertices) return std::unexpected(BadFace{number, FaceFault::index_out_of_range});
  }
  if (face.tag >= std::max<std::size_t>(tags, 1))
    return std::unexpected(BadFace{number, FaceFault::index_out_of_range});
  std::vector<std::uint32_t> sorted = face.corners;
  std::ranges::sort(sorted);
  if (std::ranges::adjacent_find(sorted) != sorted.end()) {
    return std::unexpected(BadFace{number, FaceFault::corner_twice});
  }
  return {};
}

/// One use of an edge by a face.
struct EdgeUse {
  std::uint32_t low, high;
  std::uint32_t face;
  bool upwards;  ///< from low to high

  [[nodiscard]] friend auto operator<=>(const EdgeUse&, const EdgeUse&) = default;
};

/// Face numbers in shells.
using Groups = DisjointSets<std::uint32_t>;

/// Checks that each edge is used once in each direction; joins neighbours in `groups`.
std::expected<void, SolidError> check_edges(std::span<const Vec3> vertices, std::span<const SolidFace> faces,
                                            Groups& groups) {
  std::vector<EdgeUse> uses;
  std::size_t count = 0;
  for (const SolidFace& face : faces) count += face.corners.size();
  uses.reserve(count);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto& corners = faces[f].corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const std::uint32_t from = corners[i];
      const std::uint32_t to = corners[i + 1 == corners.size() ? 0 : i + 1];
      uses.push_back({std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(f), from < to});
    }
  }
  std::ranges::sort(uses);
  for (std::size_t begin = 0; begin < uses.size();) {
    const auto [low, high, face, upwards] = uses[begin];
    std::size_t end = begin + 1;
    while (end < uses.size() && uses[end].low == low && uses[end].high == high) ++end;
    if (end - begin == 1) {
      const std::uint32_t from = upwards ? low : high;
      const std::uint32_t to = upwards ? high : low;
      return std::unexpected(OpenEdge{from, to, vertices[from], vertices[to]});
    }
    if (end - begin > 2) return std::unexpected(NonManifoldEdge{low, high, end - begin, vertices[low], vertices[high]});
    if (uses[begin + 1].upwards == upwards) {
      const std::uint32_t from = upwards ? low : high;
      const std::uint32_t to = upwards ? high : low;
      return std::unexpected(InconsistentEdge{from, to, vertices[from], vertices[to]});
    }
    groups.join(face, uses[begin + 1].face);
    begin = end;
  }
  return {};
}

FaceFault fault_of(const PolygonError& error) {
  return std::visit(overloaded{
                        [](TooFewCorners) { return FaceFault::too_few_corners; },
                        [](NonFiniteCorner) { return FaceFault::index_out_of_range; },
                        [](ZeroArea) { return FaceFault::no_area; },
                        [](NotPlanar) { return FaceFault::crosses_itself; },
                        [](SelfCrossing) { return FaceFault::crosses_itself; },
                    },
                    error);
}

/// Number of the first vertex at the same place, for each vertex.
std::vector<std::uint32_t> first_at_same_place(std::span<const Vec3> vertices) {
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  const auto key = [&](std::uint32_t i) { return std::tuple{vertices[i].x, vertices[i].y, vertices[i].z, i}; };
  std::ranges::sort(order, {}, key);
  std::vector<std::uint32_t> first(vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && vertices[order[i]] == vertices[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

std::expected<std::vector<SurfaceTriangle>, SolidError> triangles_of(std::span<const Vec3> vertices,
                                                                     std::span<const SolidFace> faces) {
  const std::vector<std::uint32_t> place = first_at_same_place(vertices);
  std::vector<SurfaceTriangle> triangles;
  std::vector<Vec3> corners;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto& ids = faces[f].corners;
    const auto face = static_cast<std::uint32_t>(f);
    if (ids.size() == 3) {
      if (collinear(vertices[ids[0]], vertices[ids[1]], vertices[ids[2]])) {
        return std::unexpected(BadFace{f, FaceFault::no_area});
      }
      triangles.push_back({{place[ids[0]], place[ids[1]], place[ids[2]]}, face});
      continue;
    }
    corners.clear();
    for (const std::uint32_t v : ids) corners.push_back(vertices[v]);
    const auto pieces = triangulate(corners);
    if (!pieces) return std::unexpected(BadFace{f, fault_of(pieces.error())});
    for (const auto& [a, b, c] : *pieces) triangles.push_back({{place[ids[a]], place[ids[b]], place[ids[c]]}, face});
  }
  return triangles;
}

/// Signed volume (m3) and the magnitude below which it is rounding.
struct Measured {
  double volume, noise;
};

Measured measure(std::span<const Vec3> vertices, std::span<const SolidFace> faces) {
  const Vec3 about = vertices.front();
  double sum = 0;
  double lost = 0;
  double reach = 0;
  double largest = 0;
  for (const SolidFace& face : faces) {
    const Vec3 a = vertices[face.corners[0]] - about;
    reach = std::max(reach, norm(a));
    for (const std::uint32_t v : face.corners) {
      const Vec3 p = vertices[v];
      largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
    for (std::size_t i = 1; i + 1 < face.corners.size(); ++i) {
      const double part = dot(a, cross(vertices[face.corners[i]] - about, vertices[face.corners[i + 1]] - about)) / 6;
      const double next = sum + part;  // Neumaier 1974
      lost += std::abs(sum) >= std::abs(part) ? (sum - next) + part : (part - next) + sum;
      sum = next;
    }
  }
  return {sum + lost, 8 * std::numeric_limits<double>::epsilon() * largest * reach * reach};
}

}  // namespace

std::expected<Solid, SolidError> Solid::make(std::vector<Vec3> vertices, std::vector<SolidFace> faces,
                                             std::vector<std::string> tags) {
  if (faces.empty()) return std::unexpected(NoFaces{});
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (!in_range(vertices[v])) return std::unexpected(BadVertex{v});
    vertices[v] = flushed(vertices[v]);
  }
  for (std::size_t f = 0; f < faces.size(); ++f) CLEAVE_CHECK(check_face(faces[f], f, vertices.size(), tags.size()));
  Groups groups{faces.size()};
  CLEAVE_CHECK(check_edges(vertices, faces, groups));
  CLEAVE_TRY(const std::vector<SurfaceTriangle> triangles, triangles_of(vertices, faces));
  std::vector<std::uint32_t> shell(faces.size());
  std::uint32_t shells = 0;
  for (std::uint32_t f = 0; f < faces.size(); ++f) {  // a root is the lowest number of its shell, so it comes first
    const std::uint32_t root = groups.find(f);
    shell[f] = root == f ? shells++ : shell[root];
  }
  const auto [volume, noise] = measure(vertices, faces);
  if (std::abs(volume) <= noise) return std::unexpected(NoVolume{cubic_metres(volume)});
  if (const auto crossing = first_crossing_faces(vertices, triangles)) {
    return std::unexpected(FacesCross{crossing->first, crossing->second});
  }
  if (const auto wrong = wrong_shell(vertices, triangles, shell, shells)) return std::unexpected(*wrong);
  if (volume < 0) return std::unexpected(InsideOut{cubic_metres(volume)});
  return Solid{std::move(vertices), std::move(faces), std::move(tags)};
}

Volume Solid::volume() const noexcept { return cubic_metres(measure(vertices_, faces_).volume); }

}  // namespace cleave::geometry
