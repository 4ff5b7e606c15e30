#include "detail/assemble.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cleave/core/assert.hpp"
#include "detail/dangling.hpp"
#include "detail/union_find.hpp"

namespace cleave::topology::detail {
namespace {

using geometry::Vec3;

/// What a half-face is to its block.
struct Nature {
  Role role = Role::joint;
  Index joint = none, excavation = none, tag = none;
};

struct Measure {
  Vec3 vector_area{};  ///< outward
  Vec3 moment{};       ///< sum of triangle area times 3 centroid, along the outward normal
};

class Assembler {
 public:
  Assembler(const CutInput& input, const Prepared& prepared, const Graph& graph, const Arrangement& arrangement,
            const Cells& cells, const std::vector<Vec>& positions, const std::vector<std::uint8_t>* excavated)
      : input_{input},
        prepared_{prepared},
        graph_{graph},
        arrangement_{arrangement},
        cells_{cells},
        excavated_{excavated},
        faces_{static_cast<Index>(arrangement.faces.size())},
        merged_{2 * std::size_t{faces_}},
        shells_{2 * std::size_t{faces_}} {
    const double side = prepared.lattice.pitch() * 0x1p48;
    points_.reserve(positions.size());
    for (const Vec& p : positions) points_.push_back({p[0] * side, p[1] * side, p[2] * side});
  }

  BlockComplex::Data run() {
    number_blocks();
    find_natures();
    link_flanks();
    drop_straight_vertices();
    make_faces();
    finish_blocks();
    finish_report();
    if (prepared_.keep_dangling) {
      out_.dangling = find_dangling(prepared_, graph_, arrangement_, block_of_, points_,
                                    [this](Index vertex) { return vertex_id(vertex); });
    }
    return std::move(out_);
  }

 private:
  // ---- flanks: half-edge h with side s, as 2 h + s ------------------------------------------------------------------
  [[nodiscard]] Index half_face_of(Index flank) const {
    const Index face = arrangement_.face[flank / 2];
    return face == none ? none : 2 * face + flank % 2;
  }
  [[nodiscard]] Index block_of_flank(Index flank) const {
    const Index h = half_face_of(flank);
    return h == none ? none : block_of_[h];
  }
  /// The vertex where the flank ends when its face is walked round counter-clockwise seen from outside the block. A
  /// block on the negative side sees the plane's normal as its outward normal and goes with the half-edge.
  [[nodiscard]] Index head(Index flank) const {
    const Index h = flank / 2;
    const Edge& edge = graph_.edges[graph_.uses[h / 2].edge];
    const bool with_edge = (h % 2 == 0) == (flank % 2 == 1);
    return with_edge ? edge.to : edge.from;
  }
  [[nodiscard]] bool internal(Index flank) const { return internal_[flank] != 0; }

  [[nodiscard]] Index following(Index flank) const {
    const Index s = flank % 2;
    const auto step = [&](Index h) { return s == 1 ? arrangement_.next[h] : previous_[h]; };
    Index h = step(flank / 2);
    while (internal(2 * h + s)) h = step(link_[2 * h + s] / 2);
    return 2 * h + s;
  }

  void number_blocks() {
    std::vector<Index> block_of_cell(cells_.count, none);
    Index blocks = 0;
    for (Index c = 0; c < cells_.count; ++c) {
      if (cells_.rock[c] != 0) block_of_cell[c] = blocks++;
    }
    block_count_ = blocks;
    block_of_.assign(2 * std::size_t{faces_}, none);
    for (Index h = 0; h < 2 * faces_; ++h) {
      const Index cell = cells_.of_half_face[h];
      if (cell != none) block_of_[h] = block_of_cell[cell];
    }
    present_.assign(faces_, 0);
    for (Index f = 0; f < faces_; ++f) present_[f] = block_of_[2 * f] != block_of_[2 * f + 1] ? 1 : 0;
  }

