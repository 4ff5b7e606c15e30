#include "detail/solids.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "cleave/exact/predicates.hpp"
#include "cleave/geometry/triangulate.hpp"

namespace cleave::topology::detail {
namespace {

using exact::FixedPoint;
using exact::LatticePoint;
using exact::Plane;
using geometry::Vec3;

FixedPoint fixed(LatticePoint p) {
  const auto shifted = [](std::int64_t c) { return static_cast<exact::Int128>(c) * (exact::Int128{1} << 64); };
  return {shifted(p.x), shifted(p.y), shifted(p.z)};
}

}  // namespace

std::vector<std::array<FixedPoint, 3>> surface_of_box(LatticePoint lo, LatticePoint hi) {
  std::vector<std::array<FixedPoint, 3>> triangles;
  const auto corner = [&](unsigned k) {
    return fixed({(k & 1U) != 0 ? hi.x : lo.x, (k & 2U) != 0 ? hi.y : lo.y, (k & 4U) != 0 ? hi.z : lo.z});
  };
  constexpr std::array<std::array<unsigned, 4>, 6> sides{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& [a, b, c, d] : sides) {
    triangles.push_back({corner(a), corner(b), corner(c)});
    triangles.push_back({corner(a), corner(c), corner(d)});
  }
  return triangles;
}

std::optional<Index> add_half_spaces(const geometry::Solid& solid, std::span<const LatticePoint> sites,
                                     FacetBuilder& builder, Prepared& out, Owner owner, Index owner_index) {
  const auto faces = solid.faces();
  std::vector<HalfSpace> inside(faces.size());
  Vec lo{1, 1, 1}, hi{-1, -1, -1};
  for (const LatticePoint& s : sites) {
    const Vec c{static_cast<double>(s.x) * lattice_unit, static_cast<double>(s.y) * lattice_unit,
                static_cast<double>(s.z) * lattice_unit};
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], c[k]);
      hi[k] = std::max(hi[k], c[k]);
    }
  }
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::vector<LatticePoint> corners;
    for (const std::uint32_t v : faces[f].corners) corners.push_back(sites[v]);
    const auto polygon = make_lattice_polygon(std::move(corners));
    if (!polygon) return static_cast<Index>(f);
    const auto [plane, same] = builder.add_plane(polygon->plane);
    inside[f] = {plane, !same};
  }
  const auto neighbours = [&](std::size_t a, std::size_t b) {  // share an edge
    std::size_t common = 0;
    for (const std::uint32_t v : faces[a].corners)
      common += static_cast<std::size_t>(std::ranges::count(faces[b].corners, v));
    return a != b && common >= 2;
  };
  for (std::size_t f = 0; f < faces.size(); ++f) {
    FacetBuilder::Piece piece{blank_facet(owner, owner_index, faces[f].tag), {}, {}, {}};
    piece.facet.plane = inside[f].plane;
    piece.facet.outward_positive = !inside[f].inside_positive;
    for (std::size_t g = 0; g < faces.size(); ++g) {
      if (neighbours(f, g)) piece.pool_edges.push_back(inside[g]);
    }
    for (std::size_t k = 0; k < 3; ++k) {  // corners are good to the planarity tolerance only
      piece.facet.lo[k] = lo[k] - 1e-5;
      piece.facet.hi[k] = hi[k] + 1e-5;
    }
    builder.add_piece(std::move(piece));
  }
  // The corners that the planes really have.
  std::vector<Vec> corners(sites.size());
  std::vector<FixedPoint> exact_corners(sites.size());
  for (std::size_t v = 0; v < sites.size(); ++v) {
    std::vector<Index> meeting;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      if (std::ranges::find(faces[f].corners, static_cast<std::uint32_t>(v)) != faces[f].corners.end()) {
        meeting.push_back(inside[f].plane);
      }
    }
    if (meeting.size() != 3) return Index{0};
    const Plane &p = out.planes[meeting[0]], &q = out.planes[meeting[1]], &r = out.planes[meeting[2]];
    const auto exact_corner = exact::fixed_meet(p, q, r);
    if (!exact_corner) return Index{0};
    exact_corners[v] = *exact_corner;
    corners[v] = exact::meet_position(exact::meet(exact::line_of(p, q), r), p, q, r);
  }
  if (owner == Owner::domain) {
    for (const auto& face : faces) {
      for (std::size_t i = 1; i + 1 < face.corners.size(); ++i) {
        out.domain_surface.push_back(
            {exact_corners[face.corners[0]], exact_corners[face.corners[i]], exact_corners[face.corners[i + 1]]});
      }
    }
    out.clip = inside;
    builder.set_domain_corners(std::move(corners));
  }
  return std::nullopt;
}

std::optional<Index> add_surface(const geometry::Solid& solid, std::span<const LatticePoint> sites,
                                 FacetBuilder& builder, Prepared& out, Owner owner, Index owner_index) {
  const auto bound = [&](LatticePoint a, LatticePoint b, LatticePoint c) {
    if (owner == Owner::domain) out.domain_surface.push_back({fixed(a), fixed(b), fixed(c)});
  };
  const auto faces = solid.faces();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::vector<LatticePoint> corners;
    for (const std::uint32_t v : faces[f].corners) corners.push_back(sites[v]);
    const Facet facet = blank_facet(owner, owner_index, faces[f].tag);
    auto polygon = make_lattice_polygon(corners);
    if (!polygon) {
      // A face that the lattice has flattened to a line or point bounds nothing, if its neighbours still close over it:
      // only a triangle with two equal corners does so for certain.
      const bool vanished =
          corners.size() == 3 && (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]);
      if (vanished) continue;
      return static_cast<Index>(f);
    }
    if (polygon->exactly_planar) {
      for (std::size_t i = 1; i + 1 < corners.size(); ++i) bound(corners[0], corners[i], corners[i + 1]);
      if (!builder.add_polygon(*polygon, facet)) return static_cast<Index>(f);
      continue;
    }
    // The triangles that the solid was checked with; corners on a straight side stay, since the neighbour may use them.
    std::vector<Vec3> exact_corners;
    for (const std::uint32_t v : faces[f].corners) exact_corners.push_back(solid.vertices()[v]);
    const auto triangles = geometry::triangulate(exact_corners);
    if (!triangles || triangles->size() + 2 != corners.size()) return static_cast<Index>(f);
    for (const auto& [a, b, c] : *triangles) {
      const auto triangle = make_lattice_polygon({corners[a], corners[b], corners[c]});
      if (!triangle) return static_cast<Index>(f);
      bound(corners[a], corners[b], corners[c]);
      if (!builder.add_polygon(*triangle, facet)) return static_cast<Index>(f);
    }
  }
  return std::nullopt;
}

}  // namespace cleave::topology::detail
