#include "detail/assemble.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "cleave/core/mutex.hpp"
#include "detail/block_maker.hpp"
#include "detail/dangling.hpp"
#include "detail/exact_volume.hpp"
#include "detail/joint_network.hpp"
#include "detail/pieces.hpp"

namespace cleave::topology::detail {
namespace {

using geometry::Vec3;

/// Blocks are numbered in the order of their cells.
void number_blocks(Cells& cells, BlockParts& parts, ThreadLimit threads) {
  std::vector<Index> block_of_cell(cells.count, none);
  Index blocks = 0;
  for (Index c = 0; c < cells.count; ++c) {
    if (cells.rock[c] != 0) block_of_cell[c] = blocks++;
  }
  const std::size_t faces = parts.arrangement.faces.size();
  parts.block_of = std::move(cells.of_half_face);
  parts.present.assign(faces, 0);
  in_pieces(faces, 16384, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t f = first; f < last; ++f) {
      for (const std::size_t h : {2 * f, 2 * f + 1}) {
        Index& at = parts.block_of[h];
        if (at != none) at = block_of_cell[at];
      }
      parts.present[f] = parts.block_of[2 * f] != parts.block_of[2 * f + 1] ? 1 : 0;
    }
  });
  parts.begin.assign(blocks + std::size_t{1}, 0);
  for (std::size_t h = 0; h < 2 * faces; ++h) {
    if (parts.present[h / 2] != 0 && parts.block_of[h] != none) ++parts.begin[parts.block_of[h] + std::size_t{1}];
  }
  for (std::size_t b = 1; b < parts.begin.size(); ++b) parts.begin[b] += parts.begin[b - 1];
  parts.half_faces.resize(parts.begin.back());
  auto next = parts.begin;
  for (std::size_t h = 0; h < 2 * faces; ++h) {
    if (parts.present[h / 2] != 0 && parts.block_of[h] != none) {
      parts.half_faces[next[parts.block_of[h]]++] = static_cast<Index>(h);
    }
  }
}

/// Links between the present faces: those of all covered faces where none has gone.
void link_present(Cells& cells, BlockParts& parts, ThreadLimit threads) {
  bool all = !cells.links.to.empty();
  for (std::size_t f = 0; f < parts.present.size() && all; ++f) {
    all = (parts.arrangement.faces[f].cover_count != 0) == (parts.present[f] != 0);
  }
  if (all) {
    parts.links = std::move(cells.links);
  } else {
    cells.links = {};
    parts.links = link_around_edges(parts.graph, parts.arrangement, parts.present, threads);
  }
}

/// Which faces are pieces of folded polygons, and what walking over them needs.
void find_sheets(BlockParts& parts) {
  const Arrangement& arrangement = parts.arrangement;
  if (!parts.prepared.has_sheets) return;
  parts.sheets.assign(arrangement.faces.size(), none);
  for (std::size_t f = 0; f < arrangement.faces.size(); ++f) {
    const PlaneFace& face = arrangement.faces[f];
    for (Index c = face.first_cover; c < face.first_cover + face.cover_count; ++c) {
      parts.sheets[f] = std::min(parts.sheets[f], parts.prepared.facets[arrangement.covers[c]].sheet);
    }
  }
  parts.before.assign(arrangement.next.size(), none);
  for (Index h = 0; h < arrangement.next.size(); ++h) {
    if (arrangement.next[h] != none) parts.before[arrangement.next[h]] = h;
  }
  parts.straight = 64 * (parts.prepared.bend + 4) * 0x1p-48;
}

double extent_of_domain(const CutInput& input) {
  double extent = 0;
  const auto vertices = input.domain.vertices();
  for (const Vec3& v : vertices) extent = std::max(extent, geometry::norm(v - vertices[0]));
  return extent;
}

/// Puts what shares of the blocks have made behind one another, in order, as soon as all shares before are done; by
/// whichever thread comes along, while others go on making.
class Joiner {
 public:
  Joiner(std::size_t shares, const BlockParts& parts, MadeBlocks& out)
      : out_{out}, packer_{out.faces, parts.normals, parts.plane_faces()}, waiting_(shares) {}