  void find_natures() {
    nature_.resize(2 * std::size_t{faces_});
    joint_used_.assign(prepared_.joint_count, 0);
    for (Index h = 0; h < 2 * faces_; ++h) {
      if (block_of_[h] == none || present_[h / 2] == 0) continue;
      const PlaneFace& face = arrangement_.faces[h / 2];
      Nature& nature = nature_[h];
      const Facet* domain = nullptr;
      const Facet* excavation = nullptr;
      for (Index c = face.first_cover; c < face.first_cover + face.cover_count; ++c) {
        const Facet& facet = prepared_.facets[arrangement_.covers[c]];
        switch (facet.owner) {
          case Owner::joint: nature.joint = std::min(nature.joint, facet.owner_index); break;
          case Owner::domain:
            if (domain == nullptr) domain = &facet;
            break;
          case Owner::window: break;
          case Owner::excavation:
            if (excavated_ != nullptr && (*excavated_)[facet.owner_index] == 0) break;
            if (excavation == nullptr || facet.owner_index < excavation->owner_index) excavation = &facet;
            break;
        }
      }
      if (block_of_[h ^ 1U] != none) {
        nature.role = Role::joint;
        for (Index c = face.first_cover; c < face.first_cover + face.cover_count; ++c) {
          const Facet& facet = prepared_.facets[arrangement_.covers[c]];
          if (facet.owner == Owner::joint) joint_used_[facet.owner_index] = 1;
        }
        continue;
      }
      nature.joint = none;
      if (excavation != nullptr) {
        nature.role = Role::free;
        nature.excavation = excavation->owner_index;
        nature.tag = excavation->tag;
      } else if (domain == nullptr) {
        CLEAVE_ASSERT(excavated_ != nullptr || prepared_.windowed);
        nature.role = prepared_.windowed ? Role::window : Role::free;  // the latter: on rock that has fallen
      } else {
        nature.tag = domain->tag;
        nature.role = std::ranges::find(input_.free_domain_tags, domain->tag) != input_.free_domain_tags.end()
                          ? Role::free
                          : Role::fixed;
      }
    }
  }

  /// Links between the separating faces alone, faces merged over coplanar links of one role, shells.
  void link_flanks() {
    link_ = link_around_edges(graph_, arrangement_, present_);
    internal_.assign(link_.size(), 0);
    previous_.assign(arrangement_.next.size(), none);
    for (Index h = 0; h < arrangement_.next.size(); ++h) {
      if (arrangement_.next[h] != none) previous_[arrangement_.next[h]] = h;
    }
    for (Index flank = 0; flank < link_.size(); ++flank) {
      if (link_[flank] == none || block_of_flank(flank) == none) continue;
      const Index a = half_face_of(flank), b = half_face_of(link_[flank]);
      CLEAVE_ASSERT(block_of_[a] == block_of_[b]);
      shells_.unite(a, b);
      const bool straight_on = link_[flank] == (flank ^ 2U);  // the other half-edge of the same use, same side
      if (straight_on && nature_[a].role == nature_[b].role) {
        merged_.unite(a, b);
        internal_[flank] = 1;
      }
    }
  }

  [[nodiscard]] bool on_boundary(Index flank) const {
    return link_[flank] != none && block_of_flank(flank) != none && !internal(flank);
  }

  /// A vertex with two straight edges of one line is no vertex of the block. Counts the fans of each block (a vertex
  /// where the boundary pinches counts once a fan) and its edges.
  void drop_straight_vertices() {
    vertex_count_.assign(block_count_, 0);
    edge_flanks_.assign(block_count_, 0);
    dropped_.assign(link_.size(), 0);
    std::vector<std::uint8_t> seen(link_.size(), 0);
    const auto line_of = [&](Index flank) { return graph_.edges[graph_.uses[flank / 4].edge].line; };
    for (Index flank = 0; flank < link_.size(); ++flank) {
      if (!on_boundary(flank)) continue;
      const Index block = block_of_flank(flank);
      ++edge_flanks_[block];
      if (seen[flank] != 0) continue;
      Index size = 0;
      bool straight = true;
      Index at = flank;
      do {
        seen[at] = 1;
        ++size;
        const Index out = following(at);
        straight = straight && line_of(at) == line_of(out);
        at = link_[out];
      } while (at != flank);
      if (size == 2 && straight) {
        const Index other = link_[following(flank)];
        dropped_[flank] = dropped_[other] = 1;
        edge_flanks_[block] -= 2;  // two edges become one
      } else {
        ++vertex_count_[block];
      }
    }
  }

