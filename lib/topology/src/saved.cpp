#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "cleave/core/archive.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/topology/audit.hpp"

namespace cleave::topology {
namespace {

using geometry::Vec3;
using Numbers = std::array<double, 3>;

constexpr std::string_view kind = "cleave-blocks";
constexpr std::uint32_t version = 2;

Numbers numbers(Vec3 v) { return {v.x, v.y, v.z}; }
Vec3 vector(const Numbers& n) { return {n[0], n[1], n[2]}; }
template <class Id>
std::optional<std::uint32_t> value_of(const std::optional<Id>& id) {
  return id ? std::optional{id->value()} : std::nullopt;
}
template <class Id>
std::optional<Id> id_of(const std::optional<std::uint32_t>& value) {
  return value ? std::optional{Id{*value}} : std::nullopt;
}
template <class Id>
std::vector<std::uint32_t> values_of(std::span<const Id> ids) {
  std::vector<std::uint32_t> out;
  out.reserve(ids.size());
  for (const Id id : ids) out.push_back(id.value());
  return out;
}
template <class Id>
std::vector<Id> ids_of(const std::vector<std::uint32_t>& values) {
  std::vector<Id> out;
  out.reserve(values.size());
  for (const std::uint32_t value : values) out.emplace_back(value);
  return out;
}

// What is kept of each thing, as plain numbers: ids have no value of their own to be read into.

struct KeptPlane {
  std::array<std::uint64_t, 6> normal{};  ///< low and high word of each component
  std::array<std::uint64_t, 3> offset{};
};
template <class A>
void archive(A& a, Archived<KeptPlane> auto& p) {
  a(p.normal, p.offset);
}

struct KeptFace {
  std::uint32_t block = 0, plane = 0, shell = 0;
  bool positive = false;
  Role role = Role::joint;
  std::optional<std::uint32_t> joint, excavation, tag;
  Numbers outward{}, centroid{};
  double area = 0;
  std::array<std::uint32_t, 6> ranges{};  ///< first and count of corners, holes and patches
};
template <class A>
void archive(A& a, Archived<KeptFace> auto& f) {
  a(f.block, f.plane, f.shell, f.positive);
  a.word(f.role, Role::window);
  a(f.joint, f.excavation, f.tag, f.outward, f.centroid, f.area, f.ranges);
}

struct KeptPatch {
  std::optional<std::uint32_t> joint, neighbour;
  double area = 0;
  Numbers centroid{};
};
template <class A>
void archive(A& a, Archived<KeptPatch> auto& p) {
  a(p.joint, p.neighbour, p.area, p.centroid);
}

struct KeptBlock {
  std::uint32_t first_face = 0, faces = 0;
  std::array<std::uint32_t, 6> counts{};
  double volume = 0, thickness = 0;
  Numbers centroid{};
  bool convex = false, fixed = false, free = false, sliver = false, truncated = false;
};
template <class A>
void archive(A& a, Archived<KeptBlock> auto& b) {
  a(b.first_face, b.faces, b.counts, b.volume, b.thickness, b.centroid, b.convex, b.fixed, b.free, b.sliver,
    b.truncated);
}

struct KeptPiece {
  std::uint32_t joint = 0, block = 0, plane = 0;
  double area = 0;
  std::vector<std::vector<std::uint32_t>> loops;
  bool isolated = false;
};
template <class A>
void archive(A& a, Archived<KeptPiece> auto& p) {
  a(p.joint, p.block, p.plane, p.area, p.loops, p.isolated);
}

struct KeptDangling {
  std::vector<KeptPiece> pieces;
  double area = 0, free_edge_length = 0;
  std::uint64_t free_edges = 0, joints = 0, isolated_joints = 0;
};
template <class A>
void archive(A& a, Archived<KeptDangling> auto& d) {
  a(d.pieces, d.area, d.free_edge_length, d.free_edges, d.joints, d.isolated_joints);
}

struct KeptSnap {
  std::uint32_t joint = 0, adopted_edges = 0;
  double moved = 0;
  bool merged = false;
};
template <class A>
void archive(A& a, Archived<KeptSnap> auto& s) {
  a(s.joint, s.adopted_edges, s.moved, s.merged);
}

struct KeptReport {
  double pitch = 0, largest_snap = 0, bend = 0, shortest = 0, largest_miss = 0;
  std::array<std::uint64_t, 8> counts{};
  std::uint32_t coarse_joint = 0, miss_joint = 0;
  std::optional<std::uint32_t> missed;
  std::vector<KeptSnap> snapped;
  std::vector<std::uint32_t> outside, dangling;
  std::vector<std::array<std::uint32_t, 2>> overlapping;
  std::vector<std::array<double, 2>> excavated;
};
template <class A>
void archive(A& a, Archived<KeptReport> auto& r) {
  a(r.pitch, r.largest_snap, r.bend, r.shortest, r.largest_miss, r.counts, r.coarse_joint, r.miss_joint, r.missed,
    r.snapped, r.outside, r.dangling, r.overlapping, r.excavated);
}

struct Kept {
  std::vector<Numbers> vertices;
  Numbers origin{};
  std::vector<KeptFace> faces;
  std::vector<std::uint32_t> corners, hole_starts;
  std::vector<KeptPatch> patches;
  std::vector<KeptBlock> blocks;
  std::vector<KeptPlane> planes;
  double rock_volume = 0;
  KeptReport report;
  std::optional<KeptDangling> dangling;
};
template <class A>
void archive(A& a, Archived<Kept> auto& k) {
  a(k.vertices, k.origin, k.faces, k.corners, k.hole_starts, k.patches, k.blocks, k.planes, k.rock_volume, k.report,
    k.dangling);
}

// ---- to be written --------------------------------------------------------------------------------------------------

KeptPlane kept(const exact::Plane& plane) {
  KeptPlane out{.normal = {}, .offset = plane.offset().words};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto bits = static_cast<exact::Int192::Word2>(plane.normal()[k]);
    out.normal[2 * k] = static_cast<std::uint64_t>(bits);
    out.normal[2 * k + 1] = static_cast<std::uint64_t>(bits >> 64U);
  }
  return out;
}

KeptFace kept(const Face& f) {
  return {.block = f.block.value(),
          .plane = f.plane.value(),
          .shell = f.shell,
          .positive = f.block_on_positive_side,
          .role = f.role,
          .joint = value_of(f.joint),
          .excavation = f.excavation,
          .tag = f.tag,
          .outward = numbers(f.outward),
          .centroid = numbers(f.centroid),
          .area = f.area.si(),
          .ranges = {f.first_corner, f.corner_count, f.first_hole, f.hole_count, f.first_patch, f.patch_count}};
}

KeptBlock kept(const Block& b) {
  const EulerCounts& c = b.counts;
  return {.first_face = b.faces.empty() ? 0 : b.faces.front().value(),
          .faces = static_cast<std::uint32_t>(b.faces.size()),
          .counts = {c.vertices, c.edges, c.faces, c.loops, c.shells, c.genus},
          .volume = b.volume.si(),
          .thickness = b.thickness.si(),
          .centroid = numbers(b.centroid),
          .convex = b.convex,
          .fixed = b.fixed,
          .free = b.free,
          .sliver = b.sliver,
          .truncated = b.truncated};
}

KeptDangling kept(const Dangling& d) {
  KeptDangling out{.pieces = {},
                   .area = d.area.si(),
                   .free_edge_length = d.free_edge_length.si(),
                   .free_edges = d.free_edges,
                   .joints = d.joints,
                   .isolated_joints = d.isolated_joints};
  for (const DanglingPiece& piece : d.pieces) {
    KeptPiece& p = out.pieces.emplace_back(
        KeptPiece{piece.joint.value(), piece.block.value(), piece.plane.value(), piece.area.si(), {}, piece.isolated});
    for (const auto& loop : piece.loops) p.loops.push_back(values_of(std::span{loop}));
  }
  return out;
}

KeptReport kept(const CutReport& r) {
  KeptReport out{.pitch = r.lattice_pitch_m,
                 .largest_snap = r.largest_snap_m,
                 .bend = r.bend_m,
                 .shortest = r.coarse_snap.shortest.si(),
                 .largest_miss = r.near_misses.largest.si(),
                 .counts = {r.merged_planes, r.adopted_edges, r.coarse_snap.polygons, r.near_misses.sides,
                            r.joints_outside, r.intersections, r.predicate_calls, r.predicate_exact},
                 .coarse_joint = r.coarse_snap.joint.value(),
                 .miss_joint = r.near_misses.joint.value(),
                 .missed = value_of(r.near_misses.other),
                 .snapped = {},
                 .outside = values_of(std::span{r.outside}),
                 .dangling = values_of(std::span{r.dangling}),
                 .overlapping = {},
                 .excavated = {}};
  for (const auto& [one, other] : r.overlapping) out.overlapping.push_back({one.value(), other.value()});
  for (const SnappedJoint& s : r.snapped) {
    out.snapped.push_back({s.joint.value(), s.adopted_edges, s.moved.si(), s.plane_merged});
  }
  for (const ExcavatedVolume& v : r.excavated) out.excavated.push_back({v.removed.si(), v.inside.si()});
  return out;
}

// ---- read back ------------------------------------------------------------------------------------------------------

/// Refuses numbers that name what is not there: what looks at a complex takes them to be good.
class Check final {
 public:
  explicit Check(const Kept& k) : k_{k} {}
  [[nodiscard]] bool good() const {
    const auto good = [&](const auto& list) { return std::ranges::all_of(list, [&](const auto& x) { return is(x); }); };
    return finite(k_.origin) && std::isfinite(k_.rock_volume) && good(k_.vertices) && good(k_.faces) &&
           good(k_.patches) && good(k_.blocks) && vertices(k_.corners) && is(k_.report) &&
           (!k_.dangling || (good(k_.dangling->pieces) && std::isfinite(k_.dangling->area) &&
                             std::isfinite(k_.dangling->free_edge_length)));
  }

