#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "cleave/core/assert.hpp"
#include "cleave/facets/prepared.hpp"
#include "detail/convex_pieces.hpp"
#include "detail/holes.hpp"
#include "detail/lattice_polygon.hpp"

namespace cleave::topology::detail {

inline constexpr double lattice_unit = 0x1p-48;
/// Growth of bounding boxes, in units of 2^48 sites: far above every error of an approximate corner.
inline constexpr double box_margin = 0x1p-36;

struct PlaneKey {
  std::array<exact::Int128, 3> normal;
  exact::Int192 offset;
  friend bool operator==(const PlaneKey&, const PlaneKey&) = default;
};
struct PlaneKeyHash {
  std::size_t operator()(const PlaneKey& key) const noexcept {
    std::uint64_t h = 0x9E3779B97F4A7C15U;
    const auto mix = [&h](std::uint64_t v) {
      h = (h ^ v) * 0xFF51AFD7ED558CCDU;
      h ^= h >> 32U;
    };
    for (const exact::Int128 c : key.normal) {
      mix(static_cast<std::uint64_t>(c));
      mix(static_cast<std::uint64_t>(c >> 64));
    }
    for (const std::uint64_t word : key.offset.words) mix(word);
    return h;
  }
};

/// Collects planes and facets, and numbers them.
class FacetBuilder final {
 public:
  explicit FacetBuilder(Prepared& out) : out_{out} {}

  /// Number of the plane in the pool and whether its canonical normal is the given one's.
  std::pair<Index, bool> add_plane(const exact::Plane& plane) {
    const auto& n = plane.normal();
    const auto first = std::ranges::find_if(n, [](exact::Int128 c) { return c != 0; });
    const bool same = *first > 0;
    const exact::Plane canonical = same ? plane : plane.flipped();
    const auto [entry, inserted] =
        numbers_.try_emplace(PlaneKey{canonical.normal(), canonical.offset()}, static_cast<Index>(out_.planes.size()));
    if (inserted) out_.planes.push_back(canonical);
    return {entry->second, same};
  }

  struct Piece {  // a facet before edge planes have numbers
    Facet facet;
    std::vector<exact::Plane> own_edges;
    std::vector<HalfSpace> pool_edges;
    std::vector<Vec> corners;
    std::vector<std::array<Index, 2>> edge_corners = {};  ///< numbers of the corners that each own edge plane holds
  };

  /// Facets of one polygon: itself when convex, convex pieces when not. False when it crosses itself on the lattice.
  /// `needed`: its plane is asked for later, wherever it lies.
  bool add_polygon(const LatticePolygon& polygon, Facet facet, std::span<const std::optional<HalfSpace>> adopted = {},
                   bool needed = false) {
    // Seen only after snapping.
    if (facet.owner == Owner::joint && !needed && misses_window(polygon.corners)) return true;
    const auto [plane, same] = add_plane(polygon.plane);
    facet.plane = plane;
    facet.outward_positive = same;  // corners turn counter-clockwise seen from outside
    if (polygon.convex) {
      add_convex(polygon.corners, polygon, facet, adopted);
      return true;
    }
    if (add_pieces(std::array{polygon.corners}, polygon, facet, adopted)) return true;
    const auto triangles = triangulate(polygon);
    if (triangles.empty()) return false;
    for (const auto& [a, b, c] : triangles) {
      const std::array corners{polygon.corners[a], polygon.corners[b], polygon.corners[c]};
      // Only sides of the polygon may adopt a plane, diagonals keep their own.
      std::array<std::optional<HalfSpace>, 3> sides{};
      if (!adopted.empty()) {
        const std::array indices{a, b, c};
        for (std::size_t k = 0; k < 3; ++k) {
          if (indices[(k + 1) % 3] == (indices[k] + 1) % polygon.corners.size()) sides[k] = adopted[indices[k]];
        }
      }
      add_convex(corners, polygon, facet, adopted.empty() ? std::span<const std::optional<HalfSpace>>{} : sides);
    }
    return true;
  }

  /// The plane that stands for the pieces of folded polygons.
  Index add_sheet(const exact::Plane& plane) {
    out_.has_sheets = true;
    return add_plane(plane).first;
  }
  /// Facets of a folded polygon: each triangle on its own three corners.
  void add_folded(std::span<const std::array<exact::LatticePoint, 3>> triangles, const Facet& facet) {
    for (const auto& [a, b, c] : triangles) {
      const auto triangle = make_lattice_polygon({a, b, c});
      if (triangle) add_polygon(*triangle, facet);
    }
  }

