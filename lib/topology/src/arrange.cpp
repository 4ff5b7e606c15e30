#include <algorithm>
#include <cmath>
#include <numeric>

#include "cleave/core/assert.hpp"
#include "detail/nesting.hpp"
#include "detail/phases.hpp"
#include "detail/pieces.hpp"
#include "detail/plane_view.hpp"

namespace cleave::topology::detail {
namespace {

using exact::Sign;

/// Ranks of the directions of all lines in one plane, counter-clockwise about its normal, by exact signs.
class Directions {
 public:
  /// The ranks of the plane's slots go to `ranks`.
  Directions(const Graph& graph, const PlaneView& view, Signs& signs, std::vector<Index>& ranks) {
    // One entry a line: its direction in the plane comes from the slot's transversal plane. The uses of a line stand
    // together, lines and their slots in order.
    for (Index k = 0; k < view.uses.size(); ++k) {
      const Use& use = graph.uses[view.uses[k]];
      if (entries_.empty() || entries_.back().slot != use.slot) {
        entries_.push_back({use.slot, graph.edges[use.edge].line, k, k, 0, 1, 0});
      }
      entries_.back().last = k + 1;
    }
    if (entries_.empty()) return;

    // Everything is turned into the half-turn that starts at the first line's direction.
    const auto turn = [&](const Entry& a, const Entry& b) {  // of the lines' own directions
      const Slot &s = graph.slots[a.slot], &t = graph.slots[b.slot];
      if (s.transversal == t.transversal) return 0;
      const int sign = static_cast<int>(signs.det3(view.plane, s.transversal, t.transversal));
      return s.along == t.along ? sign : -sign;
    };
    const auto& n = signs.plane(view.plane).approx();
    const auto direction = [&](const Entry& e) { return graph.lines[e.line].approx.m; };
    const auto start = direction(entries_[0]);
    const std::array<double, 3> up{n[1] * start[2] - n[2] * start[1], n[2] * start[0] - n[0] * start[2],
                                   n[0] * start[1] - n[1] * start[0]};
    for (std::size_t k = 1; k < entries_.size(); ++k) {
      Entry& e = entries_[k];
      const int side = turn(entries_[0], e);
      if (side == 0) {
        const LineClass &a = graph.lines[entries_[0].line], &b = graph.lines[e.line];
        e.flip = signs.same_sense(a.approx, a.p, a.q, b.approx, b.p, b.q) ? 1 : -1;
        e.key = -1;
      } else {
        e.flip = side;
        const auto d = direction(e);
        const double x = e.flip * (start[0] * d[0] + start[1] * d[1] + start[2] * d[2]);
        const double y = std::abs(up[0] * d[0] + up[1] * d[1] + up[2] * d[2]);
        const double scale = std::abs(x) + y;
        e.key = scale > 0 ? 1 - x / scale : 1;  // grows with the angle from 0 to half a turn
      }
    }
    entries_[0].key = -1;
    const auto before = [&](const Entry& a, const Entry& b) {
      if (a.key < 0 || b.key < 0) return a.key < 0 && b.key >= 0;
      return a.flip * b.flip * turn(a, b) > 0;
    };
    std::ranges::stable_sort(entries_, {}, &Entry::key);
    bool in_order = true;
    for (std::size_t k = 1; k < entries_.size() && in_order; ++k) in_order = !before(entries_[k], entries_[k - 1]);
    if (!in_order) std::ranges::stable_sort(entries_, before);
    for (std::size_t k = 1; k < entries_.size(); ++k) {
      entries_[k].rank = entries_[k - 1].rank + (before(entries_[k - 1], entries_[k]) ? 1 : 0);
    }
    half_turn_ = entries_.back().rank + 1;
    rays_.reserve(2 * entries_.size());
    for (const Entry& e : entries_) {
      const Index forward = e.flip > 0 ? e.rank : e.rank + half_turn_;
      ranks[e.slot] = forward;
      rays_.push_back({forward, e.first, e.last, false});
      rays_.push_back({opposite(forward, half_turn_), e.first, e.last, true});
    }
    std::ranges::sort(rays_, {}, &Ray::direction);  // of one direction in any order: they have no vertex in common
  }