  /// `blocks` are those of the share; their faces get their final numbers.
  void hand_in(std::size_t share, MadeBlocks made, std::span<Block> blocks) {
    Lock lock{mutex_};
    waiting_[share].emplace(std::move(made), blocks);
    if (busy_) return;  // whoever is at it looks again before leaving
    busy_ = true;
    while (next_ < waiting_.size() && waiting_[next_]) {
      auto [ready, its_blocks] = *std::move(waiting_[next_]);
      waiting_[next_++].reset();
      lock.unlock();
      append(std::move(ready), its_blocks);
      lock.lock();
    }
    busy_ = false;
  }

 private:
  void append(MadeBlocks more, std::span<Block> blocks) {
    const auto faces = static_cast<Index>(out_.faces.size()), corners = static_cast<Index>(out_.corners.size()),
               holes = static_cast<Index>(out_.hole_starts.size());
    for (Block& block : blocks) {
      block.faces = {FaceId{block.faces.front().index() + faces}, static_cast<Index>(block.faces.size())};
    }
    packer_.append(std::move(more.faces), corners, holes);
    out_.corners.insert(out_.corners.end(), more.corners.begin(), more.corners.end());
    out_.hole_starts.insert(out_.hole_starts.end(), more.hole_starts.begin(), more.hole_starts.end());
  }

  MadeBlocks& out_;
  FacePacker packer_;
  Mutex mutex_;
  std::vector<std::optional<std::pair<MadeBlocks, std::span<Block>>>> waiting_;
  std::size_t next_ = 0;
  bool busy_ = false;
};

/// Each thread makes shares of neighbouring blocks, and their faces are concatenated: what comes out does not
/// depend on where the shares end.
std::vector<Block> make_blocks(BlockParts& parts, ThreadLimit threads, MadeBlocks& out) {
  const std::size_t blocks = parts.begin.size() - 1;
  const Block empty{{}, {}, {}, {}, true, false, false, {}, false, false};
  std::vector<Block> made(blocks, empty);
  const std::size_t shares =
      threads.count() == 1 ? 1 : std::min(std::max<std::size_t>(blocks / 256, 1), 8 * threads.count());
  std::vector<std::size_t> share_begin(shares + 1, blocks);
  for (std::size_t s = 0; s < shares; ++s) {  // equal numbers of half-faces
    const std::size_t at = parts.half_faces.size() * s / shares;
    share_begin[s] = static_cast<std::size_t>(std::ranges::lower_bound(parts.begin, at) - parts.begin.begin());
  }
  std::size_t corners = 0;
  for (const Index to : parts.links.to) corners += to != none ? 1 : 0;
  // All memory at once, as much as may be needed: what is not used is never touched.
  FacePacker{out.faces, parts.normals}.reserve(parts.half_faces.size());
  out.corners.reserve(corners);
  if (shares == 1) {
    BlockMaker maker{parts, parts.links.to, out};
    for (std::size_t b = 0; b < blocks; ++b) made[b] = maker.make(static_cast<Index>(b));
    return made;
  }
  Joiner joiner{shares, parts, out};
  std::atomic<std::size_t> next{0};
  parallel_for(shares, threads, [&](std::size_t) {
    const std::size_t s = next++;  // in order, so that what is made can be put together soon
    MadeBlocks own;
    const std::size_t half_faces = parts.begin[share_begin[s + 1]] - parts.begin[share_begin[s]];
    FacePacker{own.faces, parts.normals}.reserve(half_faces);
    own.corners.reserve(corners / shares);
    BlockMaker maker{parts, parts.links.to, own};
    for (std::size_t b = share_begin[s]; b < share_begin[s + 1]; ++b) made[b] = maker.make(static_cast<Index>(b));
    joiner.hand_in(s, std::move(own), std::span{made}.subspan(share_begin[s], share_begin[s + 1] - share_begin[s]));
  });
  return made;
}

