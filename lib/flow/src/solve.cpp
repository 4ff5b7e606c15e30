#include "cleave/flow/flow.hpp"

#include <cmath>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "level.hpp"

namespace cleave::flow {
namespace {

std::vector<std::uint8_t> open_at_first(const Mesh& mesh, const Network& network) {
  std::vector<std::uint8_t> open;
  for (const Border& border : mesh.borders) {
    const double z = 0.5 * (mesh.points[border.ends[0]].z + mesh.points[border.ends[1]].z);
    open.push_back(std::visit(overloaded{[](const Closed&) { return 0; }, [](const Drained&) { return 1; },
                                         [&](const Standing& s) { return z <= s.level.si() ? 1 : 0; }},
                              network.surfaces()[border.surface]) != 0
                       ? 1
                       : 0);
  }
  return open;
}

}  // namespace

std::expected<Flow, FlowError> solve(const Network& network, const FlowOptions& options) {
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance)) {
    return std::unexpected(FlowError{BadOption{"the tolerance is not above 0"}});
  }
  Mesh mesh = network.mesh();
  split_at_levels(mesh, network.surfaces());
  flip_sides(mesh);
  std::vector<std::uint8_t> open = open_at_first(mesh, network);
  std::vector<FlowRound> rounds;
  for (;;) {
    Level level{mesh, network, open};
    CLEAVE_CHECK(level.settle());
    CLEAVE_CHECK(level.bound());
    const auto wanted = level.groups(level.drains());
    FlowRound& round = rounds.emplace_back(FlowRound{.triangles = mesh.triangles.size()});
    std::vector<std::uint8_t> marked(mesh.triangles.size(), 0);
    round.width = level.width_of(wanted);
    if (options.pressures) round.pressures = level.gap_of_pressures(options.tolerance, marked);
    const bool last = mesh.triangles.size() >= options.most_triangles;
    // Bounds for drained surfaces cost two more solutions: not before what is cheaper is good.
    const bool near = round.width <= options.tolerance && round.pressures <= options.tolerance;
    bool bounded = !level.drains();
    const auto bound_above = [&]() -> std::expected<void, FlowError> {
      if (std::exchange(bounded, true)) return {};
      CLEAVE_CHECK(level.bound_above());
      round.width = std::max(round.width, level.width_of_drained());
      return {};
    };
    if (near || last) CLEAVE_CHECK(bound_above());
    if (round.width > options.tolerance) level.mark_worst(wanted, marked);
    const bool good = round.width <= options.tolerance && round.pressures <= options.tolerance;
    if (good || last || std::ranges::find(marked, 1) == marked.end()) {
      CLEAVE_CHECK(bound_above());
      Flow flow = level.result();
      flow.rounds = std::move(rounds);
      flow.status = !good             ? FlowStatus::too_many_triangles
                    : level.settled() ? FlowStatus::converged
                                      : FlowStatus::unsettled;
      return flow;
    }
    open = level.open();
    refine(mesh, marked, open);
  }
}

std::expected<Flow, FlowError> solve_for_two_points(const Network& network, const Flow& flow,
                                                    std::size_t most_triangles) {
  Mesh mesh = flow.mesh;
  std::vector<std::uint8_t> open = flow.open;
  make_two_point(mesh, network, open, most_triangles);
  Level level{mesh, network, open};
  CLEAVE_CHECK(level.settle_continuous());
  return level.heads();
}

std::string describe(const FlowError& error) {
  const auto number = [](double value) { return std::to_string(value); };
  return std::visit(overloaded{[&](const HeadsMeet& e) {
                                 return "heads of " + number(e.head) + " and " + number(e.other_head) +
                                        " m stand side by side at (" + number(e.at.x) + ", " + number(e.at.y) + ", " +
                                        number(e.at.z) +
                                        "), which lets any amount of water through; close one of the two surfaces";
                               },
                               [](const BadOption& e) { return e.which; },
                               [](const NotSolved&) { return std::string{"the equations could not be solved"}; }},
                    error);
}

}  // namespace cleave::flow
