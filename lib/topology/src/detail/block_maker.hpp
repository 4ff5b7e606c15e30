#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "detail/face_packer.hpp"
#include "detail/phases.hpp"

namespace cleave::topology::detail {

class FixedMeasure;

/// What a half-face is to its block.
struct Nature {
  Role role = Role::joint;
  Index joint = none, excavation = none, tag = none;
};

/// All that is known before blocks are made one by one, in any order.
struct BlockParts {
  const Prepared& prepared;
  const Graph& graph;
  const Arrangement& arrangement;
  const std::vector<Vec>& positions;
  std::vector<FaceMeasure> measures;
  const CutInput& input;
  const std::vector<std::uint8_t>* excavated;  ///< of each excavation: whether it is out; null: all are
  std::vector<geometry::Vec3> normals;         ///< unit normal of each facet plane
  std::vector<Index> block_of;                 ///< of each half-face; none where there is no rock
  std::vector<std::uint8_t> present;           ///< of each face: it has different blocks on its sides
  Links links;                                 ///< between the present faces; makers use up what is of their blocks
  std::vector<Index> slot_of;                  ///< of each use: its slot
  std::vector<Index> line_of_slot;             ///< of each slot: its line
  std::vector<Index> begin, half_faces;        ///< half-faces of each block in order (CSR)
  std::vector<Index> sheets;                   ///< of each face: Facet::sheet; empty where no polygon is folded
  std::vector<Index> before;                   ///< with sheets: of each half-edge, the one before it in its loop
  double straight = 0;                         ///< with sheets: units that a side of one may be bent by
  double scale = 0;                            ///< m of a unit, a power of two
  double sliver_below = 0;                     ///< m
  geometry::Vec3 origin;                       ///< m

  [[nodiscard]] Nature nature(Index half_face) const;
  /// The plane that a face is on: that of its sheet where it is a piece of one.
  [[nodiscard]] Index plane_of(Index face) const {
    return sheets.empty() || sheets[face] == none ? arrangement.faces[face].plane : sheets[face];
  }
  /// Whether a half-face looks to the positive side of that plane. Pieces of a sheet that was folded back over itself
  /// look to either side.
  [[nodiscard]] bool looks_up(Index half_face) const {
    const Index plane = plane_of(half_face / 2), own = arrangement.faces[half_face / 2].plane;
    return (half_face % 2 == 0) == (plane == own || geometry::dot(normals[plane], normals[own]) > 0);
  }
  [[nodiscard]] Index half_face_of(Index flank) const { return 2 * arrangement.face[flank / 2] + flank % 2; }
  [[nodiscard]] geometry::Vec3 position(Index vertex) const {
    const Vec& p = positions[vertex];
    return {p[0], p[1], p[2]};
  }
  /// Where the first loop of a plane face starts.
  [[nodiscard]] geometry::Vec3 apex(Index face) const {
    return position(arrangement.start[arrangement.loops[arrangement.faces[face].first_loop]]);
  }
  [[nodiscard]] Index plane_faces() const { return static_cast<Index>(arrangement.faces.size()); }
  /// The centroid of an area (m, absolute), from its moment about an apex; all in units.
  [[nodiscard]] geometry::Vec3 centre(geometry::Vec3 apex, geometry::Vec3 moment, double area) const {
    return area > 0 ? origin + scale * (apex + moment / area) : origin;
  }
  /// Of one plane face.
  [[nodiscard]] FaceMeasure in_metres(Index face) const {
    const FaceMeasure& m = measures[face];
    return {scale * scale * std::abs(m.area), centre(apex(face), geometry::Vec3{} + moment3(m) / 3, m.area)};
  }
};

/// Faces of neighbouring blocks; corners are vertices of the graph still.
struct MadeBlocks {
  PackedFaces faces;
  std::vector<VertexId> corners;
  std::vector<Index> hole_starts;
};

/// Makes blocks one by one and adds their faces to a MadeBlocks.
class BlockMaker final {
 public:
  /// `links` are those of the parts, and shared by all makers: each writes only to the flanks of its own blocks.
  BlockMaker(const BlockParts& parts, std::vector<Index>& links, MadeBlocks& out)
      : parts_{parts}, links_{links}, out_{out}, packer_{out.faces, parts.normals, parts.plane_faces()} {}

