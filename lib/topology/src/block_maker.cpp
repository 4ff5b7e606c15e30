#include "detail/block_maker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "cleave/core/assert.hpp"

namespace cleave::topology::detail {

using geometry::Vec3;

bool BlockMaker::internal(Index flank) const {
  const Index to = link(flank);
  const bool flat = to == (flank ^ 2U);  // the other half-edge of the same use, same side
  if (!flat && parts_.sheets.empty()) return false;
  const Index a = parts_.half_face_of(flank), b = parts_.half_face_of(to);
  if (a == b) return flat;
  if (!parts_.sheets.empty()) {
    const Index sheet = parts_.sheets[a / 2];
    if (sheet != parts_.sheets[b / 2] || (!flat && sheet == none)) return false;
    if (!flat && parts_.looks_up(a) != parts_.looks_up(b)) return false;  // the sheet turns back here
  }
  const bool a_joint = parts_.block_of[a ^ 1U] != none, b_joint = parts_.block_of[b ^ 1U] != none;
  if (a_joint || b_joint) return a_joint == b_joint;
  return parts_.nature(a).role == parts_.nature(b).role;
}

Block BlockMaker::make(Index block) {
  const std::span half_faces = std::span{parts_.half_faces}.subspan(
      parts_.begin[block], parts_.begin[block + std::size_t{1}] - parts_.begin[block]);
  CLEAVE_ASSERT(!half_faces.empty());
  if (!walk_faces_alone(half_faces)) {
    group_faces(half_faces);
    walk_faces();
  }
  const auto faces = static_cast<Index>(face_begin_.size() - 1);
  pair_sides();
  find_shells();
  count_vertices();

  faces_.clear();
  patches_.clear();
  const FaceId first{out_.faces.size()};
  Block made{{first, faces}, {}, {}, {}, true, false, false, {}, false, false};
  for (Index face = 0; face < faces; ++face) {
    add_face(face, block);
    const Face& added = faces_.back();
    made.fixed = made.fixed || added.role == Role::fixed;
    made.truncated = made.truncated || added.role == Role::window;
    made.free = made.free || added.role == Role::free;
  }
  measure(made);
  // A hole of a face needs no look: what fills it is flush with the face (another role), or goes down from it and turns
  // in again at a re-entrant edge.
  made.convex = shell_count_ == 1 && !has_reflex_edge();
  const std::int64_t v = vertex_count_, e = edge_sides_ / 2, f = faces, l = static_cast<std::int64_t>(loops_.size()),
                     s = shell_count_;
  const std::int64_t twice_genus = 2 * s - (v - e + f - (l - f));
  const bool sound = twice_genus >= 0 && twice_genus % 2 == 0;
  made.counts = {vertex_count_, edge_sides_ / 2,
                 faces,         static_cast<std::uint32_t>(loops_.size()),
                 shell_count_,  sound ? static_cast<std::uint32_t>(twice_genus / 2) : UINT32_MAX};
  made.thickness = metres(thickness() * parts_.scale);
  made.sliver = made.thickness.si() < parts_.sliver_below;
  pack_faces();
  return made;
}

/// A face that is one plane face has its measures in common with the face on the other side.
void BlockMaker::pack_faces() {
  for (Index face = 0; face < faces_.size(); ++face) {
    const Index first = face_begin_[face];
    const Face& made = faces_[face];
    const std::span own = std::span{patches_}.subspan(made.first_patch, made.patch_count);
    if (face_begin_[face + std::size_t{1}] - first == 1) {
      packer_.add_plane_face(made, own, members_[first] / 2);
    } else {
      packer_.add(made, own);
    }
  }
}

/// Nearly always each half-face is a face: then its loops are those of the plane face. False where some half-face goes
/// straight on into another one, or into itself.
bool BlockMaker::walk_faces_alone(std::span<const Index> half_faces) {
  if (!parts_.sheets.empty()) return false;
  const std::vector<Index>&next = parts_.arrangement.next, &starts = parts_.arrangement.start;
  begin_walk();
  members_.assign(half_faces.begin(), half_faces.end());
  face_begin_.resize(half_faces.size() + 1);
  std::iota(face_begin_.begin(), face_begin_.end(), Index{0});
  any_internal_ = false;
  for (Index face = 0; face < half_faces.size(); ++face) {
    loops_begin_.push_back(static_cast<Index>(loops_.size()));
    const Index side = half_faces[face] % 2;
    const PlaneFace& part = parts_.arrangement.faces[half_faces[face] / 2];
    for (Index l = part.first_loop; l < part.first_loop + part.loop_count; ++l) {
      const Index start = parts_.arrangement.loops[l];
      const auto first = static_cast<Index>(sides_.size());
      Index h = start;
      do {
        const Index flank = 2 * h + side, to = links_[flank];
        if (to == (flank ^ 2U) && internal(flank)) return false;
        const Index after = next[h];
        sides_.push_back({flank, starts[side == 1 ? after : h], 0, to, face, false});
        h = after;
      } while (h != start);
      close_loop(first, side == 0);
    }
  }
  loops_begin_.push_back(static_cast<Index>(loops_.size()));
  half_edges_ = sides_.size();
  return true;
}

void BlockMaker::begin_walk() {
  sides_.clear();
  loops_.clear();
  loops_begin_.clear();
}

/// Of the sides from `first` on, each followed by the next one; `backwards`: by the one before.
void BlockMaker::close_loop(Index first, bool backwards) {
  const auto last = static_cast<Index>(sides_.size());
  if (backwards) std::reverse(sides_.begin() + first, sides_.end());
  for (Index k = first; k < last; ++k) sides_[k].next = k + 1;
  sides_.back().next = first;
  loops_.push_back({first, last - first});
}

void BlockMaker::walk_faces() {
  begin_walk();
  for (Index face = 0; face + 1 < face_begin_.size(); ++face) {
    loops_begin_.push_back(static_cast<Index>(loops_.size()));
    for (Index k = face_begin_[face]; k < face_begin_[face + 1]; ++k) walk_loops(members_[k], face);
  }
  loops_begin_.push_back(static_cast<Index>(loops_.size()));
}

/// Half-faces that go straight on into one another are one face; faces in the order of their first half-faces.
void BlockMaker::group_faces(std::span<const Index> half_faces) {
  const auto count = static_cast<Index>(half_faces.size());
  group_.resize(count);
  std::iota(group_.begin(), group_.end(), Index{0});
  const auto find = [&](Index k) {
    while (group_[k] != k) k = group_[k] = group_[group_[k]];
    return k;
  };
  bool merged = false;
  any_internal_ = false;
  half_edges_ = 0;
  for (Index k = 0; k < count; ++k) {
    const Index side = half_faces[k] % 2;
    const PlaneFace& face = parts_.arrangement.faces[half_faces[k] / 2];
    for (Index l = face.first_loop; l < face.first_loop + face.loop_count; ++l) {
      const Index start = parts_.arrangement.loops[l];
      Index h = start;
      do {
        const Index flank = 2 * h + side;
        ++half_edges_;
        if ((links_[flank] == (flank ^ 2U) || !parts_.sheets.empty()) && internal(flank)) {
          any_internal_ = true;
          const Index other = parts_.half_face_of(links_[flank]);
          if (other < half_faces[k]) {
            const auto at = std::ranges::lower_bound(half_faces, other);
            const Index a = find(static_cast<Index>(at - half_faces.begin())), b = find(k);
            group_[std::max(a, b)] = std::min(a, b);
            merged = true;
          }
        }
        h = parts_.arrangement.next[h];
      } while (h != start);
    }
  }
  members_.assign(half_faces.begin(), half_faces.end());
  face_begin_.clear();
  if (!merged) {
    for (Index k = 0; k <= count; ++k) face_begin_.push_back(k);
    return;
  }
  // Number of each half-face's face, then half-faces by face.
  Index faces = 0;
  std::vector<Index> number(count);
  for (Index k = 0; k < count; ++k) {
    const Index root = find(k);
    number[k] = root == k ? faces++ : number[root];
  }
  face_begin_.assign(faces + std::size_t{1}, 0);
  for (const Index n : number) ++face_begin_[n + std::size_t{1}];
  for (std::size_t f = 1; f < face_begin_.size(); ++f) face_begin_[f] += face_begin_[f - 1];
  auto next = face_begin_;
  for (Index k = 0; k < count; ++k) members_[next[number[k]]++] = half_faces[k];
}

void BlockMaker::walk_loops(Index half_face, Index face) {
  const PlaneFace& part = parts_.arrangement.faces[half_face / 2];
  for (Index l = part.first_loop; l < part.first_loop + part.loop_count; ++l) {
    const Index start = parts_.arrangement.loops[l];
    if (!any_internal_) {  // nearly always: its loops are those of the plane face
      walk_loop(2 * start + half_face % 2, face);
      continue;
    }
    Index h = start;
    do {
      const Index flank = 2 * h + half_face % 2;
      if ((links_[flank] & walked) == 0 && !internal(flank)) walk_loop(flank, face);
      h = parts_.arrangement.next[h];
    } while (h != start);
  }
}

void BlockMaker::walk_loop(Index start, Index face) {
  if (!parts_.sheets.empty()) return walk_folded_loop(start, face);
  const auto first = static_cast<Index>(sides_.size());
  const Index side = start % 2;
  // A block on the negative side sees the plane's normal as its outward normal and goes with the half-edges; one on the
  // positive side goes the other way round.
  Index flank = start;
  do {
    Index h = flank / 2;
    sides_.push_back({flank, parts_.arrangement.start[side == 1 ? h ^ 1U : h], 0, links_[flank], face, false});
    links_[flank] |= walked;
    h = parts_.arrangement.next[h];
    while (any_internal_ && internal(2 * h + side)) h = parts_.arrangement.next[h ^ 1U];
    flank = 2 * h + side;
  } while (flank != start);
  close_loop(first, side == 0);
}

/// Counter-clockwise seen from outside the block, from piece to piece of a folded polygon, whose planes may have their
/// normals on different sides.
void BlockMaker::walk_folded_loop(Index start, Index face) {
  const auto first = static_cast<Index>(sides_.size());
  const auto after = [&](Index flank) {
    const Index h = flank / 2;
    return 2 * (flank % 2 == 1 ? parts_.arrangement.next[h] : parts_.before[h]) + flank % 2;
  };
  Index flank = start;
  do {
    const Index h = flank / 2;
    const Index head = parts_.arrangement.start[flank % 2 == 1 ? h ^ 1U : h];
    sides_.push_back({flank, head, 0, links_[flank], face, false});
    links_[flank] |= walked;
    flank = after(flank);
    while (any_internal_ && internal(flank)) flank = after(link(flank));
  } while (flank != start);
  close_loop(first, false);
}

void BlockMaker::pair_sides() {
  for (Index k = 0; k < sides_.size(); ++k) links_[sides_[k].flank] = k;
  for (Side& side : sides_) side.partner = links_[side.partner];
}

void BlockMaker::find_shells() {
  const auto faces = static_cast<Index>(face_begin_.size() - 1);
  shell_.resize(faces);
  std::iota(shell_.begin(), shell_.end(), Index{0});
  const auto find = [&](Index f) {
    while (shell_[f] != f) f = shell_[f] = shell_[shell_[f]];
    return f;
  };
  Index joined = 0;
  for (const Side& side : sides_) {
    const Index a = find(side.face), b = find(sides_[side.partner].face);
    if (a == b) continue;
    shell_[std::max(a, b)] = std::min(a, b);
    if (++joined + 1 == faces) break;
  }
  shell_count_ = faces - joined;
  if (shell_count_ == 1) {
    std::ranges::fill(shell_, Index{0});
    return;
  }
  for (Index f = 0; f < faces; ++f) shell_[f] = find(f);
  Index number = 0;  // roots are the first faces of their shells
  for (Index f = 0; f < faces; ++f) shell_[f] = shell_[f] == f ? number++ : shell_[shell_[f]];
}

/// A vertex with two straight edges of one line is no vertex of the block. A vertex where the boundary pinches counts
/// once a fan.
void BlockMaker::count_vertices() {
  vertex_count_ = 0;
  edge_sides_ = static_cast<Index>(sides_.size());
  corners_.clear();
  seen_.assign(sides_.size(), 0);
  if (!parts_.sheets.empty()) count_left();
  const auto line_of = [&](Index side) { return parts_.line_of_slot[parts_.slot_of[sides_[side].flank / 4]]; };
  for (Index side = 0; side < sides_.size(); ++side) {
    if (seen_[side] != 0) continue;
    Index size = 0, at = side;
    do {
      seen_[at] = 1;
      ++size;
      at = sides_[sides_[at].next].partner;
    } while (at != side);
    if (size == 2) {
      const Index out = sides_[side].next, other = sides_[out].partner;
      if ((line_of(side) == line_of(out) && line_of(other) == line_of(sides_[other].next)) ||
          (!parts_.sheets.empty() && spared(side, other) && straight_on_a_sheet(side))) {
        sides_[side].dropped = sides_[other].dropped = true;
        if (!parts_.sheets.empty()) {
          --left_[loop_of_[side]];
          --left_[loop_of_[other]];
        }
        edge_sides_ -= 2;  // two edges become one
        continue;
      }
    }
    ++vertex_count_;
    corners_.push_back(sides_[side].head);
  }
}

/// How many corners each loop has left.
void BlockMaker::count_left() {
  left_.clear();
  loop_of_.resize(sides_.size());
  for (const Loop& loop : loops_) {
    for (Index k = loop.first; k < loop.first + loop.count; ++k) loop_of_[k] = static_cast<Index>(left_.size());
    left_.push_back(loop.count);
  }
}

/// A sliver as thin as the bend keeps three corners.
bool BlockMaker::spared(Index side, Index other) const {
  return left_[loop_of_[side]] > 3 && left_[loop_of_[other]] > 3;
}

/// A side that crosses a folded polygon is bent where it passes from one piece to the next, by no more than the pieces
/// are: that is no corner.
bool BlockMaker::straight_on_a_sheet(Index side) const {
  const auto sheet = [&](Index s) { return parts_.sheets[parts_.arrangement.face[sides_[s].flank / 2]]; };
  const Index out = sides_[side].next;
  if (sheet(side) == none && sheet(sides_[side].partner) == none) return false;
  const Vec3 at = parts_.position(sides_[side].head), to = parts_.position(sides_[out].head);
  // Where the side starts: the head of its partner, which goes the other way.
  const Vec3 from = parts_.position(sides_[sides_[side].partner].head);
  const Vec3 chord = to - from;
  const double length = geometry::norm(chord);
  return length > 0 && geometry::dot(at - from, chord) > 0 && geometry::dot(to - at, chord) > 0 &&
         geometry::norm(geometry::cross(at - from, chord)) <= parts_.straight * length;
}

void BlockMaker::add_face(Index face, Index block) {
  const std::span members = std::span{members_}.subspan(face_begin_[face], face_begin_[face + 1] - face_begin_[face]);
  const Index first = members.front();
  const Index plane = parts_.plane_of(first / 2);
  const Vec3 normal = parts_.normals[plane];
  const bool positive = parts_.looks_up(first);
  const Nature nature = parts_.nature(first);
  Face made{.block = BlockId{block},
            .plane = PlaneId{plane},
            .block_on_positive_side = positive,
            .role = nature.role,
            .shell = shell_[face],
            .joint = nature.joint == none ? std::nullopt : std::optional{JointId{nature.joint}},
            .excavation = nature.excavation == none ? std::nullopt : std::optional{nature.excavation},
            .tag = nature.tag == none ? std::nullopt : std::optional{nature.tag},
            .outward = positive ? -normal : normal,
            .area = {},
            .centroid = {}};
  made.first_patch = static_cast<Index>(patches_.size());
  if (members.size() == 1) {
    measure_alone(made, first, nature);
  } else {
    measure_together(made, members, nature);
  }
  made.patch_count = static_cast<Index>(patches_.size()) - made.first_patch;
  add_loops(face, made);
  faces_.push_back(made);
}

std::optional<BlockId> BlockMaker::neighbour(Index half_face, Role role) const {
  const Index beyond = parts_.block_of[half_face ^ 1U];
  return role == Role::joint && beyond != none ? std::optional{BlockId{beyond}} : std::nullopt;
}

/// Of a face that is one plane face, with its patch.
void BlockMaker::measure_alone(Face& made, Index half_face, const Nature& nature) {
  const FaceMeasure& m = parts_.measures[half_face / 2];
  const FaceMeasure metres = parts_.in_metres(half_face / 2);
  made.area = square_metres(metres.area);
  made.centroid = metres.centroid;
  // A sliver may seem to turn the other way in doubles.
  const Vec3 own =
      m.area > 0 ? made.centroid : parts_.centre(parts_.apex(half_face / 2), Vec3{} + moment3(m) / 3, std::abs(m.area));
  patches_.push_back({made.joint, neighbour(half_face, nature.role), made.area, own});
}

/// Areas and moments about the start of the first half-face; in units first.
void BlockMaker::measure_together(Face& made, std::span<const Index> members, const Nature& nature) {
  const Index first = members.front();
  const Vec3 apex = parts_.apex(first / 2);
  double area = 0;
  Vec3 moment{};
  for (const Index h : members) {
    const FaceMeasure& m = parts_.measures[h / 2];
    const Vec3 own = h == first ? moment3(m) / 3 : moment3(m) / 3 + m.area * (parts_.apex(h / 2) - apex);
    area += m.area;
    moment += own;
    const auto beside = neighbour(h, nature.role);
    const Index joint_number = h == first ? nature.joint : parts_.nature(h).joint;
    const auto joint = joint_number == none ? std::nullopt : std::optional{JointId{joint_number}};
    auto patch = std::ranges::find_if(patches_.begin() + made.first_patch, patches_.end(),
                                      [&](const Patch& p) { return p.neighbour == beside && p.joint == joint; });
    if (patch == patches_.end()) {
      patches_.push_back({joint, beside, {}, {}});
      patch = patches_.end() - 1;
    }
    patch->area += square_metres(std::abs(m.area));  // slivers may seem to turn the other way in doubles
    patch->centroid += own;
  }
  const double square = parts_.scale * parts_.scale;
  for (Patch& patch : std::span{patches_}.subspan(made.first_patch)) {
    patch.centroid = parts_.centre(apex, patch.centroid, patch.area.si());
    patch.area = square * patch.area;
  }
  made.area = square_metres(square * std::abs(area));
  made.centroid = parts_.centre(apex, moment, area);
}

/// The outer loop first: it turns once round to the left.
void BlockMaker::add_loops(Index face, Face& made) {
  const std::span loops = std::span{loops_}.subspan(loops_begin_[face], loops_begin_[face + 1] - loops_begin_[face]);
  made.first_corner = static_cast<Index>(out_.corners.size());
  made.first_hole = static_cast<Index>(out_.hole_starts.size());
  if (loops.size() > 1) {
    const auto outer =
        parts_.sheets.empty()
            ? std::ranges::find_if(loops, [&](const Loop& loop) { return turns_left(loop, made.plane.value()); })
            : std::ranges::max_element(loops, {}, [&](const Loop& loop) { return area_of(loop, made.outward); });
    if (outer != loops.end()) std::swap(*loops.begin(), *outer);
  }
  for (const Loop& loop : loops) {
    const auto before = static_cast<Index>(out_.corners.size()) - made.first_corner;
    if (before > 0) out_.hole_starts.push_back(before);
    for (Index k = loop.first; k < loop.first + loop.count; ++k) {
      if (!sides_[k].dropped) out_.corners.emplace_back(sides_[k].head);
    }
  }
  made.corner_count = static_cast<Index>(out_.corners.size()) - made.first_corner;
  made.hole_count = static_cast<Index>(out_.hole_starts.size()) - made.first_hole;
}

/// Seen from outside the block.
bool BlockMaker::turns_left(const Loop& loop, Index plane) const {
  const Index half = parts_.arrangement.half_turn[plane];
  const auto direction = [&](Index flank) {
    return parts_.arrangement.direction_of(flank / 2, parts_.slot_of[flank / 4], half);
  };
  std::int64_t turning = 0;
  for (Index k = loop.first; k < loop.first + loop.count; ++k) {
    const Index flank = sides_[k].flank;
    // Directions grow counter-clockwise seen from the positive side; a block there is looked at from the other side and
    // its faces are walked backwards, which changes the sense of each turn.
    const std::int64_t left = turn_between(direction(flank), direction(sides_[sides_[k].next].flank), half);
    turning += flank % 2 == 1 ? left : -left;
  }
  return turning > 0;
}

/// Twice the area inside a loop; less than nothing for a hole. Around a hole goes a larger loop.
double BlockMaker::area_of(const Loop& loop, Vec3 outward) const {
  const Vec3 apex = parts_.position(sides_[loop.first].head);
  Vec3 sum{};
  for (Index k = loop.first; k < loop.first + loop.count; ++k) {
    sum += geometry::cross(parts_.position(sides_[k].head) - apex, parts_.position(sides_[sides_[k].next].head) - apex);
  }
  return geometry::dot(sum, outward);
}

bool BlockMaker::has_reflex_edge() const {
  return std::ranges::any_of(sides_, [&](const Side& side) {
    const Index h = side.flank / 2;
    return side.flank % 2 == h % 2 && parts_.links.reflex[h] != 0;
  });
}

}  // namespace cleave::topology::detail
