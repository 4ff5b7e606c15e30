#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/triangulate.hpp"
#include "detail/holes.hpp"
#include "detail/lattice_polygon.hpp"
#include "detail/position.hpp"
#include "detail/prepared.hpp"
#include "detail/snapping.hpp"

namespace cleave::topology::detail {
namespace {

using exact::LatticePoint;
using exact::Plane;
using exact::Sign;
using geometry::Vec3;

constexpr double unit = 0x1p-48;
/// Growth of bounding boxes, in units of 2^48 sites: far above every error of an approximate corner.
constexpr double box_margin = 0x1p-36;

struct PlaneKey {
  std::array<exact::Int128, 3> normal;
  exact::Wide offset;
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
    mix(std::bit_cast<std::uint64_t>(key.offset.convert_to<double>()));
    return h;
  }
};

class Builder {
 public:
  explicit Builder(Prepared& out) : out_{out} {}

  /// Number of the plane in the pool and whether its canonical normal is the given one's.
  std::pair<Index, bool> add_plane(const Plane& plane) {
    const auto& n = plane.normal();
    const auto first = std::ranges::find_if(n, [](exact::Int128 c) { return c != 0; });
    const bool same = *first > 0;
    const Plane canonical = same ? plane : plane.flipped();
    const auto [entry, inserted] =
        numbers_.try_emplace(PlaneKey{canonical.normal(), canonical.offset()}, static_cast<Index>(out_.planes.size()));
    if (inserted) out_.planes.push_back(canonical);
    return {entry->second, same};
  }

  struct Piece {  // a facet before edge planes have numbers
    Facet facet;
    std::vector<Plane> own_edges;
    std::vector<HalfSpace> pool_edges;
    std::vector<Vec> corners;
  };