  /// Facets of a polygon with holes. False when outlines cross.
  bool add_with_holes(const LatticePolygon& polygon, std::vector<std::vector<exact::LatticePoint>> holes, Facet facet) {
    const auto [plane, same] = add_plane(polygon.plane);
    facet.plane = plane;
    facet.outward_positive = same;
    if (!tidy_holes(holes, polygon.along)) return false;
    std::vector<std::vector<exact::LatticePoint>> loops{polygon.corners};
    loops.insert(loops.end(), holes.begin(), holes.end());
    if (add_pieces(loops, polygon, facet, {})) return true;
    const auto triangles = triangulate_with_holes(polygon, std::move(holes));
    for (const auto& corners : triangles) add_convex(corners, polygon, facet, {});
    return !triangles.empty();
  }

  /// The one plane of all pieces of a joint; none where they have several.
  [[nodiscard]] std::optional<Index> plane_of_joint(Index joint) const {
    std::optional<Index> plane;
    for (const Piece& piece : pieces_) {
      if (piece.facet.owner != Owner::joint || piece.facet.owner_index != joint) continue;
      if (plane && *plane != piece.facet.plane) return std::nullopt;
      plane = piece.facet.plane;
    }
    return plane;
  }
  void cut_off(Index joint, HalfSpace keep) {
    for (Piece& piece : pieces_) {
      if (piece.facet.owner == Owner::joint && piece.facet.owner_index == joint) piece.pool_edges.push_back(keep);
    }
  }

  /// Of a domain that clips the joints.
  void set_domain_corners(std::vector<Vec> corners) { domain_corners_ = std::move(corners); }
  void add_piece(Piece piece) { pieces_.push_back(std::move(piece)); }

  /// Facet planes are complete: number the edge planes behind them and fill the flat arrays.
  void finish() {
    out_.facet_planes = static_cast<Index>(out_.planes.size());
    for (Piece& piece : pieces_) {
      Facet facet = piece.facet;
      facet.first_edge = static_cast<Index>(out_.edges.size());
      for (const HalfSpace& edge : piece.pool_edges) out_.edges.push_back(edge);
      if (facet.owner == Owner::joint) {
        // A convex domain cuts its joints to size: what is outside is of no interest. (Excavations are kept whole: what
        // is void is told by crossing closed surfaces.) Sides that the whole domain lies inside of are then no longer
        // needed, nor are sides of the domain that cut nothing off; but where sides of the joint go, those of the
        // domain must stay, unless they are parallel to it.
        const bool whole = !drop_edges_beyond_domain(piece);
        for (const HalfSpace& side : out_.clip) {
          const exact::Plane& plane = out_.planes[side.plane];
          const bool cuts_nothing = !piece.corners.empty() && safely_inside(piece.corners, plane, side.inside_positive);
          if (!cuts_nothing || !(whole || plane.parallel_to(out_.planes[facet.plane]))) out_.edges.push_back(side);
        }
      }
      for (std::size_t e = 0; e < piece.own_edges.size(); ++e) {
        const auto number = static_cast<Index>(out_.planes.size());
        if (!piece.edge_corners.empty()) {
          for (const Index corner : piece.edge_corners[e]) held_.emplace_back(number, corner);
        }
        out_.edges.push_back({number, true});
        out_.planes.push_back(piece.own_edges[e]);
      }
      facet.edge_count = static_cast<Index>(out_.edges.size()) - facet.first_edge;
      facet.first_corner = static_cast<Index>(out_.corners.size());
      facet.corner_count = static_cast<Index>(piece.corners.size());
      out_.corners.insert(out_.corners.end(), piece.corners.begin(), piece.corners.end());
      out_.facets.push_back(facet);
    }
    out_.facets_begin.assign(out_.facet_planes + std::size_t{1}, 0);
    for (const Facet& facet : out_.facets) ++out_.facets_begin[facet.plane + std::size_t{1}];
    for (std::size_t i = 1; i < out_.facets_begin.size(); ++i) out_.facets_begin[i] += out_.facets_begin[i - 1];
    out_.facets_on.resize(out_.facets.size());
    auto next = out_.facets_begin;
    for (Index f = 0; f < out_.facets.size(); ++f) out_.facets_on[next[out_.facets[f].plane]++] = f;
    finish_held();
  }

  /// From here on it is kept which corners planes hold. `corners`: sorted, all that facets will have.
  void number_corners(std::vector<exact::LatticePoint> corners) { numbered_ = std::move(corners); }

