#include "detail/solids.hpp"

#include <algorithm>

#include "cleave/geometry/triangulate.hpp"
#include "detail/position.hpp"

namespace cleave::topology::detail {
namespace {

using exact::LatticePoint;
using exact::Plane;
using exact::Sign;
using geometry::Vec3;

/// Six times the volume.
double six_volumes(const Vec& o, const Vec& a, const Vec& b, const Vec& c) {
  const Vec u{a[0] - o[0], a[1] - o[1], a[2] - o[2]}, v{b[0] - o[0], b[1] - o[1], b[2] - o[2]},
      w{c[0] - o[0], c[1] - o[1], c[2] - o[2]};
  return (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]));
}

Vec relative(const exact::Lattice& lattice, LatticePoint p) { return lattice.relative(p); }

}  // namespace

std::expected<double, Index> add_half_spaces(const geometry::Solid& solid, std::span<const LatticePoint> sites,
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
    if (!polygon) return std::unexpected(static_cast<Index>(f));
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
  for (std::size_t v = 0; v < sites.size(); ++v) {
    std::vector<Index> meeting;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      if (std::ranges::find(faces[f].corners, static_cast<std::uint32_t>(v)) != faces[f].corners.end()) {
        meeting.push_back(inside[f].plane);
      }
    }
    if (meeting.size() != 3) return std::unexpected(Index{0});
    const Plane &p = out.planes[meeting[0]], &q = out.planes[meeting[1]], &r = out.planes[meeting[2]];
    if (exact::det3_exact(p, q, r) == Sign::zero) return std::unexpected(Index{0});
    corners[v] = meet_position(exact::meet(exact::line_of(p, q), r), p, q, r);
  }
  double volume = 0;
  for (const auto& face : faces) {
    for (std::size_t i = 1; i + 1 < face.corners.size(); ++i) {
      volume +=
          six_volumes(corners[0], corners[face.corners[0]], corners[face.corners[i]], corners[face.corners[i + 1]]);
    }
  }
  const double side = out.lattice.pitch() * 0x1p48;
  if (owner == Owner::domain) {
    out.clip = inside;
    builder.set_domain_corners(std::move(corners));
  }
  return volume * side * side * side / 6;
}

std::expected<double, Index> add_surface(const geometry::Solid& solid, std::span<const LatticePoint> sites,
                                         FacetBuilder& builder, const Prepared& out, Owner owner, Index owner_index) {
  double volume = 0;
  const Vec origin = relative(out.lattice, sites[0]);
  const auto faces = solid.faces();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::vector<LatticePoint> corners;
    for (const std::uint32_t v : faces[f].corners) corners.push_back(sites[v]);
    const Facet facet = blank_facet(owner, owner_index, faces[f].tag);
    const auto add_volume = [&](LatticePoint a, LatticePoint b, LatticePoint c) {
      volume += six_volumes(origin, relative(out.lattice, a), relative(out.lattice, b), relative(out.lattice, c));
    };
    auto polygon = make_lattice_polygon(corners);
    if (!polygon) {
      // A face that the lattice has flattened to a line or point bounds nothing, if its neighbours still close over it:
      // only a triangle with two equal corners does so for certain.
      const bool vanished =
          corners.size() == 3 && (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]);
      if (vanished) continue;
      return std::unexpected(static_cast<Index>(f));
    }
    if (polygon->exactly_planar) {
      for (std::size_t i = 1; i + 1 < corners.size(); ++i) add_volume(corners[0], corners[i], corners[i + 1]);
      if (!builder.add_polygon(*polygon, facet)) return std::unexpected(static_cast<Index>(f));
      continue;
    }
    // The triangles that the solid was checked with; corners on a straight side stay, since the neighbour may use them.
    std::vector<Vec3> exact_corners;
    for (const std::uint32_t v : faces[f].corners) exact_corners.push_back(solid.vertices()[v]);
    const auto triangles = geometry::triangulate(exact_corners);
    if (!triangles || triangles->size() + 2 != corners.size()) return std::unexpected(static_cast<Index>(f));
    for (const auto& [a, b, c] : *triangles) {
      const auto triangle = make_lattice_polygon({corners[a], corners[b], corners[c]});
      if (!triangle) return std::unexpected(static_cast<Index>(f));
      add_volume(corners[a], corners[b], corners[c]);
      if (!builder.add_polygon(*triangle, facet)) return std::unexpected(static_cast<Index>(f));
    }
  }
  return volume / 6;
}

}  // namespace cleave::topology::detail