  /// Facets of one polygon: itself when convex, its triangles when not. False when it crosses itself on the lattice.
  bool add_polygon(const LatticePolygon& polygon, Facet facet, std::span<const std::optional<HalfSpace>> adopted = {}) {
    if (facet.owner == Owner::joint && misses_window(polygon.corners)) return true;  // seen only after snapping
    const auto [plane, same] = add_plane(polygon.plane);
    facet.plane = plane;
    facet.outward_positive = same;  // corners turn counter-clockwise seen from outside
    if (polygon.convex) {
      add_convex(polygon.corners, polygon, facet, adopted);
      return true;
    }
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

  /// Facets of a polygon with holes: triangles. False when outlines cross.
  bool add_with_holes(const LatticePolygon& polygon, std::vector<std::vector<LatticePoint>> holes, Facet facet) {
    const auto [plane, same] = add_plane(polygon.plane);
    facet.plane = plane;
    facet.outward_positive = same;
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
        const auto without = std::ranges::remove_if(piece.own_edges, [&](const Plane& edge) {
          return !domain_corners_.empty() && safely_inside(domain_corners_, edge, true);
        });
        const bool whole = without.empty();
        piece.own_edges.erase(without.begin(), without.end());
        for (const HalfSpace& side : out_.clip) {
          const Plane& plane = out_.planes[side.plane];
          const bool cuts_nothing = !piece.corners.empty() && safely_inside(piece.corners, plane, side.inside_positive);
          if (!cuts_nothing || !(whole || plane.parallel_to(out_.planes[facet.plane]))) out_.edges.push_back(side);
        }
      }
      for (const Plane& edge : piece.own_edges) {
        out_.edges.push_back({static_cast<Index>(out_.planes.size()), true});
        out_.planes.push_back(edge);
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
  }

  /// The sides of the window, which clip the joints. False when it is flat on the lattice.
  bool add_window(LatticePoint lo, LatticePoint hi) {
    if (lo.x >= hi.x || lo.y >= hi.y || lo.z >= hi.z) return false;
    const LatticePoint x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    const std::array<std::array<LatticePoint, 3>, 6> sides{
        {{lo, y, z}, {hi, z, y}, {lo, z, x}, {hi, x, z}, {lo, x, y}, {hi, y, x}}};  // positive inside
    std::array<HalfSpace, 6> inside{};
    for (std::size_t s = 0; s < 6; ++s) {
      const auto [plane, same] = add_plane(Plane::spanned(sides[s][0], sides[s][1], sides[s][2]).value());
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
  static Vec grown(LatticePoint p, double by) {
    return {static_cast<double>(p.x) * unit + by, static_cast<double>(p.y) * unit + by,
            static_cast<double>(p.z) * unit + by};
  }

  [[nodiscard]] bool misses_window(std::span<const LatticePoint> corners) const {
    if (!out_.windowed) return false;
    Vec lo{1, 1, 1}, hi{-1, -1, -1};
    for (const LatticePoint& p : corners) {
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

  void add_convex(std::span<const LatticePoint> corners, const LatticePolygon& polygon, const Facet& facet,
                  std::span<const std::optional<HalfSpace>> adopted) {
    Piece piece{facet, {}, {}, {}};
    const auto& n = polygon.plane.approx();
    const Vec w{static_cast<double>(polygon.along.x), static_cast<double>(polygon.along.y),
                static_cast<double>(polygon.along.z)};
    const double rate = n[0] * w[0] + n[1] * w[1] + n[2] * w[2];
    Vec lo{1, 1, 1}, hi{-1, -1, -1};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const LatticePoint a = corners[i], b = corners[(i + 1) % corners.size()];
      if (!adopted.empty() && adopted[i]) {
        piece.pool_edges.push_back(*adopted[i]);
      } else {
        const auto edge = Plane::spanned(a, polygon.along, b - a);
        CLEAVE_ASSERT(edge.has_value());
        piece.own_edges.push_back(*edge);
      }
      const Vec c{static_cast<double>(a.x) * unit, static_cast<double>(a.y) * unit, static_cast<double>(a.z) * unit};
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

  static bool safely_inside(std::span<const Vec> points, const Plane& plane, bool inside_positive) {
    const auto& n = plane.approx();
    const double sense = inside_positive ? 1 : -1;
    return std::ranges::all_of(
        points, [&](const Vec& p) { return sense * (n[0] * p[0] + n[1] * p[1] + n[2] * p[2] + n[3]) > 0x1p-34; });
  }

  Prepared& out_;
  std::unordered_map<PlaneKey, Index, PlaneKeyHash> numbers_;
  std::vector<Piece> pieces_;
  std::vector<Vec> domain_corners_;
  Vec window_lo_{}, window_hi_{};

 public:
  double adoption_margin_ = box_margin;
};

Facet blank(Owner owner, Index owner_index, Index tag) {
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
          .hi = {}};
}

/// Six times the volume.
double six_volumes(const Vec& o, const Vec& a, const Vec& b, const Vec& c) {
  const Vec u{a[0] - o[0], a[1] - o[1], a[2] - o[2]}, v{b[0] - o[0], b[1] - o[1], b[2] - o[2]},
      w{c[0] - o[0], c[1] - o[1], c[2] - o[2]};
  return (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]));
}

Vec relative(const exact::Lattice& lattice, LatticePoint p) { return lattice.relative(p); }

/// A box or hexahedron as the common inside of its faces' planes. Returns its volume, or the face that has collapsed.
std::expected<double, Index> add_half_spaces(const geometry::Solid& solid, std::span<const LatticePoint> sites,
                                             Builder& builder, Prepared& out, Owner owner, Index owner_index) {
  const auto faces = solid.faces();
  std::vector<HalfSpace> inside(faces.size());
  Vec lo{1, 1, 1}, hi{-1, -1, -1};
  for (const LatticePoint& s : sites) {
    const Vec c{static_cast<double>(s.x) * unit, static_cast<double>(s.y) * unit, static_cast<double>(s.z) * unit};
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
    Builder::Piece piece{blank(owner, owner_index, faces[f].tag), {}, {}, {}};
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

/// A general closed surface: faces that are exactly planar on the lattice stay whole, all others become triangles on
/// their own corners, so that it stays closed. Returns its volume, or the face that has collapsed.
std::expected<double, Index> add_surface(const geometry::Solid& solid, std::span<const LatticePoint> sites,
                                         Builder& builder, const Prepared& out, Owner owner, Index owner_index) {
  double volume = 0;
  const Vec origin = relative(out.lattice, sites[0]);
  const auto faces = solid.faces();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::vector<LatticePoint> corners;
    for (const std::uint32_t v : faces[f].corners) corners.push_back(sites[v]);
    const Facet facet = blank(owner, owner_index, faces[f].tag);
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

struct Bounds {
  std::array<double, 3> lo, hi;
  Bounds() {
    lo.fill(std::numeric_limits<double>::infinity());
    hi.fill(-std::numeric_limits<double>::infinity());
  }
  void add(Vec3 p) {
    const std::array c{p.x, p.y, p.z};
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], c[k]);
      hi[k] = std::max(hi[k], c[k]);
    }
  }
};

/// Apart by more than a polygon's corners leave its plane.
bool far_apart(const Bounds& polygon, const Bounds& region, double pitch) {
  double size = 0, farthest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    size += polygon.hi[k] - polygon.lo[k];
    farthest = std::max({farthest, std::abs(polygon.lo[k]), std::abs(polygon.hi[k])});
  }
  const double margin = 1e-5 * size + 1e-13 * farthest + 16 * pitch;
  for (std::size_t k = 0; k < 3; ++k) {
    if (polygon.lo[k] - margin > region.hi[k] || polygon.hi[k] + margin < region.lo[k]) return true;
  }
  return false;
}

/// Sites that are corners of more than one polygon. A polygon given twice counts once: repeating a joint changes
/// nothing.
class SharedSites {
 public:
  void add(std::vector<LatticePoint> sites) {
    std::ranges::sort(sites);
    const auto repeated = std::ranges::unique(sites);
    sites.erase(repeated.begin(), repeated.end());
    begin_.push_back(sites_.size());
    sites_.insert(sites_.end(), sites.begin(), sites.end());
  }
  void finish() {
    begin_.push_back(sites_.size());
    std::vector<std::span<const LatticePoint>> polygons;
    for (std::size_t i = 0; i + 1 < begin_.size(); ++i) {
      polygons.push_back(std::span{sites_}.subspan(begin_[i], begin_[i + 1] - begin_[i]));
    }
    std::ranges::sort(polygons, [](auto a, auto b) { return std::ranges::lexicographical_compare(a, b); });
    const auto repeated = std::ranges::unique(polygons, [](auto a, auto b) { return std::ranges::equal(a, b); });
    polygons.erase(repeated.begin(), repeated.end());
    std::vector<LatticePoint> uses;
    for (const auto polygon : polygons) uses.insert(uses.end(), polygon.begin(), polygon.end());
    std::ranges::sort(uses);
    sites_.clear();
    for (std::size_t i = 1; i < uses.size(); ++i) {
      if (uses[i] == uses[i - 1] && (sites_.empty() || sites_.back() != uses[i])) sites_.push_back(uses[i]);
    }
  }
  /// After `finish`: which of these are shared.
  [[nodiscard]] std::vector<std::size_t> among(std::span<const LatticePoint> sites) const {
    std::vector<std::size_t> shared;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (std::ranges::binary_search(sites_, sites[i])) shared.push_back(i);
    }
    return shared;
  }

 private:
  std::vector<LatticePoint> sites_;
  std::vector<std::size_t> begin_;
};

/// The plane of a persistent joint: lattice vectors that depend on the orientation alone, so equal orientations are
/// exactly parallel.
std::optional<Plane> persistent_plane(const PersistentJoint& joint, const exact::Lattice& lattice) {
  const Vec3 n = geometry::normalized(joint.normal);
  const Vec3 helper = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = geometry::normalized(geometry::cross(n, helper));
  const Vec3 v = geometry::cross(n, u);
  const auto site = [](Vec3 d) {
    const auto c = [](double x) { return static_cast<std::int64_t>(std::nearbyint(std::ldexp(x, 46))); };
    return LatticePoint{c(d.x), c(d.y), c(d.z)};
  };
  return Plane::spanned(lattice.snap(joint.through.x, joint.through.y, joint.through.z), site(u), site(v));
}

/// The point that tells which part of a joint is kept.
LatticePoint middle_of(const std::variant<Joint, PersistentJoint>& joint, const exact::Lattice& lattice) {
  Vec3 middle{};
  if (const auto* polygons = std::get_if<Joint>(&joint)) {
    double count = 0;
    for (const auto& polygon : polygons->polygons) {
      for (const Vec3& v : polygon.corners()) {
        ++count;
        middle += (v - middle) / count;
      }
    }
  } else {
    middle = std::get<PersistentJoint>(joint).through;
  }
  return lattice.snap(middle.x, middle.y, middle.z);
}

}  // namespace

std::expected<Prepared, CutError> prepare(const CutInput& input) {
  Bounds scene, domain;
  for (const Vec3& v : input.domain.vertices()) domain.add(v);
  scene = domain;
  for (const auto& solid : input.excavations) {
    for (const Vec3& v : solid.vertices()) scene.add(v);
  }
  for (const auto& entry : input.joints) {
    std::visit(overloaded{[&](const Joint& joint) {
                            for (const auto& polygon : joint.polygons) {
                              for (const Vec3& v : polygon.corners()) scene.add(v);
                            }
                          },
                          [&](const PersistentJoint& joint) { scene.add(joint.through); }},
               entry);
  }
  const exact::Lattice lattice = exact::Lattice::covering(scene.lo, scene.hi);
  Prepared out{lattice};
  out.joint_count = static_cast<Index>(input.joints.size());
  out.excavation_count = static_cast<Index>(input.excavations.size());

  Snapper snapper{lattice, input.snap.si()};
  const auto sites_of = [&](std::span<const Vec3> points) {
    std::vector<LatticePoint> sites;
    sites.reserve(points.size());
    for (const Vec3& p : points) sites.push_back(snapper.site(p));
    return sites;
  };

  Builder builder{out};
  builder.adoption_margin_ = box_margin + 4 * input.snap.si() / lattice.pitch() * unit;
  const auto add_solid = [&](const geometry::Solid& solid, Owner owner, Index index) {
    const auto sites = sites_of(solid.vertices());
    auto volume = solid.from_half_spaces() ? add_half_spaces(solid, sites, builder, out, owner, index)
                                           : add_surface(solid, sites, builder, out, owner, index);
    for (const auto& face : solid.faces()) {
      std::vector<LatticePoint> corners;
      for (const std::uint32_t v : face.corners) corners.push_back(sites[v]);
      if (auto polygon = make_lattice_polygon(std::move(corners))) snapper.remember(*polygon);
    }
    return volume;
  };
  const auto domain_volume = add_solid(input.domain, Owner::domain, 0);
  if (!domain_volume) {
    return std::unexpected(CutError{SolidCollapsed{std::nullopt, domain_volume.error(), metres(lattice.pitch())}});
  }
  out.domain_volume = *domain_volume;
  for (std::size_t e = 0; e < input.excavations.size(); ++e) {
    if (const auto volume = add_solid(input.excavations[e], Owner::excavation, static_cast<Index>(e)); !volume) {
      return std::unexpected(
          CutError{SolidCollapsed{static_cast<std::uint32_t>(e), volume.error(), metres(lattice.pitch())}});
    }
  }

  Bounds region = domain;  // what is outside it cuts nothing
  if (input.window) {
    const auto clamped = [&](Vec3 p) {
      return lattice.snap(std::clamp(p.x, domain.lo[0], domain.hi[0]), std::clamp(p.y, domain.lo[1], domain.hi[1]),
                          std::clamp(p.z, domain.lo[2], domain.hi[2]));
    };
    const LatticePoint lo = clamped(input.window->min), hi = clamped(input.window->max);
    if (!builder.add_window(lo, hi)) return std::unexpected(CutError{WindowOutside{}});
    const Vec3 window_min = input.window->min, window_max = input.window->max;
    const auto narrow = [&](std::size_t k, double from, double to) {
      region.lo[k] = std::max(region.lo[k], from);
      region.hi[k] = std::min(region.hi[k], to);
    };
    narrow(0, window_min.x, window_max.x);
    narrow(1, window_min.y, window_max.y);
    narrow(2, window_min.z, window_max.z);
    const LatticePoint size = hi - lo;
    out.domain_volume = static_cast<double>(size.x) * lattice.pitch() *
                        (static_cast<double>(size.y) * lattice.pitch()) *
                        (static_cast<double>(size.z) * lattice.pitch());
  }

  // Joints: first all polygons on the lattice (with corners, then planes snapped), then their facets (with edges
  // snapped). Corners that two polygons share are the first choice for what fixes their planes: edges that were meant
  // to be shared then are.
  SharedSites shared;
  for (const auto& entry : input.joints) {
    if (const auto* joint = std::get_if<Joint>(&entry)) {
      for (const auto& polygon : joint->polygons) shared.add(sites_of(polygon.corners()));
    }
  }
  shared.finish();
  struct JointPolygon {
    Index joint;
    LatticePolygon polygon;
    std::vector<std::vector<LatticePoint>> holes;
  };
  std::vector<JointPolygon> polygons;
  const auto ended_on = [&](std::size_t j) {  // its plane is needed wherever it lies
    return std::ranges::find(input.terminations, JointId{j}, &Termination::at) != input.terminations.end();
  };
  for (std::size_t j = 0; j < input.joints.size(); ++j) {
    const JointCollapsed collapsed{JointId{j}, metres(lattice.pitch())};
    if (const auto* joint = std::get_if<Joint>(&input.joints[j])) {
      Bounds own;
      for (std::size_t k = 0; k < joint->polygons.size(); ++k) {
        const auto& polygon = joint->polygons[k];
        Bounds box;
        for (const Vec3& v : polygon.corners()) {
          own.add(v);
          box.add(v);
        }
        if (!snapper.active() && !ended_on(j) && far_apart(box, region, lattice.pitch())) continue;  // cuts nothing
        snapper.begin_joint(static_cast<Index>(j));
        auto sites = sites_of(polygon.corners());
        const auto preferred = shared.among(sites);
        auto made = make_lattice_polygon(std::move(sites), preferred);
        if (!made) return std::unexpected(CutError{collapsed});
        std::vector<std::vector<LatticePoint>> holes;
        if (k < joint->holes.size()) {
          for (const auto& hole : joint->holes[k]) holes.push_back(sites_of(hole.corners()));
        }
        polygons.push_back({static_cast<Index>(j), std::move(*made), std::move(holes)});
      }
      bool apart = joint->polygons.empty();
      for (std::size_t k = 0; k < 3; ++k) apart = apart || own.hi[k] < domain.lo[k] || own.lo[k] > domain.hi[k];
      if (apart) out.outside.push_back(static_cast<Index>(j));
    } else {
      const auto& persistent = std::get<PersistentJoint>(input.joints[j]);
      const auto plane = persistent_plane(persistent, lattice);
      if (!plane) return std::unexpected(CutError{collapsed});
      snapper.remember(*plane);
      // Bounded by a box well around the domain, so that its outline means something where other joints share its
      // plane.
      const LatticePoint lo = lattice.snap(domain.lo[0], domain.lo[1], domain.lo[2]);
      const LatticePoint hi = lattice.snap(domain.hi[0], domain.hi[1], domain.hi[2]);
      constexpr std::int64_t margin = 1 << 20;
      Builder::Piece piece{blank(Owner::joint, static_cast<Index>(j), 0), {}, {}, {}};
      const auto [number, same] = builder.add_plane(*plane);
      piece.facet.plane = number;
      const LatticePoint x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
      const LatticePoint a{lo.x - margin, lo.y - margin, lo.z - margin}, b{hi.x + margin, hi.y + margin, hi.z + margin};
      const std::array<std::array<LatticePoint, 3>, 6> sides{
          {{a, y, z}, {b, z, y}, {a, z, x}, {b, x, z}, {a, x, y}, {b, y, x}}};
      for (const auto& [site, u, v] : sides) {
        const Plane side = Plane::spanned(site, u, v).value();
        if (!side.parallel_to(*plane)) piece.own_edges.push_back(side);
      }
      piece.facet.lo = {-1, -1, -1};
      piece.facet.hi = {1, 1, 1};
      builder.add_piece(std::move(piece));
    }
  }
  if (snapper.active()) {
    std::vector<const LatticePolygon*> all;
    all.reserve(polygons.size());
    for (const auto& entry : polygons) all.push_back(&entry.polygon);
    snapper.begin_merging(all);
    for (auto& entry : polygons) {
      snapper.begin_joint(entry.joint);
      snapper.merge_plane(entry.polygon);
    }
  }
  for (auto& [joint, polygon, holes] : polygons) {
    const JointCollapsed collapsed{JointId{joint}, metres(lattice.pitch())};
    if (!holes.empty()) {
      if (!builder.add_with_holes(polygon, std::move(holes), blank(Owner::joint, joint, 0))) {
        return std::unexpected(CutError{collapsed});
      }
      continue;
    }
    std::vector<std::optional<HalfSpace>> adopted;
    if (snapper.active()) {
      snapper.begin_joint(joint);
      adopted = snapper.adopt_edges(polygon, [&](const Plane& plane) { return builder.add_plane(plane); });
    }
    if (!builder.add_polygon(polygon, blank(Owner::joint, joint, 0), adopted)) {
      return std::unexpected(CutError{collapsed});
    }
  }
  for (const auto& [joint, at] : input.terminations) {
    const auto plane = builder.plane_of_joint(at.value());
    const Sign side = plane ? out.planes[*plane].side_of(middle_of(input.joints[joint.index()], lattice)) : Sign::zero;
    if (side == Sign::zero) return std::unexpected(CutError{TerminationUndecided{joint, at}});
    builder.cut_off(joint.value(), {*plane, side == Sign::positive});
  }
  out.keep_dangling = input.keep_dangling;
  builder.finish();
  out.largest_snap = snapper.largest_move();
  out.merged_planes = snapper.merged_planes();
  out.adopted_edges = snapper.adopted_edges();
  out.snapped = snapper.changed();
  return out;
}

}  // namespace cleave::topology::detail
