#include "cleave/flow/flow.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/disjoint_sets.hpp"
#include "discretisation.hpp"

namespace cleave::flow {

namespace {

RockSurface surface_of(const topology::JointBorder& border) {
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
  std::ranges::sort(out.surfaces, domain_first);
  const auto repeated = std::ranges::unique(out.surfaces);
  out.surfaces.erase(repeated.begin(), repeated.end());
  for (const auto& border : network.borders) {
    const auto place = std::ranges::lower_bound(out.surfaces, surface_of(border), domain_first);
    out.of_border.push_back(static_cast<std::uint32_t>(place - out.surfaces.begin()));
  }
  return out;
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