  // ---- faces
  // ---------------------------------------------------------------------------------------------------------

  [[nodiscard]] Vec3 point(Index vertex) const { return points_[vertex]; }

  VertexId vertex_id(Index vertex) {
    if (number_[vertex] == none) {
      number_[vertex] = static_cast<Index>(out_.vertices.size());
      out_.vertices.push_back(point(vertex));
    }
    return VertexId{number_[vertex]};
  }

  /// Vector area and moment of one plane face as seen from the block of the half-face.
  [[nodiscard]] Measure measure(Index half_face) const {
    const PlaneFace& face = arrangement_.faces[half_face / 2];
    const auto start_of = [&](Index h) {
      const Edge& edge = graph_.edges[graph_.uses[h / 2].edge];
      return point(h % 2 == 0 ? edge.from : edge.to);
    };
    const Vec3 apex = start_of(arrangement_.loops[face.first_loop]);
    const auto n = prepared_.planes[face.plane].unit_normal();
    const Vec3 normal{n[0], n[1], n[2]};
    Vec3 area{}, moment{};
    for (Index l = face.first_loop; l < face.first_loop + face.loop_count; ++l) {
      const Index start = arrangement_.loops[l];
      Index h = start;
      do {
        const Index g = arrangement_.next[h];
        const Vec3 a = start_of(h) - apex, b = start_of(g) - apex;
        const Vec3 part = 0.5 * geometry::cross(a, b);
        area += part;
        moment += geometry::dot(part, normal) * (a + b);
        h = g;
      } while (h != start);
    }
    const double size = geometry::dot(area, normal);
    Measure m{half_face % 2 == 0 ? -area : area, moment + 3 * size * apex};
    return m;
  }

  void make_faces() {
    number_.assign(points_.size(), none);
    const auto& origin = prepared_.lattice.origin();
    out_.origin = {origin[0], origin[1], origin[2]};
    // Half-faces by block and merged face.
    std::vector<Index> order;
    for (Index h = 0; h < 2 * faces_; ++h) {
      if (block_of_[h] != none && present_[h / 2] != 0) order.push_back(h);
    }
    std::vector<Index> root(2 * std::size_t{faces_}, none);
    for (const Index h : order) root[h] = merged_.find(h);
    std::ranges::stable_sort(order, [&](Index a, Index b) {
      return block_of_[a] < block_of_[b] || (block_of_[a] == block_of_[b] && root[a] < root[b]);
    });
    blocks_.assign(block_count_, Block{{}, {}, {}, {}, true, false, false, {}, false, false});
    loops_of_block_.assign(block_count_, 0);
    face_shell_.clear();
    in_loop_.assign(link_.size(), 0);
    for (std::size_t first = 0; first < order.size();) {
      std::size_t last = first;
      while (last < order.size() && root[order[last]] == root[order[first]]) ++last;
      make_face(std::span{order}.subspan(first, last - first));
      first = last;
    }
  }

