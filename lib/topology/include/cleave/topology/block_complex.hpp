#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cleave/core/assert.hpp"
#include "cleave/core/id.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/exact/plane.hpp"
#include "cleave/facets/cut_input.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::topology {

using PlaneId = Id<struct PlaneTag>;  ///< one a distinct plane; coplanar joints share it
using VertexId = Id<struct VertexTag>;
using FaceId = Id<struct FaceTag>;  ///< a face of one block (not shared)
using BlockId = Id<struct BlockTag>;

/// Neighbouring face numbers: the faces of one block.
using FaceRange = IdRange<FaceId>;

/// The loops of one face, each a span of corners; the outer loop first.
class LoopRange final {
 public:
  class Iterator {
   public:
    using value_type = std::span<const VertexId>;
    using difference_type = std::ptrdiff_t;
    Iterator() = default;
    Iterator(const LoopRange& loops, std::size_t at) noexcept
        : corners_{loops.corners_}, holes_{loops.holes_}, at_{at} {}
    [[nodiscard]] value_type operator*() const { return LoopRange{corners_, holes_}[at_]; }
    Iterator& operator++() noexcept {
      ++at_;
      return *this;
    }
    Iterator operator++(int) noexcept {
      Iterator old = *this;
      ++at_;
      return old;
    }
    friend bool operator==(const Iterator& a, const Iterator& b) noexcept { return a.at_ == b.at_; }

   private:
    std::span<const VertexId> corners_;
    std::span<const std::uint32_t> holes_;
    std::size_t at_ = 0;
  };

  /// `holes` say where the second, third, ... loop begins in `corners`.
  LoopRange(std::span<const VertexId> corners, std::span<const std::uint32_t> holes) noexcept
      : corners_{corners}, holes_{holes} {}

  [[nodiscard]] std::size_t size() const noexcept { return corners_.empty() ? 0 : 1 + holes_.size(); }
  [[nodiscard]] bool empty() const noexcept { return corners_.empty(); }
  [[nodiscard]] std::span<const VertexId> operator[](std::size_t k) const {
    const std::size_t first = k == 0 ? 0 : holes_[k - 1];
    const std::size_t last = k < holes_.size() ? holes_[k] : corners_.size();
    return corners_.subspan(first, last - first);
  }
  [[nodiscard]] std::span<const VertexId> front() const { return (*this)[0]; }
  [[nodiscard]] Iterator begin() const noexcept { return {*this, 0}; }
  [[nodiscard]] Iterator end() const noexcept { return {*this, size()}; }
  /// The corners of all loops, one loop after another.
  [[nodiscard]] std::span<const VertexId> all_corners() const noexcept { return corners_; }

 private:
  std::span<const VertexId> corners_;
  std::span<const std::uint32_t> holes_;
};

/// What lies behind a face of a block.
enum class Role : std::uint8_t {
  joint,   ///< another block, across a joint
  fixed,   ///< a domain side that is not free: rock that never moves
  free,    ///< air: an excavation, or a domain side named free
  window,  ///< the edge of the part that was cut (CutInput::window): what lies behind it was not looked at
};

/// A part of a face with one joint and one neighbour.
struct Patch {
  std::optional<JointId> joint;      ///< none on free and fixed faces
  std::optional<BlockId> neighbour;  ///< none on free and fixed faces
  Area area;
  geometry::Vec3 centroid;  ///< m, absolute coordinates
};

/// The patches of one face: those that are kept, or the only one, which follows from the face. The references that it
/// gives are good as long as it is there itself.
class PatchRange final {
 public:
  explicit PatchRange(std::span<const Patch> kept) noexcept : kept_{kept} {}
  explicit PatchRange(const Patch& only) noexcept : only_{only}, alone_{true} {}

  [[nodiscard]] std::size_t size() const noexcept { return all().size(); }
  [[nodiscard]] bool empty() const noexcept { return all().empty(); }
  [[nodiscard]] Patch operator[](std::size_t k) const { return all()[k]; }
  [[nodiscard]] Patch front() const { return all().front(); }
  [[nodiscard]] auto begin() const noexcept { return all().begin(); }
  [[nodiscard]] auto end() const noexcept { return all().end(); }

