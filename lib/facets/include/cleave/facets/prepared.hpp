#pragma once

#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <initializer_list>
#include <span>
#include <vector>

#include "cleave/exact/fixed.hpp"
#include "cleave/exact/plane.hpp"
#include "cleave/facets/cut_input.hpp"

/// Stage 1 of the cutter: the input on the lattice, as distinct planes and convex facets on them.
///
/// Inside the cutter plain indices are used (planes, facets, lines, edges, half-edges are renumbered and packed all the
/// time); strong ids begin at the BlockComplex.
namespace cleave::topology::detail {

using Index = std::uint32_t;
inline constexpr Index none = UINT32_MAX;
using Vec = std::array<double, 3>;

/// The axes of the view in which a plane shows its shape best: all but the one nearest to its normal (x, y, z, ...).
struct View {
  std::size_t u, v;
  explicit View(const auto& normal) noexcept {
    const double x = std::abs(normal[0]), y = std::abs(normal[1]), z = std::abs(normal[2]);
    const std::size_t dropped = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    u = dropped == 0 ? 1 : 0;
    v = dropped == 2 ? 1 : 2;
  }
};

/// A plane of the pool with the side that counts as inside.
struct HalfSpace {
  Index plane;
  bool inside_positive;
};

enum class Owner : std::uint8_t { joint, domain, excavation, window };

/// A convex flat piece of a joint or of a solid's surface: the part of its plane inside all its edge half-spaces.
/// Edge planes pass through two corners on the lattice along one common direction that is close to the plane's normal.
struct Facet {
  Index plane;
  Owner owner;
  bool outward_positive;             ///< solids: the outward normal is the plane's normal
  Index owner_index;                 ///< joint, or excavation
  Index tag;                         ///< face tag of the solid
  Index first_edge, edge_count;      ///< into Prepared::edges
  Index first_corner, corner_count;  ///< into Prepared::corners; none for half-space solids
  Vec lo, hi;                        ///< bounding box in units of 2^48 sites, grown so that it is safe
  Index sheet = none;  ///< of a piece of a folded polygon: the facet plane that stands for all its pieces (folds.hpp)
  bool rim_shared = false;  ///< each side of its polygon in the domain is another polygon's too, and some are
};

/// Corners that planes are known to hold, by number: what is drawn from common corners meets in them, and that needs no
/// determinant. Empty where no polygons share any.
struct HeldCorners {
  std::vector<Index> begin, corners;  ///< of each plane, ascending (CSR)
  [[nodiscard]] bool any() const noexcept { return !corners.empty(); }
  [[nodiscard]] std::span<const Index> of(Index plane) const {
    return std::span{corners}.subspan(begin[plane], begin[plane + std::size_t{1}] - begin[plane]);
  }
  /// Whether all these planes hold `count` corners in common.
  [[nodiscard]] bool common(std::initializer_list<Index> planes, int count) const;
};

/// A joint drawn to end on another one.
struct Ending {
  Index joint, other;
  friend auto operator<=>(const Ending&, const Ending&) = default;
};

struct Prepared {
  explicit Prepared(const exact::Lattice& l) noexcept : lattice{l} {}
  exact::Lattice lattice;
  std::vector<exact::Plane>
      planes;  ///< [0, facet_planes) distinct, first non-zero normal component positive; then edge planes
  Index facet_planes = 0;
  std::vector<HalfSpace> edges;
  std::vector<Vec> corners;  ///< approximate corners of facets, on the facet's plane, units of 2^48 sites
  std::vector<Facet> facets;
  std::vector<Index> facets_begin, facets_on;  ///< facets of each facet plane (CSR)
  std::vector<HalfSpace> clip;  ///< half-spaces of the window and of a convex domain; edges of joints already
  /// What bounds the domain, or the window when there is one: triangles, counter-clockwise seen from outside.
  std::vector<std::array<exact::FixedPoint, 3>> domain_surface;
  bool windowed = false;
  Length largest_snap;
  CoarseSnap coarse_snap;
  NearMisses open_rims;  ///< slits within a surface
  std::uint64_t merged_planes = 0, adopted_edges = 0;
  std::vector<SnappedJoint> snapped;
  std::vector<Index> outside;  ///< joints whose box misses the domain's
  Index joint_count = 0, excavation_count = 0;
  bool draw_outlines = false;  ///< of all joints
  bool has_sheets = false;     ///< some facets are pieces of folded polygons
  HeldCorners held;
  double bend = 0;       ///< sites: the farthest that a corner of a sheet lies off its plane
  double roundings = 0;  ///< sites: how far corners may be off where they were meant to be by roundings of doubles
};

/// `endings`: what misses another joint by roundings goes just beyond it.
[[nodiscard]] std::expected<Prepared, CutError> prepare(const CutInput& input, std::span<const Ending> endings = {});

}  // namespace cleave::topology::detail