  void make_face(std::span<const Index> half_faces) {
    const Index first = half_faces.front();
    const Index block = block_of_[first];
    const Nature& nature = nature_[first];
    const PlaneFace& plane_face = arrangement_.faces[first / 2];
    const auto n = prepared_.planes[plane_face.plane].unit_normal();
    const bool positive = first % 2 == 0;
    Face face{.block = BlockId{block},
              .plane = PlaneId{plane_face.plane},
              .block_on_positive_side = positive,
              .role = nature.role,
              .shell = 0,
              .joint = nature.joint == none ? std::nullopt : std::optional{JointId{nature.joint}},
              .excavation = nature.excavation == none ? std::nullopt : std::optional{nature.excavation},
              .tag = nature.tag == none ? std::nullopt : std::optional{nature.tag},
              .outward = positive ? Vec3{-n[0], -n[1], -n[2]} : Vec3{n[0], n[1], n[2]},
              .area = {},
              .centroid = {}};
    face.first_patch = static_cast<Index>(out_.patches.size());
    const auto own_patches = [&] { return std::span{out_.patches}.subspan(face.first_patch); };
    Vec3 area{}, moment{};
    for (const Index h : half_faces) {
      const Measure m = measure(h);
      const double size = geometry::norm(m.vector_area);
      area += m.vector_area;
      moment += m.moment;
      const Index beyond = block_of_[h ^ 1U];
      const auto neighbour =
          nature.role == Role::joint && beyond != none ? std::optional{BlockId{beyond}} : std::nullopt;
      const auto joint = nature_[h].joint == none ? std::nullopt : std::optional{JointId{nature_[h].joint}};
      auto patch = std::ranges::find_if(out_.patches.begin() + face.first_patch, out_.patches.end(),
                                        [&](const Patch& p) { return p.neighbour == neighbour && p.joint == joint; });
      if (patch == out_.patches.end()) {
        out_.patches.push_back({joint, neighbour, {}, {}});
        patch = out_.patches.end() - 1;
      }
      patch->area += square_metres(size);
      patch->centroid += (1.0 / 3) * m.moment;
    }
    face.patch_count = static_cast<Index>(out_.patches.size()) - face.first_patch;
    for (Patch& patch : own_patches()) {
      patch.centroid = out_.origin + (patch.area.si() > 0 ? patch.centroid / patch.area.si() : Vec3{});
    }
    const double size = geometry::norm(area);
    face.area = square_metres(size);
    face.centroid = out_.origin + (size > 0 ? moment / (3 * size) : Vec3{});

    // Loops, the outer one first: it turns once round to the left.
    face.first_corner = static_cast<Index>(out_.corners.size());
    face.first_hole = static_cast<Index>(out_.hole_starts.size());
    const Index half = arrangement_.half_turn[plane_face.plane];
    for (const Index h : half_faces) {
      const PlaneFace& part = arrangement_.faces[h / 2];
      for (Index l = part.first_loop; l < part.first_loop + part.loop_count; ++l) {
        const Index begin = arrangement_.loops[l];
        Index e = begin;
        do {
          const Index flank = 2 * e + h % 2;
          if (on_boundary(flank) && in_loop_[flank] == 0) walk_loop(flank, half, face);
          e = arrangement_.next[e];
        } while (e != begin);
      }
    }
    loops_of_block_[block] += 1 + face.hole_count;
    Block& owner = blocks_[block];
    owner.fixed = owner.fixed || nature.role == Role::fixed;
    owner.truncated = owner.truncated || nature.role == Role::window;
    owner.free = owner.free || nature.role == Role::free;
    owner.convex = owner.convex && face.hole_count == 0;
    const FaceId id = out_.faces.push_back(face);
    owner.faces = owner.faces.empty() ? FaceRange{id, 1}
                                      : FaceRange{owner.faces.front(), static_cast<Index>(owner.faces.size() + 1)};
    face_shell_.push_back(shells_.find(first));
  }

  void walk_loop(Index start, Index half, Face& face) {
    const auto begin = static_cast<std::ptrdiff_t>(out_.corners.size());
    if (face.corner_count > 0) out_.hole_starts.push_back(face.corner_count);
    std::int64_t turning = 0;
    Index flank = start;
    do {
      in_loop_[flank] = 1;
      const Index next = following(flank);
      // Seen from the positive side directions grow counter-clockwise; a block there is looked at from the other side
      // and its faces are walked backwards, which changes the sense of each turn.
      const Index from = arrangement_.direction[flank / 2], to = arrangement_.direction[next / 2];
      const Index step = (to + 2 * half - from) % (2 * half);
      const std::int64_t left = step < half ? std::int64_t{step} : std::int64_t{step} - 2 * std::int64_t{half};
      turning += flank % 2 == 1 ? left : -left;
      if (dropped_[flank] == 0) out_.corners.push_back(vertex_id(head(flank)));
      flank = next;
    } while (flank != start);
    const auto added = static_cast<Index>(out_.corners.size()) - static_cast<Index>(begin);
    if (face.corner_count > 0) {
      ++face.hole_count;
      if (turning > 0) {  // the outer loop goes first
        std::rotate(out_.corners.begin() + face.first_corner, out_.corners.begin() + begin, out_.corners.end());
        const std::span<Index> starts = std::span{out_.hole_starts}.subspan(face.first_hole);
        for (std::size_t k = starts.size(); k-- > 1;) starts[k] = starts[k - 1] + added;
        starts[0] = added;
      }
    }
    face.corner_count += added;
  }