 private:
  [[nodiscard]] std::span<const Patch> all() const noexcept { return alone_ ? std::span<const Patch>{only_} : kept_; }

  std::span<const Patch> kept_;
  std::array<Patch, 1> only_{};
  bool alone_ = false;
};

/// A flat face of one block: coplanar pieces of the same role that touch along edges are one face. Where several
/// coplanar joints (or excavations) make up one face, `joint`, `excavation` and `tag` are those of its first piece; the
/// patches have the joint of each part. Loops and patches lie in flat arrays of the complex: `BlockComplex::loops` and
/// `BlockComplex::patches` give them.
struct Face {
  BlockId block;
  PlaneId plane;
  /// True when the plane's coefficient normal points INTO the block (the block lies on the plane's positive side).
  bool block_on_positive_side;
  Role role;
  std::uint32_t shell;           ///< of its block: 0 = outer, others are walls of cavities
  std::optional<JointId> joint;  ///< the joint of role joint
  /// Index into CutInput::excavations for free faces made by an excavation; none for free domain sides.
  std::optional<std::uint32_t> excavation;
  /// Tag index of the domain solid (or of the excavation) for free and fixed faces.
  std::optional<std::uint32_t> tag;
  geometry::Vec3 outward;  ///< unit normal out of the block (the theory's m; n = -m points in)
  Area area;
  geometry::Vec3 centroid;                           ///< m, absolute
  std::uint32_t first_corner = 0, corner_count = 0;  ///< corners of all loops, into Data::corners
  std::uint32_t first_hole = 0, hole_count = 0;      ///< into Data::hole_starts
  /// Into Data::patches. Of faces that a BlockComplex gives: for `BlockComplex::patches` alone.
  std::uint32_t first_patch = 0, patch_count = 0;
};

namespace detail {
class FacePacker;

/// Area (m^2) and centroid (m, absolute) of a face. The cutter has other measures of plane faces in the same place
/// first (phases.hpp).
struct FaceMeasure {
  double area;
  geometry::Vec3 centroid;
};
}  // namespace detail

/// All faces with their patches, in a fifth of the room: the normal is that of the plane, corners go on where those of
/// the face before end, both sides of a contact share area and centroid, and one patch alone is its face again. A face
/// of which something of this does not hold is kept whole, so each is given back as it was put in, bit for bit.
class PackedFaces final {
 public:
  class Iterator {
   public:
    using value_type = Face;
    using difference_type = std::ptrdiff_t;
    Iterator() = default;
    Iterator(const PackedFaces& faces, std::uint32_t at) noexcept : faces_{&faces}, at_{at} {}
    [[nodiscard]] Face operator*() const { return (*faces_)[FaceId{at_}]; }
    Iterator& operator++() noexcept {
      ++at_;
      return *this;
    }
    Iterator operator++(int) noexcept {
      Iterator old = *this;
      ++at_;
      return old;
    }
    friend bool operator==(const Iterator& a, const Iterator& b) noexcept { return a.at_ == b.at_; }

   private:
    const PackedFaces* faces_ = nullptr;
    std::uint32_t at_ = 0;
  };