  /// The uses of one line, seen along it or (`back`) against it: places [first, last) in the view.
  struct Ray {
    Index direction, first, last;
    bool back;
  };
  [[nodiscard]] Index half_turn() const noexcept { return half_turn_; }
  /// In the order of their directions.
  [[nodiscard]] std::span<const Ray> rays() const noexcept { return rays_; }

 private:
  struct Entry {
    Index slot, line;
    Index first, last;  ///< uses in the view
    double key;
    int flip;
    Index rank;
  };
  std::vector<Entry> entries_;
  std::vector<Ray> rays_;
  Index half_turn_ = 0;
};

/// What all planes share; each plane has its own half-edges.
struct HalfEdges {
  Arrangement& out;
  std::vector<Index> loop_of;  ///< number of the loop in its plane
};

/// Faces of one plane after another.
class Arranger {
 public:
  Arranger(const Prepared& prepared, const Traces& traces, const Graph& graph, const std::vector<Vec>& positions,
           const Signs& signs, HalfEdges& half_edges)
      : prepared_{prepared},
        traces_{traces},
        graph_{graph},
        positions_{positions},
        signs_{signs.another()},
        out_{half_edges.out},
        loop_of_{half_edges.loop_of} {}

  struct Result {
    std::vector<PlaneFace> faces;
    std::vector<Index> loops, covers;
    Signs signs;
  };
  [[nodiscard]] Result result() && { return {std::move(faces_), std::move(face_loops_), std::move(covers_), signs_}; }

  void in_plane(const PlaneView& view) {
    const Directions directions{graph_, view, signs_, out_.rank};
    out_.half_turn[view.plane] = directions.half_turn();
    link_half_edges(view, directions);
    find_loops(view, directions.half_turn());
    const auto positives = std::ranges::count_if(loops_, [](const Loop& loop) { return loop.outer; });
    if (positives == 0) return;

    const Index first_face = static_cast<Index>(faces_.size());
    // Which positive loop's face holds each negative loop (none: the unbounded face).
    const std::vector<Index> parent = nest_loops(view, loops_, loop_of_, out_, graph_, positions_, signs_);
    std::vector<Index> face_of_loop(loops_.size(), none);
    std::vector<std::vector<Index>> holes(loops_.size());
    for (Index l = 0; l < loops_.size(); ++l) {
      if (!loops_[l].outer && parent[l] != none) holes[parent[l]].push_back(l);
    }
    for (Index l = 0; l < loops_.size(); ++l) {
      if (!loops_[l].outer) continue;
      face_of_loop[l] = static_cast<Index>(faces_.size());
      PlaneFace face{view.plane, static_cast<Index>(face_loops_.size()), static_cast<Index>(1 + holes[l].size()), 0, 0};
      face_loops_.push_back(loops_[l].start);
      for (const Index hole : holes[l]) {
        face_of_loop[hole] = face_of_loop[l];
        face_loops_.push_back(loops_[hole].start);
      }
      faces_.push_back(face);
    }
    for (const Index use : view.uses) {
      for (const Index h : {2 * use, 2 * use + 1}) out_.face[h] = face_of_loop[loop_of_[h]];
    }
    cover(view, first_face);
  }

 private:
  /// A half-edge that arrives at a vertex goes on along the one just clockwise of its own twin: its face stays on the
  /// left. Half-edges come to their vertices in the order of their directions.
  void link_half_edges(const PlaneView& view, const Directions& directions) {
    for (const Index use : view.uses) {
      const Edge& edge = graph_.edges[graph_.uses[use].edge];
      out_.start[2 * use] = edge.from;
      out_.start[2 * use + 1] = edge.to;
    }
    around_.resize(positions_.size(), {none, none});
    reached_.clear();
    for (const auto& [direction, first, last, back] : directions.rays()) {
      for (Index k = first; k < last; ++k) {
        const Index h = 2 * view.uses[k] + (back ? 1 : 0);
        const Index vertex = out_.start[h];
        Around& around = around_[vertex];
        if (around.first == none) {
          around.first = h;
          reached_.push_back(vertex);
        } else {
          out_.next[h ^ 1U] = around.last;
        }
        around.last = h;
      }
    }
    for (const Index vertex : reached_) {
      Around& around = around_[vertex];
      out_.next[around.first ^ 1U] = around.last;
      around = {none, none};
    }
  }