  // ---- blocks
  // ----------------------------------------------------------------------------------------------------------

  void finish_blocks() {
    find_reflex_edges();
    const double extent = extent_of_domain();
    for (Index b = 0; b < block_count_; ++b) finish_block(b, extent);
    out_.blocks = IdVector<BlockId, Block>{std::move(blocks_)};
  }

  void find_reflex_edges() {
    for (Index leaving = 0; leaving < link_.size(); ++leaving) {
      const Index h = leaving / 2;
      if (leaving % 2 != h % 2 || !on_boundary(leaving)) continue;
      const auto place = [&](Index half_edge) {
        const Slot& slot = graph_.slots[graph_.uses[half_edge / 2].slot];
        const Index planes = graph_.lines[graph_.edges[graph_.uses[half_edge / 2].edge].line].slot_count;
        return half_edge % 2 == 0 ? slot.left_place : (slot.left_place + planes) % (2 * planes);
      };
      const Index planes = graph_.lines[graph_.edges[graph_.uses[h / 2].edge].line].slot_count;
      const Index span = (place(link_[leaving] / 2) + 2 * planes - place(h)) % (2 * planes);
      if (span == 0 || span > planes) blocks_[block_of_flank(leaving)].convex = false;
    }
  }

  [[nodiscard]] double extent_of_domain() const {
    double extent = 0;
    const auto vertices = input_.domain.vertices();
    for (const Vec3& v : vertices) extent = std::max(extent, geometry::norm(v - vertices[0]));
    return extent;
  }

  void finish_block(Index b, double extent) {
    Block& block = blocks_[b];
    CLEAVE_ASSERT(!block.faces.empty());
    const Vec3 apex = out_.vertices[out_.corners[out_.faces[block.faces[0]].first_corner]];
    // Shells in order of their first face; their volumes tell which one is outside.
    std::vector<Index> shells;
    std::vector<double> volumes;
    Vec3 moment{};
    double volume = 0;
    for (const FaceId f : block.faces) {
      const Index shell = face_shell_[f.index()];
      auto found = std::ranges::find(shells, shell);
      if (found == shells.end()) {
        shells.push_back(shell);
        volumes.push_back(0);
        found = shells.end() - 1;
      }
      double part = 0;
      const Face& face = out_.faces[f];
      const Vec3 o = out_.vertices[out_.corners[face.first_corner]] - apex;
      for (const auto loop : out_.loops(face)) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
          const Vec3 a = out_.vertices[loop[i]] - apex, c = out_.vertices[loop[(i + 1) % loop.size()]] - apex;
          const double six = geometry::dot(o, geometry::cross(a, c));
          part += six;
          moment += six * (o + a + c);
        }
      }
      volumes[static_cast<std::size_t>(found - shells.begin())] += part;
      volume += part;
    }
    volume /= 6;
    const auto outer = std::ranges::max_element(volumes) - volumes.begin();
    std::swap(shells[0], shells[static_cast<std::size_t>(outer)]);
    for (const FaceId f : block.faces) {
      out_.faces[f].shell =
          static_cast<std::uint32_t>(std::ranges::find(shells, face_shell_[f.index()]) - shells.begin());
    }
    block.volume = cubic_metres(volume);
    block.centroid = out_.origin + apex + (volume > 0 ? moment / (24 * volume) : Vec3{});
    const std::int64_t v = vertex_count_[b], e = edge_flanks_[b] / 2, f = static_cast<std::int64_t>(block.faces.size()),
                       l = loops_of_block_[b], s = static_cast<std::int64_t>(shells.size());
    const std::int64_t twice_genus = 2 * s - (v - e + f - (l - f));
    block.counts = {static_cast<std::uint32_t>(v),
                    static_cast<std::uint32_t>(e),
                    static_cast<std::uint32_t>(f),
                    static_cast<std::uint32_t>(l),
                    static_cast<std::uint32_t>(s),
                    twice_genus < 0 || twice_genus % 2 != 0 ? UINT32_MAX : static_cast<std::uint32_t>(twice_genus / 2)};
    block.convex = block.convex && s == 1;
    block.thickness = metres(thickness(block));
    block.sliver = block.thickness.si() < 1e-6 * extent;
  }