  [[nodiscard]] Face operator[](FaceId id) const {
    CLEAVE_ASSERT(id.index() < records_.size());
    const Record& r = records_[id.index()];
    if ((r.plane & whole) != 0) return whole_[r.measure];
    const detail::FaceMeasure& m = measures_[r.measure];
    const auto [first, last] = corners(id);
    const auto role = static_cast<Role>(r.plane >> 1U & 3U);
    const bool positive = (r.plane & 1U) != 0, joint = role == Role::joint;
    const geometry::Vec3& normal = normals_[r.plane >> plane_shift];
    Face face{.block = BlockId{r.block},
              .plane = PlaneId{r.plane >> plane_shift},
              .block_on_positive_side = positive,
              .role = role,
              .shell = 0,
              .joint = joint ? std::optional{JointId{r.cause}} : std::nullopt,
              .excavation = joint || r.cause == nothing ? std::nullopt : std::optional{r.cause},
              .tag = joint || r.beyond == nothing ? std::nullopt : std::optional{r.beyond},
              .outward = positive ? -normal : normal,
              .area = square_metres(m.area),
              .centroid = m.centroid,
              .first_corner = first,
              .corner_count = last - first};
    if (joint && (r.beyond & several) != 0) {
      face.first_patch = lists_[r.beyond & ~several].first;
      face.patch_count = lists_[r.beyond & ~several].count;
    } else {
      face.first_patch = joint ? several | r.beyond : nothing;
      face.patch_count = 1;
    }
    return face;
  }
  [[nodiscard]] std::size_t size() const noexcept { return records_.size(); }
  [[nodiscard]] bool empty() const noexcept { return records_.empty(); }
  /// All ids in order.
  [[nodiscard]] IdRange<FaceId> ids() const noexcept { return {FaceId{0}, static_cast<std::uint32_t>(size())}; }
  [[nodiscard]] Iterator begin() const noexcept { return {*this, 0}; }
  [[nodiscard]] Iterator end() const noexcept { return {*this, static_cast<std::uint32_t>(size())}; }

  /// As of the face, at less cost than all of it.
  [[nodiscard]] BlockId block(FaceId id) const {
    CLEAVE_ASSERT(id.index() < records_.size());
    return BlockId{records_[id.index()].block};
  }
  [[nodiscard]] PlaneId plane(FaceId id) const {
    CLEAVE_ASSERT(id.index() < records_.size());
    const Record& r = records_[id.index()];
    return (r.plane & whole) != 0 ? whole_[r.measure].plane : PlaneId{r.plane >> plane_shift};
  }
  /// Calls `visit(neighbour, area)` for each patch of the face that has a block behind it.
  template <class Visit>
  void visit_neighbours(FaceId id, Visit&& visit) const {
    CLEAVE_ASSERT(id.index() < records_.size());
    const Record& r = records_[id.index()];
    const auto all_of = [&](std::uint32_t first, std::uint32_t count) {
      for (const Patch& patch : std::span{patches_}.subspan(first, count)) {
        if (patch.neighbour) visit(*patch.neighbour, patch.area);
      }
    };
    if ((r.plane & whole) != 0) {
      all_of(whole_[r.measure].first_patch, whole_[r.measure].patch_count);
    } else if (static_cast<Role>(r.plane >> 1U & 3U) == Role::joint) {
      if ((r.beyond & several) == 0) {
        visit(BlockId{r.beyond}, square_metres(measures_[r.measure].area));
      } else {
        all_of(lists_[r.beyond & ~several].first, lists_[r.beyond & ~several].count);
      }
    }
  }

  /// The face where it is kept as it was put in; null where it is not.
  [[nodiscard]] const Face* kept_whole(FaceId id) const {
    CLEAVE_ASSERT(id.index() < records_.size());
    const Record& r = records_[id.index()];
    return (r.plane & whole) != 0 ? &whole_[r.measure] : nullptr;
  }
  /// Where the corners of a face that is not kept whole begin and end.
  [[nodiscard]] std::array<std::uint32_t, 2> corners(FaceId id) const {
    CLEAVE_ASSERT(id.index() < records_.size());
    return {records_[id.index()].first_corner,
            id.index() + 1 < records_.size() ? records_[id.index() + 1].first_corner : corner_count_};
  }
  /// Of a face that was got from here.
  [[nodiscard]] PatchRange patches(const Face& face) const {
    if (face.first_patch < several || face.patch_count != 1) {
      return PatchRange{std::span{patches_}.subspan(face.first_patch, face.patch_count)};
    }
    const bool alone = face.first_patch == nothing;
    const auto neighbour = alone ? std::nullopt : std::optional{BlockId{face.first_patch & ~several}};
    return PatchRange{Patch{face.joint, neighbour, face.area, face.centroid}};
  }