  /// The sides of the window, which clip the joints. False when it is flat on the lattice.
  bool add_window(exact::LatticePoint lo, exact::LatticePoint hi) {
    if (lo.x >= hi.x || lo.y >= hi.y || lo.z >= hi.z) return false;
    const exact::LatticePoint x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    const std::array<std::array<exact::LatticePoint, 3>, 6> sides{
        {{lo, y, z}, {hi, z, y}, {lo, z, x}, {hi, x, z}, {lo, x, y}, {hi, y, x}}};  // positive inside
    std::array<HalfSpace, 6> inside{};
    for (std::size_t s = 0; s < 6; ++s) {
      const auto [plane, same] = add_plane(exact::Plane::spanned(sides[s][0], sides[s][1], sides[s][2]).value());
      inside[s] = {plane, same};
    }
    for (std::size_t s = 0; s < 6; ++s) {
      Piece piece{{}, {}, {}, {}};
      piece.facet.plane = inside[s].plane;
      piece.facet.owner = Owner::window;
      piece.facet.outward_positive = !inside[s].inside_positive;
      piece.facet.lo = window_lo_ = grown(lo, -box_margin);
      piece.facet.hi = window_hi_ = grown(hi, box_margin);
      for (std::size_t t = 0; t < 6; ++t) {
        if (t / 2 != s / 2) piece.pool_edges.push_back(inside[t]);
      }
      add_piece(std::move(piece));
    }
    out_.windowed = true;
    out_.clip.insert(out_.clip.end(), inside.begin(), inside.end());
    return true;
  }

 private:
  /// Whether there were any.
  bool drop_edges_beyond_domain(Piece& piece) const {
    if (domain_corners_.empty()) return false;
    std::size_t kept = 0;
    for (std::size_t e = 0; e < piece.own_edges.size(); ++e) {
      if (safely_inside(domain_corners_, piece.own_edges[e], true)) continue;
      if (kept != e) piece.own_edges[kept] = piece.own_edges[e];
      if (!piece.edge_corners.empty()) piece.edge_corners[kept] = piece.edge_corners[e];
      ++kept;
    }
    if (kept == piece.own_edges.size()) return false;
    piece.own_edges.erase(piece.own_edges.begin() + static_cast<std::ptrdiff_t>(kept), piece.own_edges.end());
    return true;
  }

  void finish_held() {
    if (held_.empty()) return;
    std::ranges::sort(held_);
    const auto again = std::ranges::unique(held_);
    held_.erase(again.begin(), again.end());
    out_.held.begin.assign(out_.planes.size() + 1, 0);
    for (const auto& [plane, corner] : held_) {
      ++out_.held.begin[plane + std::size_t{1}];
      out_.held.corners.push_back(corner);
    }
    for (std::size_t p = 1; p < out_.held.begin.size(); ++p) out_.held.begin[p] += out_.held.begin[p - 1];
  }
  [[nodiscard]] Index number_of(exact::LatticePoint corner) const {
    const auto found = std::ranges::lower_bound(numbered_, corner);
    return found != numbered_.end() && *found == corner ? static_cast<Index>(found - numbered_.begin()) : none;
  }
  void hold_corners(Index plane_number, const ConvexPiece& part, const exact::Plane& plane) {
    for (const ConvexPiece::Side& side : part.sides) {
      if (plane.side_of(side.at) == exact::Sign::zero) held_.emplace_back(plane_number, number_of(side.at));
    }
  }

  static Vec grown(exact::LatticePoint p, double by) {
    return {static_cast<double>(p.x) * lattice_unit + by, static_cast<double>(p.y) * lattice_unit + by,
            static_cast<double>(p.z) * lattice_unit + by};
  }

  [[nodiscard]] bool misses_window(std::span<const exact::LatticePoint> corners) const {
    if (!out_.windowed) return false;
    Vec lo{1, 1, 1}, hi{-1, -1, -1};
    for (const exact::LatticePoint& p : corners) {
      const Vec c = grown(p, 0);
      for (std::size_t k = 0; k < 3; ++k) {
        lo[k] = std::min(lo[k], c[k]);
        hi[k] = std::max(hi[k], c[k]);
      }
    }
    for (std::size_t k = 0; k < 3; ++k) {
      // Corners lie off their plane by up to the planarity tolerance.
      const double margin = 2 * adoption_margin_ + 0x1p-16 * (hi[k] - lo[k]) + 0x1p-20;
      if (hi[k] + margin < window_lo_[k] || lo[k] - margin > window_hi_[k]) return true;
    }
    return false;
  }

