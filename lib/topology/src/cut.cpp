#include "cleave/topology/cut.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "detail/assemble.hpp"
#include "detail/stages.hpp"

namespace cleave::topology {

std::string describe(const CutError& error) {
  return std::visit(
      overloaded{
          [](const JointCollapsed& e) {
            return fmt::format(
                "joint {} is too small for this scene: its corners fall on one line of the lattice of {} m; leave "
                "it out or cut a smaller domain",
                e.joint.value(), e.pitch.si());
          },
          [](const SolidCollapsed& e) {
            const std::string what =
                e.excavation ? fmt::format("excavation {}", *e.excavation) : std::string{"the domain"};
            return fmt::format(
                "face {} of {} is too small or too bent for the lattice of {} m; merge its corners or give it as "
                "triangles",
                e.face, what, e.pitch.si());
          },
          [](const TerminationUndecided& e) {
            return fmt::format(
                "joint {} ends on joint {}, but which part of it is meant is not clear: its middle lies on that "
                "joint's "
                "plane, or that joint is not flat; end it on another joint or move its middle",
                e.joint.value(), e.at.value());
          },
          [](const DomainSwallowed&) {
            return std::string{
                "the excavations leave no rock of the domain; make the domain larger or an excavation smaller"};
          },
          [](const WindowOutside&) {
            return std::string{"the window misses the domain; give one that has a part of the domain in it"};
          },
          [](const TooLarge& e) {
            return fmt::format("the scene has more than 2^31 {}; split it or use fewer joints", e.what);
          },
          [](const NotFinite& e) {
            return fmt::format("{}{} is not a finite number; give one",
                               e.joint ? fmt::format("joint {}: ", e.joint->value()) : std::string{}, e.what);
          },
          [](const SnapNegative& e) { return fmt::format("snap is {} m; give 0 or more", e.snap.si()); },
          [](const UnknownTag& e) {
            return fmt::format("side {} is to be free, but the domain has no such side; give one that it has", e.tag);
          },
          [](const UnknownJoint& e) {
            return fmt::format("a termination names joint {}, but there is no such joint", e.joint.value());
          },
      },
      error);
}

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

}  // namespace

std::expected<BlockComplex, CutError> cut(const CutInput& input, const CutOptions& options) {
  using namespace detail;
  const ThreadLimit threads{std::max(1U, options.threads)};
  CLEAVE_TRY(const Prepared prepared, prepare(input));
  Signs signs{prepared};
  constexpr std::size_t limit = std::size_t{1} << 29U;
  const Traces traces = find_traces(prepared, signs, threads);
  const Graph graph = build_graph(prepared, traces, signs, threads);
  if (graph.uses.size() > limit) return std::unexpected(CutError{TooLarge{"edges"}});
  const std::vector<Vec> positions = positions_of(prepared, graph, threads);
  const Arrangement arrangement = arrange(prepared, traces, graph, positions, signs, threads);
  const std::vector<FaceMeasure> measures = measure_faces(prepared, arrangement, positions, threads);
  Cells cells = find_cells(prepared, graph, arrangement, positions, measures, threads);
  BlockComplex::Data data =
      assemble(input, prepared, graph, arrangement, std::move(cells), positions, measures, threads, nullptr);
  if (data.blocks.empty()) return std::unexpected(CutError{DomainSwallowed{}});
  data.report.intersections = static_cast<std::uint64_t>(
      std::ranges::count(traces.intervals, none, [](const Interval& interval) { return interval.outline_of; }));
  data.report.near_misses = near_misses(prepared, traces.gaps);
  data.report.predicate_calls = signs.calls();
  data.report.predicate_exact = signs.exact_calls();
  return BlockComplex{std::move(data)};
}

}  // namespace cleave::topology