  /// Asks memory for what a face is kept in; a hint. `measures`: for what the first call's answer leads to.
  void prefetch(FaceId id, bool measures) const {
    if (measures) {
      const std::uint32_t at = records_[id.index()].measure;
      if (at < measures_.size()) __builtin_prefetch(&measures_[at]);
    } else {
      __builtin_prefetch(&records_[id.index()]);
    }
  }

 private:
  friend class detail::FacePacker;
  static constexpr std::uint32_t nothing = UINT32_MAX;
  static constexpr std::uint32_t several = 1U << 31U;  ///< in `beyond`, before a place in `lists_`
  static constexpr std::uint32_t whole = 8;            ///< in `plane`
  static constexpr std::uint32_t plane_shift = 4;

  struct Record {
    std::uint32_t block;
    std::uint32_t plane;         ///< its number, then the flags `whole`, role, and side
    std::uint32_t cause;         ///< joint; excavation
    std::uint32_t beyond;        ///< neighbour, or the list of patches; tag
    std::uint32_t measure;       ///< into `measures_`; into `whole_`
    std::uint32_t first_corner;  ///< they end where those of the next face begin
  };
  struct List {
    std::uint32_t first, count;
  };

  std::vector<Record> records_;
  std::vector<detail::FaceMeasure> measures_;
  std::vector<geometry::Vec3> normals_;  ///< of the planes
  std::vector<Face> whole_;
  std::vector<List> lists_;
  std::vector<Patch> patches_;
  std::uint32_t corner_count_ = 0;
};

/// Numbers of formula (B1) of Euler-Poincare for one block: V - E + F - (L - F) - 2 (S - G) = 0.
struct EulerCounts {
  std::uint32_t vertices, edges, faces, loops, shells, genus;
  friend bool operator==(const EulerCounts&, const EulerCounts&) = default;
};

struct Block {
  FaceRange faces;
  EulerCounts counts;
  Volume volume;
  geometry::Vec3 centroid;  ///< m, absolute
  bool convex;              ///< exact: no re-entrant edge, one shell
  bool fixed;               ///< has a face of Role::fixed
  bool free;                ///< has a face of Role::free
  /// Smallest width (m) over the normals of the eight faces that are largest (all, of blocks with fewer): between the
  /// outermost vertices along it.
  Length thickness;
  bool sliver;  ///< thickness below 1e-6 of the domain's extent
  /// Has a face of Role::window: only a part of the block is known, and it may go on as another part elsewhere.
  bool truncated = false;
};

/// A flat part of a joint that has the same block on both sides: a dangling end, a membrane, an isolated joint.
struct DanglingPiece {
  JointId joint;
  BlockId block;  ///< the block it lies in
  PlaneId plane;
  Area area;
  std::vector<std::vector<VertexId>> loops;  ///< [0] outer, counter-clockwise about the plane's normal; then holes
  bool isolated;                             ///< nothing of its joint meets another joint or a face
};

/// What CutInput::keep_dangling keeps. An edge ends freely where no other face is around it: a crack tip in the rock.
struct Dangling {
  std::vector<DanglingPiece> pieces;
  Area area;
  std::uint64_t free_edges = 0;
  Length free_edge_length;
  std::uint64_t joints = 0, isolated_joints = 0;  ///< with at least one piece; of those, isolated
};

/// A flat part of joints, with rock on both sides, that no other joint and no surface of the rock crosses.
struct JointPiece {
  std::vector<JointId> joints;  ///< that lie there, ascending; nearly always one
  PlaneId plane;
  std::array<BlockId, 2> blocks;  ///< on the positive and the negative side of the plane; one and the same where it
                                  ///< dangles
  Area area;
  std::uint32_t first_triangle, triangle_count;  ///< into JointNetwork::triangles
};

/// A straight line, between two neighbouring corners, along which joints end at the surface of the rock.
struct JointBorder {
  std::array<VertexId, 2> ends;
  Role role;                                ///< free, fixed or window
  std::optional<std::uint32_t> excavation;  ///< as of faces of blocks
  std::optional<std::uint32_t> tag;
};