  void find_loops(const PlaneView& view, Index half) {
    loops_.clear();
    for (const Index use : view.uses) loop_of_[2 * use] = loop_of_[2 * use + 1] = none;
    for (const Index use : view.uses) {
      for (const Index start : {2 * use, 2 * use + 1}) {
        if (loop_of_[start] != none) continue;
        const Index number = static_cast<Index>(loops_.size());
        // Total turning in steps of half a turn / n: + 2 n round a face, - 2 n round a hole. Turning back at a free end
        // is to the right.
        std::int64_t turning = 0;
        Index h = start, along = out_.direction_of(h, graph_.uses[use].slot, half);
        do {
          loop_of_[h] = number;
          h = out_.next[h];
          const Index before = along;
          along = out_.direction_of(h, graph_.uses[h / 2].slot, half);
          turning += turn_between(before, along, half);
        } while (h != start);
        CLEAVE_ASSERT(turning == 2 * std::int64_t{half} || turning == -2 * std::int64_t{half});
        loops_.push_back({start, turning > 0});
      }
    }
  }

  /// Which facets lie under each face. With a single convex facet all bounded faces are covered, because everything
  /// drawn lies in it.
  void cover(const PlaneView& view, Index first_face) {
    const Index facets_first = prepared_.facets_begin[view.plane];
    if (traces_.with_outlines[view.plane] == 0) {
      for (Index f = first_face; f < faces_.size(); ++f) {
        faces_[f].first_cover = static_cast<Index>(covers_.size());
        faces_[f].cover_count = 1;
        covers_.push_back(prepared_.facets_on[facets_first]);
      }
      return;
    }
    // Flood from the unbounded face (covered by nothing): crossing a facet's outline enters or leaves it.
    const std::size_t count = faces_.size() - first_face;
    std::vector<std::vector<Index>> covers(count + 1);  // [count] is the unbounded face
    std::vector<std::uint8_t> known(count + 1, 0);
    std::vector<std::vector<Index>> half_edges(count + 1);
    const auto local = [&](Index h) { return out_.face[h] == none ? count : out_.face[h] - first_face; };
    for (const Index use : view.uses) {
      half_edges[local(2 * use)].push_back(2 * use);
      half_edges[local(2 * use + 1)].push_back(2 * use + 1);
    }
    std::vector<std::size_t> queue{count};
    known[count] = 1;
    for (std::size_t at = 0; at < queue.size(); ++at) {
      const std::size_t face = queue[at];
      for (const Index h : half_edges[face]) {
        const std::size_t beyond = local(h ^ 1U);
        if (known[beyond] != 0) continue;
        known[beyond] = 1;
        std::vector<Index> set = covers[face];
        const Index use = h / 2;
        for (auto mark = std::ranges::lower_bound(graph_.outlines, use, {}, &OutlineMark::use);
             mark != graph_.outlines.end() && mark->use == use; ++mark) {
          // The half-edge's left is `face`; what the facet has on the forward half-edge's left is ours if h is the
          // forward one.
          const bool enters = mark->facet_on_left != (h == 2 * use);
          if (enters) {
            set.push_back(mark->facet);
          } else {
            std::erase(set, mark->facet);
          }
        }
        std::ranges::sort(set);
        const auto repeated = std::ranges::unique(set);
        set.erase(repeated.begin(), repeated.end());
        covers[beyond] = std::move(set);
        queue.push_back(beyond);
      }
    }
    for (std::size_t f = 0; f < count; ++f) {
      PlaneFace& face = faces_[first_face + f];
      face.first_cover = static_cast<Index>(covers_.size());
      face.cover_count = static_cast<Index>(covers[f].size());
      covers_.insert(covers_.end(), covers[f].begin(), covers[f].end());
    }
    for (const Index use : view.uses) {
      for (const Index h : {2 * use, 2 * use + 1}) {
        if (out_.face[h] != none && faces_[out_.face[h]].cover_count == 0) out_.face[h] = none;
      }
    }
  }

