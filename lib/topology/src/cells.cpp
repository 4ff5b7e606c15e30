#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "cleave/core/assert.hpp"
#include "cleave/core/disjoint_sets.hpp"
#include "detail/exact_volume.hpp"
#include "detail/nest_pieces.hpp"
#include "detail/phases.hpp"
#include "detail/pieces.hpp"

namespace cleave::topology::detail {
namespace {

class CellFinder {
 public:
  CellFinder(const Prepared& prepared, const Graph& graph, const Arrangement& arrangement,
             const std::vector<Vec>& positions, const std::vector<FaceMeasure>& measures, ThreadLimit threads)
      : prepared_{prepared},
        graph_{graph},
        arrangement_{arrangement},
        positions_{positions},
        measures_{measures},
        faces_{static_cast<Index>(arrangement.faces.size())},
        threads_{threads} {}

  Cells run() {
    find_shells();
    find_outsides();
    nest();
    return number_cells();
  }

 private:
  /// The unbounded outside of everything, as one more shell.
  [[nodiscard]] Index unbounded() const { return shell_count_; }
  [[nodiscard]] bool covered(Index f) const { return arrangement_.faces[f].cover_count != 0; }

  [[nodiscard]] const Vec& start_of(Index half_edge) const { return positions_[arrangement_.start[half_edge]]; }

  /// Numbers the shells in the order of their first half-faces.
  void find_shells() {
    std::vector<std::uint8_t> present(faces_);
    for (Index f = 0; f < faces_; ++f) present[f] = covered(f) ? 1 : 0;
    links_ = link_around_edges(graph_, arrangement_, present, threads_);
    DisjointSets<Index> half_faces{2 * std::size_t{faces_}};
    const auto half_face = [&](Index flank) { return 2 * arrangement_.face[flank / 2] + flank % 2; };
    const bool alone = threads_.count() == 1;
    in_pieces(links_.to.size(), 65536, threads_, [&](std::size_t first, std::size_t last) {
      for (auto flank = static_cast<Index>(first); flank < last; ++flank) {
        const Index other = links_.to[flank];
        if (other == none || other < flank) continue;
        if (alone) {
          half_faces.join(half_face(flank), half_face(other));
        } else {
          half_faces.join_shared(half_face(flank), half_face(other));
        }
      }
    });
    shell_of_.assign(2 * std::size_t{faces_}, none);
    in_pieces(shell_of_.size(), 65536, threads_, [&](std::size_t first, std::size_t last) {
      for (auto h = static_cast<Index>(first); h < last; ++h) {
        if (present[h / 2] != 0) shell_of_[h] = alone ? half_faces.find(h) : half_faces.find_shared(h);
      }
    });
    for (Index h = 0; h < 2 * faces_; ++h) {  // a root is the first of its shell
      if (shell_of_[h] != none) shell_of_[h] = shell_of_[h] == h ? shell_count_++ : shell_of_[shell_of_[h]];
    }
  }

  /// Of each connected piece the one shell that looks outwards: its volume is negative and the largest in size.
  void find_outsides() {
    std::vector<double> volume(shell_count_, 0);
    double area = 0;
    Cones cones{prepared_, arrangement_, positions_, measures_};
    DisjointSets<Index> connected{shell_count_};
    for (Index f = 0; f < faces_; ++f) {
      if (!covered(f)) continue;
      const double cone = cones.of(f);
      area += std::abs(measures_[f].area);
      const Index positive = shell_of_[2 * f], negative = shell_of_[2 * f + 1];
      volume[positive] -= cone;
      volume[negative] += cone;
      connected.join(positive, negative);
    }
    piece_of_shell_.assign(shell_count_, none);
    std::vector<std::uint8_t> several;
    for (Index shell = 0; shell < shell_count_; ++shell) {
      const Index root = connected.find(shell);
      if (root == shell) {
        piece_of_shell_[shell] = static_cast<Index>(outside_.size());
        outside_.push_back(shell);
        several.push_back(0);
        continue;
      }
      const Index piece = piece_of_shell_[shell] = piece_of_shell_[root];
      several[piece] = 1;
      if (volume[shell] < volume[outside_[piece]]) outside_[piece] = shell;
    }
    // Positions are good to 2^-43: so are the height of each face, and the area along its rim. No side is longer than 3
    // units: for large pieces that is enough to know.
    const auto unclear = [&](const auto& error) {
      std::vector<Index> pieces;
      for (Index piece = 0; piece < outside_.size(); ++piece) {
        if (several[piece] != 0 && volume[outside_[piece]] > -(error(outside_[piece]) * 0x1p-39))
          pieces.push_back(piece);
      }
      return pieces;
    };
    const double most = 1.001 * (area + 3 * static_cast<double>(arrangement_.next.size()));
    if (unclear([&](Index) { return most; }).empty()) return;
    const std::vector<double> error = errors();
    const std::vector<Index> pieces = unclear([&](Index shell) { return error[shell]; });
    if (!pieces.empty()) find_exactly(pieces, volume);
  }