 private:
  [[nodiscard]] static bool finite(const Numbers& n) {
    return std::ranges::all_of(n, [](double x) { return std::isfinite(x); });
  }
  [[nodiscard]] static bool within(std::uint32_t first, std::uint32_t count, std::size_t size) {
    return std::uint64_t{first} + count <= size;
  }
  [[nodiscard]] bool vertices(const std::vector<std::uint32_t>& list) const {
    return std::ranges::all_of(list, [&](std::uint32_t v) { return v < k_.vertices.size(); });
  }
  [[nodiscard]] bool is(const Numbers& n) const { return finite(n); }
  [[nodiscard]] bool is(const KeptPatch& p) const {
    return (!p.neighbour || *p.neighbour < k_.blocks.size()) && std::isfinite(p.area) && finite(p.centroid);
  }
  [[nodiscard]] bool is(const KeptFace& f) const {
    const auto& [corner, corners, hole, holes, patch, patches] = f.ranges;
    if (f.block >= k_.blocks.size() || f.plane >= k_.planes.size() || f.shell >= k_.blocks[f.block].faces ||
        !finite(f.outward) || !finite(f.centroid) || !std::isfinite(f.area) ||
        !within(corner, corners, k_.corners.size()) || !within(hole, holes, k_.hole_starts.size()) ||
        !within(patch, patches, k_.patches.size())) {
      return false;
    }
    // Every loop has corners.
    std::uint32_t before = 0;
    for (std::uint32_t h = hole; h < hole + holes; ++h) {
      if (k_.hole_starts[h] <= before || k_.hole_starts[h] >= corners) return false;
      before = k_.hole_starts[h];
    }
    return true;
  }
  [[nodiscard]] bool is(const KeptBlock& b) const {
    return within(b.first_face, b.faces, k_.faces.size()) && std::isfinite(b.volume) && std::isfinite(b.thickness) &&
           finite(b.centroid);
  }
  [[nodiscard]] bool is(const KeptPiece& p) const {
    return p.block < k_.blocks.size() && p.plane < k_.planes.size() && std::isfinite(p.area) && !p.loops.empty() &&
           std::ranges::all_of(p.loops, [&](const auto& loop) { return !loop.empty() && vertices(loop); });
  }
  [[nodiscard]] static bool is(const KeptReport& r) {
    int exponent = 0;
    return std::isfinite(r.pitch) && r.pitch > 0 && std::frexp(r.pitch, &exponent) == 0.5 &&
           finite({r.largest_snap, r.bend, r.shortest}) && std::isfinite(r.largest_miss);
  }