/// One more surface of the rock at a border that lies in an edge between several.
struct BorderSide {
  std::uint32_t border;  ///< into JointNetwork::borders
  Role role;
  std::optional<std::uint32_t> excavation;
  std::optional<std::uint32_t> tag;
};

/// The joints as they lie in the rock, kept with CutInput::keep_network: cut along every line in which they meet each
/// other and the surface of the rock, and into triangles. It conforms: two triangles have a side in common, a corner,
/// or nothing; more than two meet in a side where joints cross. Triangles are never flat and turn counter-clockwise
/// about the normal of their plane. It is not saved with the blocks.
struct JointNetwork {
  std::vector<std::array<VertexId, 3>> triangles;
  std::vector<JointPiece> pieces;
  std::vector<JointBorder> borders;  ///< in an edge of the rock: of an excavation before a free side before a fixed one
  std::vector<BorderSide> others = {};
};

/// What one excavation takes of the domain (or window).
struct ExcavatedVolume {
  Volume removed = {};  ///< rock: what several take counts for the first of them
  Volume inside = {};   ///< of the domain, whoever else takes it
};

/// Facts about the run of the cutter.
struct CutReport {
  double lattice_pitch_m = 0;
  double largest_snap_m = 0;
  double bend_m = 0;  ///< the farthest that a corner lies off its face's plane, where polygons share edges; else 0
  std::uint64_t merged_planes = 0;         ///< by `snap`
  std::uint64_t adopted_edges = 0;         ///< by `snap`
  std::vector<SnappedJoint> snapped = {};  ///< all joints that `snap` changed, by number
  CoarseSnap coarse_snap = {};
  NearMisses near_misses = {};
  std::uint64_t joints_outside = 0;    ///< joints that do not meet the domain
  std::vector<JointId> outside = {};   ///< which
  std::vector<JointId> dangling = {};  ///< joints no piece of which separates two blocks
  /// Of joints that lie on one another between two blocks: the first one with each of the others, in order.
  std::vector<std::pair<JointId, JointId>> overlapping = {};
  std::uint64_t intersections = 0;  ///< pairs of facets (of joints and solids) that meet in a segment or a point
  std::uint64_t predicate_calls = 0;
  std::uint64_t predicate_exact = 0;            ///< of those, how many the filter could not decide
  std::vector<ExcavatedVolume> excavated = {};  ///< one an excavation of the input
};

/// The blocks a scene falls into. Immutable; made by `cut`. Not yet checked: `audit` turns it into an AuditedComplex.
/// Kept in as little room as holds it: faces and patches are made when they are asked for.
class BlockComplex final {
 public:
  /// The same with each thing by itself: to look at, to change, and for block systems written down by hand.
  struct Data {
    IdVector<VertexId, geometry::Vec3> vertices = {};  ///< m, relative to `origin`
    geometry::Vec3 origin = {};                        ///< m; add it to get absolute coordinates
    IdVector<FaceId, Face> faces = {};
    std::vector<VertexId> corners = {};           ///< of the loops of all faces
    std::vector<std::uint32_t> hole_starts = {};  ///< where each hole begins, counted from its face's first corner
    std::vector<Patch> patches = {};              ///< of all faces
    IdVector<BlockId, Block> blocks = {};
    IdVector<PlaneId, exact::Plane> planes =
        {};                   ///< exact coefficients in lattice units; normals point to the positive side
    Volume rock_volume = {};  ///< of the domain (or window) less what is excavated, from their own surfaces
    CutReport report = {};
    std::optional<Dangling> dangling = {};     ///< when asked for
    std::optional<JointNetwork> network = {};  ///< when asked for