/// The measures of plane faces become those of the faces that blocks have of them, in the same place.
void put_measures(BlockParts& parts, PackedFaces& faces, ThreadLimit threads) {
  in_pieces(parts.measures.size(), 16384, threads, [&](std::size_t first, std::size_t last) {
    for (auto f = static_cast<Index>(first); f < last; ++f) {
      if (parts.present[f] != 0) parts.measures[f] = parts.in_metres(f);
    }
  });
  FacePacker{faces, parts.normals, parts.plane_faces()}.put_measures(std::move(parts.measures));
}

/// Vertices that are corners, in the order of the graph; others get numbers when they are asked for.
class VertexNumbers {
 public:
  VertexNumbers(const BlockParts& parts, BlockComplex::Data& out)
      : parts_{parts}, out_{out}, number_(parts.positions.size(), none) {}

  void number(std::vector<VertexId> corners, ThreadLimit threads) {
    std::vector<std::uint8_t> used(number_.size(), 0);
    in_pieces(corners.size(), 65536, threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = first; k < last; ++k) {
        std::atomic_ref{used[corners[k].index()]}.store(1, std::memory_order_relaxed);
      }
    });
    out_.vertices.reserve(number_.size());
    for (Index v = 0; v < used.size(); ++v) {
      if (used[v] != 0) static_cast<void>(id(v));
    }
    in_pieces(corners.size(), 65536, threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = first; k < last; ++k) corners[k] = VertexId{number_[corners[k].index()]};
    });
    out_.corners = std::move(corners);
  }
  VertexId id(Index vertex) {
    if (number_[vertex] == none) {
      number_[vertex] = out_.vertices.push_back(parts_.scale * parts_.position(vertex)).value();
    }
    return VertexId{number_[vertex]};
  }

 private:
  const BlockParts& parts_;
  BlockComplex::Data& out_;
  std::vector<Index> number_;
};

/// Volume of the domain in doubles, units^3; empty where too much cancels.
std::optional<double> domain_volume(std::span<const std::array<exact::FixedPoint, 3>> surface) {
  double sum = 0, size = 0;
  const exact::FixedPoint origin = surface[0][0];
  for (const auto& triangle : surface) {
    std::array<Vec, 3> p;
    for (std::size_t c = 0; c < 3; ++c) {
      p[c] = exact::as_position({triangle[c][0] - origin[0], triangle[c][1] - origin[1], triangle[c][2] - origin[2]});
    }
    const auto& [u, v, w] = p;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      const double first = v[i] * w[j], second = v[j] * w[i];
      sum += u[k] * (first - second);
      size += std::abs(u[k]) * (std::abs(first) + std::abs(second));
    }
  }
  if (!(size * 0x1p-50 <= sum * 0x1p-37)) return std::nullopt;
  return sum / 6;
}

/// Volume of the domain less that of its part that is not rock, from the surface of the one and the walls of the other;
/// units^3. By integers where little rock is left of large volumes.
double rock_volume(const BlockParts& parts, const Cells& cells) {
  const auto in_void = [&](Index h) {
    const Index cell = cells.of_half_face[h];
    return cell != none && cells.in_domain[cell] != 0 && cells.rock[cell] == 0;
  };
  std::vector<Index> walls;  // seen from the rock
  Cones cones{parts.prepared, parts.arrangement, parts.positions, parts.measures};
  double empty = 0;
  for (Index h = 0; h < cells.of_half_face.size(); ++h) {
    if (!in_void(h) || in_void(h ^ 1U)) continue;
    walls.push_back(h ^ 1U);
    empty += h % 2 == 0 ? -cones.of(h / 2) : cones.of(h / 2);
  }
  const auto& surface = parts.prepared.domain_surface;
  if (const auto domain = domain_volume(surface)) {
    if (*domain - empty / 3 > *domain / 64) return *domain - empty / 3;
  }
  FixedMeasure rock{surface[0][0]};
  for (const auto& [a, b, c] : surface) rock.add(a, b, c);
  ExactMeasures exactly{parts.prepared, parts.graph, parts.arrangement};
  for (const Index wall : walls) exactly.add(rock, wall);
  return rock.volume();
}

