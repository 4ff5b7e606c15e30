#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cleave/core/parallel.hpp"
#include "cleave/exact/predicates.hpp"
#include "cleave/facets/gaps.hpp"
#include "cleave/facets/prepared.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/topology/block_complex.hpp"
#include "detail/signs.hpp"

/// The immutable values between the phases of the cutter, in the order they are made.
namespace cleave::topology::detail {

// ---- Phase 2: where facets meet ------------------------------------------------------------------------------------

/// Line of two planes; p is a facet plane, q a facet plane with a higher number or an edge plane.
struct Line {
  Index p, q;
  exact::LineApprox approx;
};

/// A closed piece of a line: the trace of a facet on another, or a side of a facet (outline).
struct Interval {
  Index line;
  HalfSpace lower, upper;          ///< it ends where the line leaves these; in the order of the line's direction
  Index outline_of;                ///< the facet whose side this is; `none` for traces
  bool inside_positive;            ///< outlines: the facet lies on the positive side of its edge plane
  Index edge_plane;                ///< outlines: the edge plane
  std::array<double, 3> from, to;  ///< positions of the ends, units of 2^48 sites
};

struct Traces {
  std::vector<Line> lines;                  ///< sorted by (p, q)
  std::vector<Index> lines_begin;           ///< first line of each plane p (CSR over all planes)
  std::vector<Interval> intervals;          ///< sorted by line
  std::vector<std::uint8_t> with_outlines;  ///< facet planes whose faces may be only partly covered
  Gaps gaps;                                ///< between facets that nearly meet
  [[nodiscard]] Index find_line(Index p, Index q) const;
};
[[nodiscard]] Traces find_traces(const Prepared& prepared, Signs& signs, ThreadLimit threads);

// ---- Phase 3 and 4: vertices and edges -----------------------------------------------------------------------------

using Meet = std::array<Index, 3>;
struct Vertex {
  Meet planes;  ///< any three planes that meet there and nowhere else
  exact::PointApprox approx;
};

/// A line of space with all facet planes that contain it.
struct LineClass {
  Index p, q;  ///< two planes that span it; its direction is nP x nQ
  exact::LineApprox approx;
  Index first_slot, slot_count;  ///< into Graph::slots
};
/// A facet plane that contains a line, with the place of its left half (direction n x d) in the circular order of the
/// 2 k half-planes around the direction d; the right half has the opposite place.
struct Slot {
  Index plane;
  Index left_place;
  Index transversal;  ///< a plane that meets this plane in the line
  bool along;         ///< direction of the line is n_plane x n_transversal (else the opposite)
};

struct Edge {
  Index from, to;  ///< vertices, in the direction of its line
  Index line;      ///< LineClass
  Index first_use, use_count;
};
/// An edge drawn in a facet plane. Its half-edges are 2 use (from -> to, face on the left) and 2 use + 1 (back).
struct Use {
  Index edge;
  Index slot;  ///< into Graph::slots
};
struct OutlineMark {
  Index use;
  Index facet;
  bool facet_on_left;
};

struct Graph {
  std::vector<Vertex> vertices;  ///< until their approximations are let go
  std::vector<Meet> meets;       ///< then: their planes
  std::vector<LineClass> lines;
  std::vector<Slot> slots;
  std::vector<Edge> edges;
  std::vector<Use> uses;              ///< uses of one edge are neighbours
  std::vector<OutlineMark> outlines;  ///< sorted by use

  [[nodiscard]] const Meet& meet(Index vertex) const { return meets.empty() ? vertices[vertex].planes : meets[vertex]; }
  /// Lets go what the faces of planes were found with; their positions are known.
  void let_approximations_go();
};
[[nodiscard]] Graph build_graph(const Prepared& prepared, const Traces& traces, Signs& signs, ThreadLimit threads);

// ---- Phase 5: faces of each plane ----------------------------------------------------------------------------------

struct PlaneFace {
  Index plane;
  Index first_loop, loop_count;    ///< into Arrangement::loops, the outer loop first
  Index first_cover, cover_count;  ///< facets that cover it, into Arrangement::covers
};

/// Of directions in a plane, which are ranks 0 .. 2 n - 1: how far one turns to the left (or, below 0, to the right)
/// from the one to the other, in steps. Turning back is to the right.
[[nodiscard]] constexpr std::int64_t turn_between(Index from, Index to, Index half_turn) noexcept {
  const Index step = to >= from ? to - from : to + 2 * half_turn - from;
  return step < half_turn ? std::int64_t{step} : std::int64_t{step} - 2 * std::int64_t{half_turn};
}
[[nodiscard]] constexpr Index opposite(Index direction, Index half_turn) noexcept {
  return direction < half_turn ? direction + half_turn : direction - half_turn;
}

struct Arrangement {
  std::vector<Index> next;       ///< of each half-edge: the next one of its loop
  std::vector<Index> start;      ///< of each half-edge: the vertex it starts from
  std::vector<Index> rank;       ///< of each slot: rank of the direction of its line in its plane, 0 .. 2 n - 1
  std::vector<Index> half_turn;  ///< n of each facet plane
  std::vector<Index> face;       ///< of each half-edge: the face on its left, `none` where no facet is
  std::vector<PlaneFace> faces;
  std::vector<Index> loops;  ///< a half-edge of each loop
  std::vector<Index> covers;