  /// False where loops touch or cross.
  bool add_pieces(std::span<const std::vector<exact::LatticePoint>> loops, const LatticePolygon& polygon,
                  const Facet& facet, std::span<const std::optional<HalfSpace>> adopted) {
    const auto pieces = convex_pieces(loops, polygon.along);
    for (const ConvexPiece& piece : pieces) add_convex(piece, polygon, facet, adopted);
    return !pieces.empty();
  }
  void add_convex(std::span<const exact::LatticePoint> corners, const LatticePolygon& polygon, const Facet& facet,
                  std::span<const std::optional<HalfSpace>> adopted) {
    whole_.sides.clear();
    whole_.corners.clear();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const exact::LatticePoint a = corners[i], b = corners[(i + 1) % corners.size()];
      whole_.sides.push_back({a, b - a, i});
      whole_.corners.push_back({static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)});
    }
    add_convex(whole_, polygon, facet, adopted);
  }
  void add_convex(const ConvexPiece& part, const LatticePolygon& polygon, const Facet& facet,
                  std::span<const std::optional<HalfSpace>> adopted) {
    Piece piece{facet, {}, {}, {}};
    piece.own_edges.reserve(part.sides.size());
    piece.corners.reserve(part.corners.size());
    const auto keeps = [&](const ConvexPiece::Side& side) {
      return side.number == ConvexPiece::cut || adopted.empty() || !adopted[side.number];
    };
    for (const ConvexPiece::Side& side : part.sides) {
      if (!keeps(side)) {
        piece.pool_edges.push_back(*adopted[side.number]);
        continue;
      }
      const auto edge = exact::Plane::spanned(side.at, polygon.along, side.direction);
      CLEAVE_ASSERT(edge.has_value());
      piece.own_edges.push_back(*edge);
      if (numbered_.empty()) continue;
      // A cut goes through one site only.
      const exact::LatticePoint end = side.number == ConvexPiece::cut ? side.at : side.at + side.direction;
      piece.edge_corners.push_back({number_of(side.at), number_of(end)});
    }
    if (!numbered_.empty()) hold_corners(facet.plane, part, polygon.plane);
    const auto& n = polygon.plane.approx();
    const Vec w{static_cast<double>(polygon.along.x), static_cast<double>(polygon.along.y),
                static_cast<double>(polygon.along.z)};
    const double rate = n[0] * w[0] + n[1] * w[1] + n[2] * w[2];
    Vec lo{1, 1, 1}, hi{-1, -1, -1};
    for (const Vec& corner : part.corners) {
      const Vec c{corner[0] * lattice_unit, corner[1] * lattice_unit, corner[2] * lattice_unit};
      const double off = (n[0] * c[0] + n[1] * c[1] + n[2] * c[2] + n[3]) / rate;
      Vec projected{};
      for (std::size_t k = 0; k < 3; ++k) {
        projected[k] = c[k] - off * w[k];
        lo[k] = std::min(lo[k], projected[k]);
        hi[k] = std::max(hi[k], projected[k]);
      }
      piece.corners.push_back(projected);
    }
    // An adopted edge may move the outline by up to the snapping distance: corners are no longer safe for quick
    // rejection.
    const bool moved = !piece.pool_edges.empty();
    double margin = box_margin;
    if (moved) {
      piece.corners.clear();
      margin = adoption_margin_;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      piece.facet.lo[k] = lo[k] - margin;
      piece.facet.hi[k] = hi[k] + margin;
    }
    pieces_.push_back(std::move(piece));
  }

  static bool safely_inside(std::span<const Vec> points, const exact::Plane& plane, bool inside_positive) {
    const auto& n = plane.approx();
    const double sense = inside_positive ? 1 : -1;
    return std::ranges::all_of(
        points, [&](const Vec& p) { return sense * (n[0] * p[0] + n[1] * p[1] + n[2] * p[2] + n[3]) > 0x1p-34; });
  }

  Prepared& out_;
  std::unordered_map<PlaneKey, Index, PlaneKeyHash> numbers_;
  std::vector<Piece> pieces_;
  ConvexPiece whole_;  ///< of the polygon at hand
  std::vector<exact::LatticePoint> numbered_;
  std::vector<std::pair<Index, Index>> held_;  ///< plane, corner
  std::vector<Vec> domain_corners_;
  Vec window_lo_{}, window_hi_{};

 public:
  double adoption_margin_ = box_margin;
};

/// A facet of which only the owner is known.
[[nodiscard]] inline Facet blank_facet(Owner owner, Index owner_index, Index tag) {
  return {.plane = 0,
          .owner = owner,
          .outward_positive = true,
          .owner_index = owner_index,
          .tag = tag,
          .first_edge = 0,
          .edge_count = 0,
          .first_corner = 0,
          .corner_count = 0,
          .lo = {},
          .hi = {},
          .sheet = none,
          .rim_shared = false};
}

}  // namespace cleave::topology::detail