  /// Of each shell: areas and perimeters of its faces.
  [[nodiscard]] std::vector<double> errors() const {
    std::vector<double> error(shell_count_, 0);
    for (Index f = 0; f < faces_; ++f) {
      if (!covered(f)) continue;
      const double size = std::abs(measures_[f].area) + perimeter_of(arrangement_, positions_, f);
      error[shell_of_[2 * f]] += size;
      error[shell_of_[2 * f + 1]] += size;
    }
    return error;
  }

  /// The outsides of pieces so thin that doubles do not tell, by integers; the likeliest shells are asked first.
  void find_exactly(const std::vector<Index>& pieces, const std::vector<double>& volume) {
    std::vector<Index> begin(shell_count_ + std::size_t{1}, 0);  // half-faces by shell (CSR)
    for (const Index shell : shell_of_) {
      if (shell != none) ++begin[shell + std::size_t{1}];
    }
    begin_from_counts(begin);
    std::vector<Index> half_faces(begin.back());
    auto next = begin;
    for (Index h = 0; h < shell_of_.size(); ++h) {
      if (shell_of_[h] != none) half_faces[next[shell_of_[h]]++] = h;
    }
    std::vector<std::vector<Index>> shells(outside_.size());
    for (Index shell = 0; shell < shell_count_; ++shell) shells[piece_of_shell_[shell]].push_back(shell);
    parallel_for(pieces.size(), threads_, [&](std::size_t k) {
      auto& own = shells[pieces[k]];
      std::ranges::stable_sort(own, {}, [&](Index shell) { return volume[shell]; });
      ExactMeasures exactly{prepared_, graph_, arrangement_};
      const auto looks_out = [&](Index shell) {
        const std::size_t count = begin[shell + std::size_t{1}] - begin[shell];
        const exact::Sign is_outside = exactly.sign(std::span{half_faces}.subspan(begin[shell], count));
        return is_outside == exact::Sign::negative;
      };
      const auto found = std::ranges::find_if(own, looks_out);
      // A flat piece: all its shells are empty, any will do.
      outside_[pieces[k]] = found != own.end() ? *found : std::ranges::min(own);
    });
  }

  // ---- which cell holds each connected piece -----------------------------------------------------------------------

  void nest() {
    beyond_.assign(outside_.size(), unbounded());
    if (outside_.size() == 1) return;
    std::vector<Index> piece_of_face(faces_, none);
    for (Index f = 0; f < faces_; ++f) {
      if (covered(f)) piece_of_face[f] = piece_of_shell_[shell_of_[2 * f]];
    }
    const std::vector<Index> faced =
        find_faced(prepared_, graph_, arrangement_, positions_, piece_of_face, outside_.size(), threads_);
    for (std::size_t piece = 0; piece < faced.size(); ++piece) {
      if (faced[piece] != none) beyond_[piece] = shell_of_[faced[piece]];
    }
  }

  // ---- numbering and what is rock -----------------------------------------------------------------------------------

  struct Regions {
    std::vector<Index> of_cell;
    std::vector<Index> walls;  ///< faces on a surface of a solid
  };
  [[nodiscard]] Regions regions_of(const Cells& cells) const {
    DisjointSets<Index> one{cells.count};
    struct Part {
      std::vector<Index> walls;
    };
    auto parts = made_in_pieces(faces_, threads_, [&](std::size_t first, std::size_t last) {
      Part part;
      for (auto f = static_cast<Index>(first); f < last; ++f) {
        const PlaneFace& face = arrangement_.faces[f];
        if (face.cover_count == 0) continue;
        bool wall = false;
        for (Index c = face.first_cover; c < face.first_cover + face.cover_count; ++c) {
          wall = wall || prepared_.facets[arrangement_.covers[c]].owner != Owner::joint;
        }
        if (wall) {
          part.walls.push_back(f);
        } else if (threads_.count() == 1) {
          one.join(cells.of_half_face[2 * f], cells.of_half_face[2 * f + 1]);
        } else {
          one.join_shared(cells.of_half_face[2 * f], cells.of_half_face[2 * f + 1]);
        }
      }
      return part;
    });
    Regions out{std::vector<Index>(cells.count), joined(parts, &Part::walls, threads_, [](Index&, std::size_t) {})};
    Index regions = 0;
    for (Index c = 0; c < cells.count; ++c) {
      const Index root = one.find(c);
      out.of_cell[c] = root == c ? regions++ : out.of_cell[root];
    }
    return out;
  }