/// What each excavation takes of the domain, from the walls of its cells; units^3.
std::vector<ExcavatedVolume> excavated_volumes(const BlockParts& parts, const Cells& cells) {
  const std::size_t count = parts.prepared.excavation_count;
  std::vector<double> inside(count, 0), removed(count, 0);
  /// One half-face of a cell that is not rock: its cone counts where the cell behind it is of another kind.
  const auto add = [&](Index h, double cone) {
    const Index here = cells.of_half_face[h], beyond = cells.of_half_face[h ^ 1U];
    if (here == none || cells.in_domain[here] == 0 || cells.rock[here] != 0) return;
    bool earlier = false, beyond_earlier = false;
    for (std::size_t e = 0; e < count; ++e) {
      const bool in = cells.excavated_by[here * count + e] != 0;
      const bool goes_on = beyond != none && cells.in_domain[beyond] != 0 && cells.rock[beyond] == 0 &&
                           cells.excavated_by[beyond * count + e] != 0;
      if (in && !goes_on) inside[e] += cone;
      if (in && !earlier && !(goes_on && !beyond_earlier)) removed[e] += cone;
      earlier = earlier || in;
      beyond_earlier = beyond_earlier || goes_on;
    }
  };
  Cones cones{parts.prepared, parts.arrangement, parts.positions, parts.measures};
  for (Index h = 0; count > 0 && h < cells.of_half_face.size(); ++h) {
    if (parts.arrangement.faces[h / 2].cover_count == 0) continue;
    add(h, h % 2 == 0 ? -cones.of(h / 2) : cones.of(h / 2));
  }
  std::vector<ExcavatedVolume> volumes(count);
  const double unit = parts.scale * parts.scale * parts.scale / 3;
  for (std::size_t e = 0; e < count; ++e) {
    volumes[e] = {cubic_metres(std::max(0.0, removed[e]) * unit), cubic_metres(std::max(0.0, inside[e]) * unit)};
  }
  return volumes;
}

void finish_report(const BlockParts& parts, BlockComplex::Data& out) {
  const Prepared& prepared = parts.prepared;
  out.planes = IdVector<PlaneId, exact::Plane>{std::vector<exact::Plane>(
      prepared.planes.begin(), prepared.planes.begin() + static_cast<std::ptrdiff_t>(prepared.facet_planes))};
  CutReport& report = out.report;
  report.lattice_pitch_m = prepared.lattice.pitch();
  report.largest_snap_m = prepared.largest_snap.si();
  report.coarse_snap = prepared.coarse_snap;
  report.bend_m = prepared.bend * prepared.lattice.pitch();
  report.merged_planes = prepared.merged_planes;
  report.adopted_edges = prepared.adopted_edges;
  report.snapped = prepared.snapped;
  report.joints_outside = prepared.outside.size();
  std::vector<std::uint8_t> used(prepared.joint_count, 0);
  std::vector<Index> joints;  // of one face
  for (const Index j : prepared.outside) {
    report.outside.emplace_back(j);
    used[j] = 1;
  }
  for (std::size_t f = 0; f < parts.present.size(); ++f) {
    if (parts.present[f] == 0 || parts.block_of[2 * f] == none || parts.block_of[2 * f + 1] == none) continue;
    const PlaneFace& face = parts.arrangement.faces[f];
    joints.clear();
    for (Index c = face.first_cover; c < face.first_cover + face.cover_count; ++c) {
      const Facet& facet = prepared.facets[parts.arrangement.covers[c]];
      if (facet.owner == Owner::joint) joints.push_back(facet.owner_index);
    }
    for (const Index joint : joints) used[joint] = 1;
    if (joints.size() < 2) continue;
    const Index least = std::ranges::min(joints);
    for (const Index joint : joints) {
      if (joint != least) report.overlapping.emplace_back(least, joint);
    }
  }
  std::ranges::sort(report.overlapping);
  report.overlapping.erase(std::ranges::unique(report.overlapping).begin(), report.overlapping.end());
  for (Index j = 0; j < prepared.joint_count; ++j) {
    if (used[j] == 0) report.dangling.emplace_back(j);
  }
}

}  // namespace