    [[nodiscard]] LoopRange loops(const Face& face) const {
      const std::span<const VertexId> own = std::span{corners}.subspan(face.first_corner, face.corner_count);
      return {own, std::span{hole_starts}.subspan(face.first_hole, face.hole_count)};
    }
    [[nodiscard]] std::span<const Patch> patches_of(const Face& face) const {
      return std::span{patches}.subspan(face.first_patch, face.patch_count);
    }
    /// Gives the face other loops or patches, put behind all that there are: for block systems written down by hand.
    void set_loops(Face& face, const std::vector<std::vector<VertexId>>& loops);
    void set_patches(Face& face, std::span<const Patch> own);
  };
  /// What is kept: `rest` is without faces and patches.
  struct Packed {
    PackedFaces faces;
    Data rest;
  };
  explicit BlockComplex(Data data);
  explicit BlockComplex(Packed packed) : kept_{std::move(packed)} {}

  [[nodiscard]] const IdVector<VertexId, geometry::Vec3>& vertices() const noexcept { return kept_.rest.vertices; }
  [[nodiscard]] geometry::Vec3 origin() const noexcept { return kept_.rest.origin; }
  [[nodiscard]] geometry::Vec3 position(VertexId v) const { return kept_.rest.origin + kept_.rest.vertices[v]; }
  /// As `IdVector<FaceId, Face>`, but that each face is a value of its own.
  [[nodiscard]] const PackedFaces& faces() const noexcept { return kept_.faces; }
  /// Loops of a face: [0] outer, counter-clockwise seen from outside; then holes, clockwise. A loop may pass a vertex
  /// twice (pinch).
  [[nodiscard]] LoopRange loops(const Face& face) const { return kept_.rest.loops(face); }
  [[nodiscard]] LoopRange loops(FaceId face) const {
    if (const Face* whole = kept_.faces.kept_whole(face)) return loops(*whole);
    const auto [first, last] = kept_.faces.corners(face);
    return {std::span{kept_.rest.corners}.subspan(first, last - first), {}};
  }
  /// Patches of a face; their areas add up to its area.
  [[nodiscard]] PatchRange patches(const Face& face) const { return kept_.faces.patches(face); }
  [[nodiscard]] const IdVector<BlockId, Block>& blocks() const noexcept { return kept_.rest.blocks; }
  [[nodiscard]] const IdVector<PlaneId, exact::Plane>& planes() const noexcept { return kept_.rest.planes; }
  /// Volume of the domain less what is excavated.
  [[nodiscard]] Volume rock_volume() const noexcept { return kept_.rest.rock_volume; }
  [[nodiscard]] const CutReport& report() const noexcept { return kept_.rest.report; }
  /// What dangles, when it was asked for.
  [[nodiscard]] const std::optional<Dangling>& dangling() const noexcept { return kept_.rest.dangling; }
  /// The joints cut along each other, when they were asked for.
  [[nodiscard]] const std::optional<JointNetwork>& network() const noexcept { return kept_.rest.network; }
  /// A copy.
  [[nodiscard]] Data data() const;

 private:
  Packed kept_;
};

/// Blocks on the other side of a block's joints, each once, ascending. Those that it touches along an edge or at a
/// corner alone are none.
[[nodiscard]] std::vector<BlockId> neighbours_of(const BlockComplex& complex, BlockId block);

/// Finds the block that holds a point: O(n log n) to make, O(log n) and the faces of a few blocks to ask. Refers to the
/// complex, which must outlive it. Several threads may ask at once.
class BlockLocator final {
 public:
  explicit BlockLocator(const BlockComplex& complex);
  BlockLocator(BlockLocator&& other) noexcept;
  BlockLocator& operator=(BlockLocator&& other) noexcept;
  ~BlockLocator();

  /// `point`: m, absolute coordinates. Blocks hold their faces: a point on the face between two is in the one with the
  /// lower number. None: in an excavation, outside the domain (or window), or not finite. Exact by the planes of convex
  /// blocks; where a block is not convex, the outlines of its faces count with their corners as stored (rounded to
  /// double).
  [[nodiscard]] std::optional<BlockId> block_at(geometry::Vec3 point) const;

 private:
  struct Boxes;
  [[nodiscard]] bool holds(BlockId block, geometry::Vec3 point) const;

  const BlockComplex* complex_;
  std::unique_ptr<const Boxes> boxes_;
};

}  // namespace cleave::topology
