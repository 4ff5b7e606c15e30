#include "cleave/topology/cut.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "detail/assemble.hpp"
#include "detail/phases.hpp"
#include "detail/pieces.hpp"

namespace cleave::topology {

namespace {

NearMisses near_misses(const detail::Prepared& prepared, const detail::Gaps& gaps) {
  if (gaps.sides == 0) return prepared.open_rims;
  const detail::Facet *joint = &prepared.facets[gaps.first], *other = &prepared.facets[gaps.second];
  if (joint->owner != detail::Owner::joint) std::swap(joint, other);
  const bool both = other->owner == detail::Owner::joint;
  NearMisses found{gaps.sides, metres(gaps.largest * prepared.lattice.pitch() * 0x1p48), JointId{joint->owner_index},
                   both ? std::optional{JointId{other->owner_index}} : std::nullopt};
  if (prepared.open_rims.largest > found.largest) found = prepared.open_rims;
  found.sides = gaps.sides + prepared.open_rims.sides;
  return found;
}

/// What misses another joint by roundings, sorted.
std::vector<detail::Ending> endings_of(const detail::Gaps& gaps) {
  std::vector<detail::Ending> found = gaps.endings;
  std::ranges::sort(found);
  const auto again = std::ranges::unique(found);
  found.erase(again.begin(), again.end());
  return found;
}

}  // namespace

std::optional<CutError> refusal_of(const CutInput& input) {
  auto prepared = detail::prepare(input);
  return prepared ? std::nullopt : std::optional{std::move(prepared).error()};
}

std::expected<BlockComplex, CutError> cut(const CutInput& input, const CutOptions& options) {
  using namespace detail;
  const ThreadLimit threads{std::max(1U, options.threads)};
  CLEAVE_TRY(Prepared prepared, prepare(input));
  Signs signs{prepared};
  constexpr std::size_t limit = std::size_t{1} << 29U;
  Traces traces = find_traces(prepared, signs, threads);
  if (const std::vector<Ending> endings = endings_of(traces.gaps); !endings.empty()) {
    CLEAVE_TRY(prepared, prepare(input, endings));
    signs = Signs{prepared};
    traces = find_traces(prepared, signs, threads);
  }
  Graph graph = build_graph(prepared, traces, signs, threads);
  if (graph.uses.size() > limit) return std::unexpected(CutError{TooLarge{"edges"}});
  const std::vector<Vec> positions = positions_of(prepared, graph, threads);
  const Arrangement arrangement = arrange(prepared, traces, graph, positions, signs, threads);
  const auto intersections = static_cast<std::uint64_t>(
      std::ranges::count(traces.intervals, none, [](const Interval& interval) { return interval.outline_of; }));
  let_go(traces.lines);
  let_go(traces.intervals);
  graph.let_approximations_go();
  std::vector<FaceMeasure> measures = measure_faces(prepared, arrangement, positions, threads);
  Cells cells = find_cells(prepared, graph, arrangement, positions, measures, threads);
  BlockComplex::Packed packed = assemble(input, prepared, graph, arrangement, std::move(cells), positions,
                                         std::move(measures), threads, nullptr, &graph);
  BlockComplex::Data& data = packed.rest;
  if (data.blocks.empty()) return std::unexpected(CutError{DomainSwallowed{}});
  data.report.intersections = intersections;
  data.report.near_misses = near_misses(prepared, traces.gaps);
  data.report.predicate_calls = signs.calls();
  data.report.predicate_exact = signs.exact_calls();
  return BlockComplex{std::move(packed)};
}

}  // namespace cleave::topology