BlockComplex::Packed assemble(const CutInput& input, const Prepared& prepared, const Graph& graph,
                              const Arrangement& arrangement, Cells cells, const std::vector<Vec>& positions,
                              std::vector<FaceMeasure> measures, ThreadLimit threads,
                              const std::vector<std::uint8_t>* excavated, Graph* no_more_needed) {
  const auto& origin = prepared.lattice.origin();
  BlockParts parts{.prepared = prepared,
                   .graph = graph,
                   .arrangement = arrangement,
                   .positions = positions,
                   .measures = std::move(measures),
                   .input = input,
                   .excavated = excavated,
                   .normals = {},
                   .block_of = {},
                   .present = {},
                   .links = {},
                   .slot_of = {},
                   .line_of_slot = {},
                   .begin = {},
                   .half_faces = {},
                   .sheets = {},
                   .before = {},
                   .straight = 0,
                   .scale = prepared.lattice.pitch() * 0x1p48,
                   .sliver_below = 1e-6 * extent_of_domain(input),
                   .origin = {origin[0], origin[1], origin[2]}};
  for (Index p = 0; p < prepared.facet_planes; ++p) {
    const auto n = prepared.planes[p].unit_normal();
    parts.normals.push_back({n[0], n[1], n[2]});
  }
  BlockComplex::Packed packed;
  BlockComplex::Data& out = packed.rest;
  out.origin = parts.origin;
  out.rock_volume = cubic_metres(rock_volume(parts, cells) * parts.scale * parts.scale * parts.scale);
  out.report.excavated = excavated_volumes(parts, cells);
  number_blocks(cells, parts, threads);
  link_present(cells, parts, threads);
  parts.slot_of.reserve(graph.uses.size());
  for (const Use& use : graph.uses) parts.slot_of.push_back(use.slot);
  parts.line_of_slot.resize(graph.slots.size());
  for (Index line = 0; line < graph.lines.size(); ++line) {
    const auto [p, q, approx, first, count] = graph.lines[line];
    std::ranges::fill(std::span{parts.line_of_slot}.subspan(first, count), line);
  }
  if (no_more_needed != nullptr && !prepared.draw_outlines) {
    let_go(no_more_needed->edges);
    let_go(no_more_needed->uses);
    let_go(no_more_needed->slots);
    let_go(no_more_needed->lines);
  }
  find_sheets(parts);
  MadeBlocks made;
  out.blocks = IdVector<BlockId, Block>{make_blocks(parts, threads, made)};
  let_go(parts.links.to);
  let_go(parts.half_faces);
  put_measures(parts, made.faces, threads);
  VertexNumbers vertices{parts, out};
  vertices.number(std::move(made.corners), threads);
  packed.faces = std::move(made.faces);
  out.hole_starts = std::move(made.hole_starts);
  finish_report(parts, out);
  if (prepared.draw_outlines) {
    std::vector<Vec3> points;
    for (const Vec& p : positions) points.push_back(parts.scale * Vec3{p[0], p[1], p[2]});
    const auto vertex_id = [&](Index vertex) { return vertices.id(vertex); };
    if (input.keep_dangling) {
      out.dangling = find_dangling(prepared, graph, arrangement, parts.block_of, points, vertex_id);
    }
    if (input.keep_network) out.network = make_joint_network(parts, points, vertex_id);
  }
  FacePacker::finish(packed.faces, std::move(parts.normals));
  return packed;
}

}  // namespace cleave::topology::detail