  const Kept& k_;
};

std::optional<IdVector<PlaneId, exact::Plane>> planes_of(const std::vector<KeptPlane>& kept) {
  std::vector<exact::Plane> out;
  out.reserve(kept.size());
  for (const KeptPlane& plane : kept) {
    std::array<exact::Int128, 3> normal{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto high = static_cast<exact::Int192::Word2>(plane.normal[2 * k + 1]) << 64U;
      normal[k] = static_cast<exact::Int128>(high | plane.normal[2 * k]);
    }
    const auto made = exact::Plane::of_coefficients(normal, exact::Int192{plane.offset});
    if (!made) return std::nullopt;
    out.push_back(*made);
  }
  return IdVector<PlaneId, exact::Plane>{std::move(out)};
}

Face face_of(const KeptFace& f) {
  return {.block = BlockId{f.block},
          .plane = PlaneId{f.plane},
          .block_on_positive_side = f.positive,
          .role = f.role,
          .shell = f.shell,
          .joint = id_of<JointId>(f.joint),
          .excavation = f.excavation,
          .tag = f.tag,
          .outward = vector(f.outward),
          .area = Area::from_si(f.area),
          .centroid = vector(f.centroid),
          .first_corner = f.ranges[0],
          .corner_count = f.ranges[1],
          .first_hole = f.ranges[2],
          .hole_count = f.ranges[3],
          .first_patch = f.ranges[4],
          .patch_count = f.ranges[5]};
}

Block block_of(const KeptBlock& b) {
  const auto& c = b.counts;
  return {.faces = {FaceId{b.first_face}, b.faces},
          .counts = {c[0], c[1], c[2], c[3], c[4], c[5]},
          .volume = Volume::from_si(b.volume),
          .centroid = vector(b.centroid),
          .convex = b.convex,
          .fixed = b.fixed,
          .free = b.free,
          .thickness = Length::from_si(b.thickness),
          .sliver = b.sliver,
          .truncated = b.truncated};
}

CutReport report_of(const KeptReport& r) {
  CutReport out{.lattice_pitch_m = r.pitch, .largest_snap_m = r.largest_snap, .bend_m = r.bend};
  out.coarse_snap = {r.counts[2], Length::from_si(r.shortest), JointId{r.coarse_joint}};
  out.near_misses = {r.counts[3], Length::from_si(r.largest_miss), JointId{r.miss_joint}, id_of<JointId>(r.missed)};
  out.merged_planes = r.counts[0];
  out.adopted_edges = r.counts[1];
  out.joints_outside = r.counts[4];
  out.intersections = r.counts[5];
  out.predicate_calls = r.counts[6];
  out.predicate_exact = r.counts[7];
  for (const KeptSnap& s : r.snapped) {
    out.snapped.push_back({JointId{s.joint}, Length::from_si(s.moved), s.merged, s.adopted_edges});
  }
  out.outside = ids_of<JointId>(r.outside);
  out.dangling = ids_of<JointId>(r.dangling);
  for (const auto& [one, other] : r.overlapping) out.overlapping.emplace_back(one, other);
  for (const auto& v : r.excavated) out.excavated.push_back({Volume::from_si(v[0]), Volume::from_si(v[1])});
  return out;
}

Dangling dangling_of(const KeptDangling& d) {
  Dangling out{.pieces = {},
               .area = Area::from_si(d.area),
               .free_edges = d.free_edges,
               .free_edge_length = Length::from_si(d.free_edge_length),
               .joints = d.joints,
               .isolated_joints = d.isolated_joints};
  for (const KeptPiece& p : d.pieces) {
    DanglingPiece& piece = out.pieces.emplace_back(
        DanglingPiece{JointId{p.joint}, BlockId{p.block}, PlaneId{p.plane}, Area::from_si(p.area), {}, p.isolated});
    for (const auto& loop : p.loops) piece.loops.push_back(ids_of<VertexId>(loop));
  }
  return out;
}

}  // namespace