  [[nodiscard]] Block make(Index block);

 private:
  /// One side of a merged face of the block, in the order in which the loops are walked (counter-clockwise seen from
  /// outside the block).
  struct Side {
    Index flank;
    Index head;     ///< the vertex where it ends
    Index next;     ///< the side after it in its loop
    Index partner;  ///< the side of the face met next around the edge, inside the block; until paired, its flank
    Index face;     ///< of the block
    bool dropped;   ///< its head is a straight vertex, no corner
  };
  struct Loop {
    Index first, count;
  };
  static constexpr Index walked = Index{1} << 31U;  // flanks have smaller numbers

  [[nodiscard]] bool walk_faces_alone(std::span<const Index> half_faces);
  void begin_walk();
  void close_loop(Index first, bool backwards);
  void group_faces(std::span<const Index> half_faces);
  void walk_faces();
  void walk_loops(Index half_face, Index face);
  void walk_loop(Index start, Index face);
  void walk_folded_loop(Index start, Index face);
  void count_left();
  [[nodiscard]] bool spared(Index side, Index other) const;
  [[nodiscard]] bool straight_on_a_sheet(Index side) const;
  void pair_sides();
  void count_vertices();
  void find_shells();
  void add_face(Index face, Index block);
  void measure_alone(Face& made, Index half_face, const Nature& nature);
  void measure_together(Face& made, std::span<const Index> members, const Nature& nature);
  /// The block beyond a half-face of a joint.
  [[nodiscard]] std::optional<BlockId> neighbour(Index half_face, Role role) const;
  void add_loops(Index face, Face& made);
  void pack_faces();
  [[nodiscard]] bool turns_left(const Loop& loop, Index plane) const;
  [[nodiscard]] double area_of(const Loop& loop, geometry::Vec3 outward) const;
  [[nodiscard]] bool has_reflex_edge() const;
  void measure(Block& block);
  [[nodiscard]] FixedMeasure measure_exactly();
  [[nodiscard]] double thickness();
  /// A flank whose face goes straight on beyond the edge, in one role: inside a merged face.
  [[nodiscard]] bool internal(Index flank) const;
  [[nodiscard]] Index link(Index flank) const { return links_[flank] & ~walked; }
  [[nodiscard]] double perimeter(Index half_face) const;

  const BlockParts& parts_;
  std::vector<Index>& links_;  ///< of flanks that are walked already with the mark `walked`, of paired ones their sides
  MadeBlocks& out_;
  FacePacker packer_;

  std::vector<Face> faces_;        ///< of the block
  std::vector<Patch> patches_;     ///< of those
  bool any_internal_ = false;      ///< some edge of the plane faces is none of the block
  std::vector<Index> members_;     ///< half-faces of the block by face
  std::vector<Index> face_begin_;  ///< first member of each face
  std::vector<Index> group_;       ///< of each half-face: its face (while grouping: union-find)
  std::vector<Side> sides_;
  std::vector<Loop> loops_;
  std::vector<Index> loops_begin_;  ///< first loop of each face
  std::vector<Index> shell_;        ///< of each face
  std::vector<Index> corners_;      ///< vertices of the block
  std::vector<std::uint8_t> seen_;
  std::vector<Index> loop_of_, left_;  ///< of each side its loop, and the corners left of each; where there are sheets
  std::vector<double> shell_volumes_;
  std::vector<Index> by_area_;
  std::size_t half_edges_ = 0;  ///< of the block's half-faces
  Index vertex_count_ = 0, edge_sides_ = 0, shell_count_ = 0;
};

}  // namespace cleave::topology::detail