  /// Smallest width across the largest faces: a thin block is thin across a large face.
  [[nodiscard]] double thickness(const Block& block) const {
    std::vector<FaceId> faces{block.faces.begin(), block.faces.end()};
    const std::size_t looked_at = std::min<std::size_t>(8, faces.size());
    std::ranges::partial_sort(faces, faces.begin() + static_cast<std::ptrdiff_t>(looked_at), [&](FaceId a, FaceId b) {
      return out_.faces[a].area > out_.faces[b].area || (out_.faces[a].area == out_.faces[b].area && a < b);
    });
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < looked_at; ++k) {
      const Vec3 n = out_.faces[faces[k]].outward;
      double lo = std::numeric_limits<double>::infinity(), hi = -lo;
      for (const FaceId f : block.faces) {
        for (const VertexId v : out_.loops(out_.faces[f]).all_corners()) {
          const double h =
              geometry::dot(n, out_.vertices[v] - out_.vertices[out_.corners[out_.faces[faces[k]].first_corner]]);
          lo = std::min(lo, h);
          hi = std::max(hi, h);
        }
      }
      least = std::min(least, hi - lo);
    }
    return least;
  }

  void finish_report() {
    out_.planes = IdVector<PlaneId, exact::Plane>{std::vector<exact::Plane>(
        prepared_.planes.begin(), prepared_.planes.begin() + static_cast<std::ptrdiff_t>(prepared_.facet_planes))};
    out_.domain_volume = cubic_metres(prepared_.domain_volume);
    out_.excavated_volume = cubic_metres(void_volume());
    CutReport& report = out_.report;
    report.lattice_pitch_m = prepared_.lattice.pitch();
    report.largest_snap_m = prepared_.largest_snap;
    report.merged_planes = prepared_.merged_planes;
    report.adopted_edges = prepared_.adopted_edges;
    report.joints_outside = prepared_.outside.size();
    for (const Index j : prepared_.outside) report.outside.emplace_back(j);
    for (Index j = 0; j < prepared_.joint_count; ++j) {
      if (joint_used_[j] == 0 && std::ranges::find(prepared_.outside, j) == prepared_.outside.end())
        report.dangling.emplace_back(j);
    }
  }

  /// Volume of the cells of the domain that are not rock, from their own walls.
  [[nodiscard]] double void_volume() const {
    double volume = 0;
    for (Index h = 0; h < 2 * faces_; ++h) {
      const Index cell = cells_.of_half_face[h];
      if (cell == none || cells_.in_domain[cell] == 0 || cells_.rock[cell] != 0) continue;
      const Index beyond = cells_.of_half_face[h ^ 1U];
      if (beyond == cell) continue;
      const Measure m = measure(h);
      const PlaneFace& face = arrangement_.faces[h / 2];
      const Edge& edge = graph_.edges[graph_.uses[arrangement_.loops[face.first_loop] / 2].edge];
      volume += geometry::dot(point(edge.from), m.vector_area);
    }
    return volume / 3;
  }

  const CutInput& input_;
  const Prepared& prepared_;
  const Graph& graph_;
  const Arrangement& arrangement_;
  const Cells& cells_;
  const std::vector<std::uint8_t>* excavated_;
  Index faces_;
  UnionFind merged_, shells_;
  std::vector<Vec3> points_;
  std::vector<Index> block_of_;  ///< of each half-face
  std::vector<std::uint8_t> present_, joint_used_, internal_, dropped_, in_loop_;
  std::vector<Nature> nature_;
  std::vector<Index> link_, previous_, number_, vertex_count_, edge_flanks_, loops_of_block_, face_shell_;
  std::vector<Block> blocks_;
  Index block_count_ = 0;
  BlockComplex::Data out_;
};

}  // namespace

BlockComplex::Data assemble(const CutInput& input, const Prepared& prepared, const Graph& graph,
                            const Arrangement& arrangement, const Cells& cells, const std::vector<Vec>& positions,
                            const std::vector<std::uint8_t>* excavated) {
  return Assembler{input, prepared, graph, arrangement, cells, positions, excavated}.run();
}

}  // namespace cleave::topology::detail