  Cells number_cells() {
    DisjointSets<Index> joined{shell_count_ + std::size_t{1}};
    for (std::size_t piece = 0; piece < outside_.size(); ++piece) joined.join(outside_[piece], beyond_[piece]);
    Cells cells;
    std::vector<Index> number(shell_count_ + std::size_t{1}, none);
    number[joined.find(unbounded())] = 0;
    cells.count = 1;
    for (Index shell = 0; shell < shell_count_; ++shell) {
      const Index root = joined.find(shell);
      if (number[root] == none) number[root] = cells.count++;
      number[shell] = number[root];
    }
    cells.of_half_face = std::move(shell_of_);
    for (Index& cell : cells.of_half_face) {
      if (cell != none) cell = number[cell];
    }
    cells.links = std::move(links_);

    // Windings of the domain and the excavations, flooded from the outside. They change on surfaces of solids only, so
    // cells that nothing but joints part are one region.
    const auto [region, walls] = regions_of(cells);
    const Index regions = 1 + *std::ranges::max_element(region);
    std::vector<Index> begin(regions + std::size_t{2}, 0);  // half-faces of the walls by region (CSR)
    const auto region_of = [&](Index half_face) { return region[cells.of_half_face[half_face]]; };
    for (const Index f : walls) {
      for (const Index h : {2 * f, 2 * f + 1}) ++begin[region_of(h) + std::size_t{2}];
    }
    begin_from_counts(begin);
    std::vector<Index> half_faces(begin.back());
    for (const Index f : walls) {
      for (const Index h : {2 * f, 2 * f + 1}) half_faces[begin[region_of(h) + std::size_t{1}]++] = h;
    }
    // Solid 0 is the domain, then come the excavations, then the window.
    const std::size_t excavations = prepared_.excavation_count;
    const std::size_t solids = 2 + excavations;
    std::vector<std::int32_t> winding(regions * solids, 0);
    std::vector<std::uint8_t> known(regions, 0);
    std::vector<Index> queue{region[0]};
    known[region[0]] = 1;
    for (std::size_t at = 0; at < queue.size(); ++at) {
      const Index here = queue[at];
      for (Index k = begin[here]; k < begin[here + std::size_t{1}]; ++k) {
        const Index f = half_faces[k] / 2;
        const bool here_positive = half_faces[k] % 2 == 0;
        const Index beyond = region_of(half_faces[k] ^ 1U);
        if (known[beyond] != 0) continue;
        known[beyond] = 1;
        for (std::size_t s = 0; s < solids; ++s) winding[beyond * solids + s] = winding[here * solids + s];
        const PlaneFace& face = arrangement_.faces[f];
        for (Index c = face.first_cover; c < face.first_cover + face.cover_count; ++c) {
          const Facet& facet = prepared_.facets[arrangement_.covers[c]];
          if (facet.owner == Owner::joint) continue;
          const std::size_t solid = facet.owner == Owner::domain       ? 0
                                    : facet.owner == Owner::excavation ? 1 + std::size_t{facet.owner_index}
                                                                       : 1 + excavations;
          winding[beyond * solids + solid] += facet.outward_positive == here_positive ? 1 : -1;
        }
        queue.push_back(beyond);
      }
    }
    cells.rock.assign(cells.count, 0);
    cells.in_domain.assign(cells.count, 0);
    cells.excavated_by.reserve(cells.count * (solids - 1));
    for (Index c = 0; c < cells.count; ++c) {
      const std::size_t first = region[c] * solids;
      CLEAVE_ASSERT(known[region[c]] != 0);
      const bool seen = !prepared_.windowed || winding[first + 1 + excavations] > 0;
      const bool in_domain = winding[first] > 0;
      cells.in_domain[c] = (prepared_.windowed ? seen : in_domain) ? 1 : 0;
      bool excavated = false;
      for (std::size_t s = 1; s <= excavations; ++s) {
        const bool inside = winding[first + s] > 0;
        cells.excavated_by.push_back(inside ? 1 : 0);
        excavated = excavated || inside;
      }
      cells.rock[c] = seen && in_domain && !excavated ? 1 : 0;
    }
    return cells;
  }

  const Prepared& prepared_;
  const Graph& graph_;
  const Arrangement& arrangement_;
  const std::vector<Vec>& positions_;
  const std::vector<FaceMeasure>& measures_;
  Index faces_;
  ThreadLimit threads_;
  Links links_;
  Index shell_count_ = 0;
  std::vector<Index> shell_of_;  ///< of each half-face
  std::vector<Index> piece_of_shell_;
  std::vector<Index> outside_;  ///< of each connected piece: the shell that looks outwards
  std::vector<Index> beyond_;   ///< of each connected piece: the shell of another piece that it faces, or unbounded()
};

}  // namespace

Cells find_cells(const Prepared& prepared, const Graph& graph, const Arrangement& arrangement,
                 const std::vector<Vec>& positions, const std::vector<FaceMeasure>& measures, ThreadLimit threads) {
  return CellFinder{prepared, graph, arrangement, positions, measures, threads}.run();
}

}  // namespace cleave::topology::detail
