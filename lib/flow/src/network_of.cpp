#include "cleave/flow/flow.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/disjoint_sets.hpp"
#include "cleave/core/overloaded.hpp"
#include "discretisation.hpp"

namespace cleave::flow {

namespace {

template <class Border>
RockSurface surface_of(const Border& border) {
  if (border.excavation) return {border.role, border.excavation, std::nullopt};
  return {border.role, std::nullopt, border.tag};
}

bool domain_first(const RockSurface& a, const RockSurface& b) {
  return a.excavation != b.excavation ? a.excavation < b.excavation : a < b;
}

void contract_short_sides(Mesh& mesh) {
  const double shortest = 1e-11 * extent_of(mesh);
  DisjointSets<Index> same{mesh.points.size()};
  bool any = false;
  for (const auto& corners : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = corners[k], b = corners[(k + 1) % 3];
      if (geometry::norm(mesh.points[b] - mesh.points[a]) > shortest) continue;
      same.join(a, b);
      any = true;
    }
  }
  if (!any) return;
  Mesh kept{.points = mesh.points};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const std::array corners{same.find(a), same.find(b), same.find(c)};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    kept.triangles.push_back(corners);
    kept.part.push_back(mesh.part[t]);
  }
  const Sides sides{kept};
  std::set<std::pair<Index, Index>> seen;
  for (const Border& border : mesh.borders) {
    const Index a = same.find(border.ends[0]), b = same.find(border.ends[1]);
    if (a != b && sides.find(a, b) && seen.insert(std::minmax(a, b)).second)
      kept.borders.push_back({{a, b}, border.surface});
  }
  mesh = std::move(kept);
}

}  // namespace

JointSurfaces surfaces_of(const topology::JointNetwork& network) {
  JointSurfaces out;
  for (const auto& border : network.borders) out.surfaces.push_back(surface_of(border));
  for (const auto& other : network.others) out.surfaces.push_back(surface_of(other));
  std::ranges::sort(out.surfaces, domain_first);
  const auto repeated = std::ranges::unique(out.surfaces);
  out.surfaces.erase(repeated.begin(), repeated.end());
  const auto number = [&](const RockSurface& surface) {
    const auto place = std::ranges::lower_bound(out.surfaces, surface, domain_first);
    return static_cast<std::uint32_t>(place - out.surfaces.begin());
  };
  for (const auto& border : network.borders) out.of_border.push_back(number(surface_of(border)));
  for (const auto& other : network.others) out.others.emplace_back(other.border, number(surface_of(other)));
  return out;
}

std::expected<void, HeadsMeet> settle_edges(const topology::BlockComplex& complex, std::span<const Surface> conditions,
                                            JointSurfaces& surfaces) {
  if (surfaces.others.empty()) return {};
  std::vector<geometry::Vec3> points;
  for (const geometry::Vec3& p : complex.vertices()) points.push_back(p);
  const double near = same_head * extent_of(Mesh{.points = std::move(points)});
  for (const auto& [border, other] : surfaces.others) {
    auto ends = complex.network()->borders[border].ends;
    if (complex.vertices()[ends[1]].z < complex.vertices()[ends[0]].z) std::swap(ends[0], ends[1]);
    const geometry::Vec3 foot = complex.vertices()[ends[0]], head = complex.vertices()[ends[1]];
    // At the foot, where water passes.
    const auto head_of = [&](std::uint32_t surface) {
      return std::visit(overloaded{[](const Closed&) { return std::optional<double>{}; },
                                   [&](const Drained&) { return std::optional{foot.z}; },
                                   [&](const Standing& s) {
                                     const double level = s.level.si();
                                     const bool below = foot.z < level || head.z <= level;
                                     return below ? std::optional{level} : std::nullopt;
                                   }},
                        conditions[surface]);
    };
    std::uint32_t& own = surfaces.of_border[border];
    const auto here = head_of(own), there = head_of(other);
    if (!there) continue;
    if (here && std::abs(*here - *there) > near) return std::unexpected(HeadsMeet{own, other, foot, *here, *there});
    if (!here) own = other;
  }
  return {};
}

Mesh mesh_of(const topology::BlockComplex& complex, const JointSurfaces& surfaces) {
  Mesh mesh = mesh_as_cut(complex, surfaces);
  contract_short_sides(mesh);
  return mesh;
}

Mesh mesh_as_cut(const topology::BlockComplex& complex, const JointSurfaces& surfaces) {
  CLEAVE_ASSERT(complex.network().has_value());
  const topology::JointNetwork& network = *complex.network();
  std::vector<Index> number(complex.vertices().size(), none);
  Mesh mesh;
  const auto point = [&](topology::VertexId v) {
    Index& own = number[v.index()];
    if (own == none) {
      own = static_cast<Index>(mesh.points.size());
      mesh.points.push_back(complex.vertices()[v]);
    }
    return own;
  };
  for (Index p = 0; p < network.pieces.size(); ++p) {
    const topology::JointPiece& piece = network.pieces[p];
    for (std::uint32_t t = piece.first_triangle; t < piece.first_triangle + piece.triangle_count; ++t) {
      const auto& [a, b, c] = network.triangles[t];
      mesh.triangles.push_back({point(a), point(b), point(c)});
      mesh.part.push_back(p);
    }
  }
  for (std::size_t b = 0; b < network.borders.size(); ++b) {
    const auto& ends = network.borders[b].ends;
    mesh.borders.push_back({{point(ends[0]), point(ends[1])}, surfaces.of_border[b]});
  }
  return mesh;
}

}  // namespace cleave::flow