  /// Rank of the direction of a half-edge in its plane, from the slot of its use and the half turn of the plane.
  [[nodiscard]] Index direction_of(Index half_edge, Index slot, Index half) const {
    return half_edge % 2 == 0 ? rank[slot] : opposite(rank[slot], half);
  }
};
[[nodiscard]] Arrangement arrange(const Prepared& prepared, const Traces& traces, const Graph& graph,
                                  const std::vector<Vec>& positions, Signs& signs, ThreadLimit threads);

/// Until blocks are made, a measure of a plane face is its area (units^2) and, in the place of the centroid, three
/// times the first moment of area about the start of its first loop (units^3); a unit is 2^48 sites.
[[nodiscard]] inline const geometry::Vec3& moment3(const FaceMeasure& measure) noexcept { return measure.centroid; }
[[nodiscard]] std::vector<FaceMeasure> measure_faces(const Prepared& prepared, const Arrangement& arrangement,
                                                     const std::vector<Vec>& positions, ThreadLimit threads);

/// Perimeter of a plane face, at least; units.
[[nodiscard]] double perimeter_of(const Arrangement& arrangement, const std::vector<Vec>& positions, Index face);

/// Three times the volumes of the cones over plane faces from the origin, units^3.
class Cones final {
 public:
  Cones(const Prepared& prepared, const Arrangement& arrangement, const std::vector<Vec>& positions,
        const std::vector<FaceMeasure>& measures) noexcept
      : prepared_{prepared}, arrangement_{arrangement}, positions_{positions}, measures_{measures} {}
  /// Fast where neighbouring faces are asked for one after the other.
  [[nodiscard]] double of(Index face);

 private:
  const Prepared& prepared_;
  const Arrangement& arrangement_;
  const std::vector<Vec>& positions_;
  const std::vector<FaceMeasure>& measures_;
  Index plane_ = none;
  geometry::Vec3 normal_{};
};

// ---- Phase 6: cells -------------------------------------------------------------------------------------------------

/// A flank is a half-edge with a side of its face: 2 h for the side the plane's normal points to, 2 h + 1 for the
/// other.
struct Links {
  /// Of each flank: the one met first when turning around the edge from that side; both look into the same cell. `none`
  /// where there is no face.
  std::vector<Index> to;
  /// Of the flank of each half-edge h from which the turning goes counter-clockwise about the edge (2 h + h % 2):
  /// whether the two faces make an angle of more than half a turn.
  std::vector<std::uint8_t> reflex;
};
/// Only faces for which `present` holds count.
[[nodiscard]] Links link_around_edges(const Graph& graph, const Arrangement& arrangement,
                                      const std::vector<std::uint8_t>& present, ThreadLimit threads);

/// Half-face 2 f looks to the positive side of its plane, 2 f + 1 to the negative side.
struct Cells {
  std::vector<Index> of_half_face;
  Index count = 0;
  std::vector<std::uint8_t> rock;  ///< of each cell: inside the domain and in no excavation
  std::vector<std::uint8_t> in_domain;
  Links links;                             ///< of all covered faces; may be left empty
  std::vector<std::uint8_t> excavated_by;  ///< count x excavations: whether the cell lies in the excavation
};
[[nodiscard]] Cells find_cells(const Prepared& prepared, const Graph& graph, const Arrangement& arrangement,
                               const std::vector<Vec>& positions, const std::vector<FaceMeasure>& measures,
                               ThreadLimit threads);

/// Positions of all vertices, units of 2^48 sites.
[[nodiscard]] std::vector<Vec> positions_of(const Prepared& prepared, const Graph& graph, ThreadLimit threads);

}  // namespace cleave::topology::detail