  const Prepared& prepared_;
  const Traces& traces_;
  const Graph& graph_;
  const std::vector<Vec>& positions_;
  Signs signs_;
  Arrangement& out_;  ///< of which half-edges and planes are filled in
  std::vector<Index>& loop_of_;
  /// Of a vertex: the first and the last of the plane's half-edges that start there, of those looked at.
  struct Around {
    Index first, last;
  };
  std::vector<Around> around_;  ///< none but of the vertices `reached_`
  std::vector<Index> reached_;
  std::vector<Loop> loops_;
  std::vector<PlaneFace> faces_;
  std::vector<Index> face_loops_, covers_;
};

/// Uses by plane (CSR).
struct PlaneUses {
  std::vector<Index> begin, uses;
  [[nodiscard]] PlaneView view(Index plane) const {
    return {plane, std::span{uses}.subspan(begin[plane], begin[plane + std::size_t{1}] - begin[plane])};
  }
};

PlaneUses uses_by_plane(const Prepared& prepared, const Graph& graph) {
  PlaneUses out{std::vector<Index>(prepared.facet_planes + std::size_t{1}, 0), std::vector<Index>(graph.uses.size())};
  for (const Use& use : graph.uses) ++out.begin[graph.slots[use.slot].plane + std::size_t{1}];
  begin_from_counts(out.begin);
  auto next = out.begin;
  for (Index u = 0; u < graph.uses.size(); ++u) out.uses[next[graph.slots[graph.uses[u].slot].plane]++] = u;
  return out;
}

}  // namespace

Arrangement arrange(const Prepared& prepared, const Traces& traces, const Graph& graph,
                    const std::vector<Vec>& positions, Signs& signs, ThreadLimit threads) {
  const PlaneUses planes = uses_by_plane(prepared, graph);
  const std::size_t half_edges = 2 * graph.uses.size();
  Arrangement out;
  out.next.assign(half_edges, none);
  out.start.assign(half_edges, none);
  out.rank.assign(graph.slots.size(), 0);
  out.face.assign(half_edges, none);
  out.half_turn.assign(prepared.facet_planes, 0);
  HalfEdges shared{out, std::vector<Index>(half_edges, none)};
  // Pieces hold equal numbers of uses, as far as whole planes allow. Faces are numbered within their piece first.
  const auto plane_at = [&](std::size_t use) {
    return static_cast<Index>(std::ranges::lower_bound(planes.begin, use) - planes.begin.begin());
  };
  auto parts = made_in_pieces(graph.uses.size(), threads, [&](std::size_t first, std::size_t last) {
    Arranger arranger{prepared, traces, graph, positions, signs, shared};
    for (Index plane = plane_at(first); plane < std::min(plane_at(last), prepared.facet_planes); ++plane) {
      const PlaneView view = planes.view(plane);
      if (!view.uses.empty()) arranger.in_plane(view);
    }
    return std::move(arranger).result();
  });
  using Part = Arranger::Result;
  for (const Part& part : parts) signs.add_counts(part.signs);
  const auto faces = offsets_of(parts, &Part::faces), loops = offsets_of(parts, &Part::loops),
             covers = offsets_of(parts, &Part::covers);
  parallel_for(parts.size(), threads, [&](std::size_t k) {
    if (faces[k] == 0) return;
    Index plane = none;
    for (const PlaneFace& face : parts[k].faces) {
      if (face.plane == plane) continue;
      plane = face.plane;
      for (const Index use : planes.view(plane).uses) {
        for (const Index h : {2 * use, 2 * use + 1}) {
          if (out.face[h] != none) out.face[h] += static_cast<Index>(faces[k]);
        }
      }
    }
  });
  out.faces = joined(parts, &Part::faces, threads, [&](PlaneFace& face, std::size_t k) {
    face.first_loop += static_cast<Index>(loops[k]);
    face.first_cover += static_cast<Index>(covers[k]);
  });
  out.loops = joined(parts, &Part::loops, threads, [](Index&, std::size_t) {});
  out.covers = joined(parts, &Part::covers, threads, [](Index&, std::size_t) {});
  return out;
}

}  // namespace cleave::topology::detail