std::string saved(const AuditedComplex& audited) {
  const BlockComplex::Data data = audited.complex().data();
  Kept out{.vertices = {},
           .origin = numbers(data.origin),
           .faces = {},
           .corners = values_of(std::span{data.corners}),
           .hole_starts = data.hole_starts,
           .patches = {},
           .blocks = {},
           .planes = {},
           .rock_volume = data.rock_volume.si(),
           .report = kept(data.report),
           .dangling = {}};
  for (const Vec3 v : data.vertices) out.vertices.push_back(numbers(v));
  for (const Face& face : data.faces) out.faces.push_back(kept(face));
  for (const Patch& p : data.patches) {
    out.patches.push_back({value_of(p.joint), value_of(p.neighbour), p.area.si(), numbers(p.centroid)});
  }
  for (const Block& block : data.blocks) out.blocks.push_back(kept(block));
  for (const exact::Plane& plane : data.planes) out.planes.push_back(kept(plane));
  if (data.dangling) out.dangling = kept(*data.dangling);
  ArchiveWriter a;
  a(out);
  return sealed(kind, version, a.bytes());
}

std::expected<AuditedComplex, LoadError> load_saved(std::string_view bytes, unsigned threads) {
  CLEAVE_TRY(const std::string_view held, unsealed(kind, version, bytes));
  Kept read;
  ArchiveReader a{held};
  a(read);
  if (!a.complete() || !Check{read}.good()) return std::unexpected(SavedFault::inconsistent);
  auto planes = planes_of(read.planes);
  if (!planes) return std::unexpected(SavedFault::inconsistent);
  BlockComplex::Data data{.vertices = {},
                          .origin = vector(read.origin),
                          .faces = {},
                          .corners = ids_of<VertexId>(read.corners),
                          .hole_starts = std::move(read.hole_starts),
                          .patches = {},
                          .blocks = {},
                          .planes = *std::move(planes),
                          .rock_volume = Volume::from_si(read.rock_volume),
                          .report = report_of(read.report)};
  for (const Numbers& v : read.vertices) data.vertices.push_back(vector(v));
  for (const KeptFace& face : read.faces) data.faces.push_back(face_of(face));
  for (const KeptPatch& p : read.patches) {
    data.patches.push_back(
        {id_of<JointId>(p.joint), id_of<BlockId>(p.neighbour), Area::from_si(p.area), vector(p.centroid)});
  }
  for (const KeptBlock& block : read.blocks) data.blocks.push_back(block_of(block));
  if (read.dangling) data.dangling = dangling_of(*read.dangling);
  auto audited = audit(BlockComplex{std::move(data)}, threads);
  if (!audited) return std::unexpected(std::move(audited).error());
  return *std::move(audited);
}

std::string describe(const LoadError& error) {
  return std::visit(overloaded{[](SavedFault fault) -> std::string {
                                 switch (fault) {
                                   case SavedFault::foreign: return "this is no block system that cleave saved";
                                   case SavedFault::other_version:
                                     return "another version of cleave saved this block system: cut the scene again";
                                   case SavedFault::damaged: return "the block system was changed or cut short";
                                   case SavedFault::inconsistent:
                                   case SavedFault::other_world:
                                     return "the block system names parts that it does not have";
                                 }
                                 std::unreachable();
                               },
                               [](const Certificate& certificate) {
                                 return "the block system does not pass the audit: " + describe(certificate);
                               }},
                    error);
}

}  // namespace cleave::topology
