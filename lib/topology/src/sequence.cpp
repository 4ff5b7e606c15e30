#include "cleave/topology/sequence.hpp"

#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/disjoint_sets.hpp"
#include "cleave/core/expected.hpp"
#include "detail/assemble.hpp"
#include "detail/phases.hpp"

namespace cleave::topology {

using namespace detail;

struct SequentialCut::Parts {
  CutInput input;
  Prepared prepared;
  Graph graph;
  std::vector<Vec> positions;
  Arrangement arrangement;
  std::vector<FaceMeasure> measures;
  Cells cells;
  std::uint64_t predicate_calls, predicate_exact;
};

SequentialCut::SequentialCut(std::unique_ptr<const Parts> parts) : parts_{std::move(parts)} {}
SequentialCut::SequentialCut(SequentialCut&&) noexcept = default;
SequentialCut& SequentialCut::operator=(SequentialCut&&) noexcept = default;
SequentialCut::~SequentialCut() = default;

std::expected<SequentialCut, CutError> SequentialCut::make(CutInput input, const CutOptions& options) {
  const ThreadLimit threads{std::max(1U, options.threads)};
  CLEAVE_TRY(Prepared prepared, prepare(input));
  Signs signs{prepared};
  const Traces traces = find_traces(prepared, signs, threads);
  Graph graph = build_graph(prepared, traces, signs, threads);
  if (graph.uses.size() > (std::size_t{1} << 29U)) return std::unexpected(CutError{TooLarge{"edges"}});
  std::vector<Vec> positions = positions_of(prepared, graph, threads);
  Arrangement arrangement = arrange(prepared, traces, graph, positions, signs, threads);
  graph.let_approximations_go();
  std::vector<FaceMeasure> measures = measure_faces(prepared, arrangement, positions, threads);
  Cells cells = find_cells(prepared, graph, arrangement, positions, measures, threads);
  cells.links = {};  // the blocks of each stage make their own
  return SequentialCut{std::make_unique<const Parts>(
      Parts{std::move(input), std::move(prepared), std::move(graph), std::move(positions), std::move(arrangement),
            std::move(measures), std::move(cells), signs.calls(), signs.exact_calls()})};
}

std::size_t SequentialCut::cells() const noexcept { return parts_->cells.count; }

std::expected<StageBlocks, CutError> SequentialCut::blocks(const WorkState& state) const {
  const auto& [input, prepared, graph, positions, arrangement, measures, cells, calls, exact] = *parts_;
  CLEAVE_ASSERT(state.excavated.size() == prepared.excavation_count);
  std::vector<std::uint8_t> rock(cells.count, 0);
  for (Index c = 0; c < cells.count; ++c) {
    bool out = cells.in_domain[c] == 0;
    for (std::size_t e = 0; e < state.excavated.size(); ++e) {
      out = out || (state.excavated[e] != 0 && cells.excavated_by[c * state.excavated.size() + e] != 0);
    }
    rock[c] = out ? 0 : 1;
  }
  for (const CellId cell : state.fallen) rock[cell.index()] = 0;

  // Rock on both sides of a face without a joint is one block.
  DisjointSets<Index> whole{cells.count};
  for (Index f = 0; f < arrangement.faces.size(); ++f) {
    const Index a = cells.of_half_face[2 * f], b = cells.of_half_face[2 * f + 1];
    if (a == none || b == none || a == b || rock[a] == 0 || rock[b] == 0) continue;
    const PlaneFace& face = arrangement.faces[f];
    bool joint = false;
    for (Index c = face.first_cover; c < face.first_cover + face.cover_count; ++c) {
      joint = joint || prepared.facets[arrangement.covers[c]].owner == Owner::joint;
    }
    if (!joint) whole.join(a, b);
  }
  Cells now;
  std::vector<Index> number(cells.count, none);
  for (Index c = 0; c < cells.count; ++c) {
    const Index root = whole.find(c);
    if (number[root] == none) {
      number[root] = now.count++;
      now.rock.push_back(rock[c]);
      now.in_domain.push_back(cells.in_domain[c]);
      for (std::size_t e = 0; e < state.excavated.size(); ++e) {
        now.excavated_by.push_back(cells.excavated_by[c * state.excavated.size() + e]);
      }
    }
    number[c] = number[root];
  }
  now.of_half_face.reserve(cells.of_half_face.size());
  for (const Index cell : cells.of_half_face) now.of_half_face.push_back(cell == none ? none : number[cell]);

  BlockComplex::Packed packed =
      assemble(input, prepared, graph, arrangement, now, positions, measures, ThreadLimit::one(), &state.excavated);
  BlockComplex::Data& data = packed.rest;
  if (data.blocks.empty()) return std::unexpected(CutError{DomainSwallowed{}});
  data.report.predicate_calls = calls;
  data.report.predicate_exact = exact;
  // Blocks are numbered in the order of their (merged) cells.
  std::vector<Index> block_of(now.count, none);
  Index blocks = 0;
  for (Index c = 0; c < now.count; ++c) {
    if (now.rock[c] != 0) block_of[c] = blocks++;
  }
  CLEAVE_ASSERT(blocks == data.blocks.size());
  StageBlocks result{BlockComplex{std::move(packed)}, {}};
  result.block_of_cell.reserve(cells.count);
  for (Index c = 0; c < cells.count; ++c) {
    const Index b = block_of[number[c]];
    result.block_of_cell.push_back(b == none ? std::nullopt : std::optional{BlockId{b}});
  }
  return result;
}

}  // namespace cleave::topology
