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
    CLEAVE_TRY(const bool settled, level.settle());
    CLEAVE_CHECK(level.bound());
    auto wanted = level.groups(true);
    if (wanted.empty()) wanted = level.groups(false);
    const double width = level.width_of(wanted);
    rounds.push_back({mesh.triangles.size(), width});
    const bool good = width <= options.tolerance;
    const std::vector<std::uint8_t> marked = level.worst(wanted);
    const bool finer = std::ranges::find(marked, 1) != marked.end();
    if (good || !finer || mesh.triangles.size() >= options.most_triangles) {
      Flow flow = level.result();
      flow.rounds = std::move(rounds);
      flow.status = !good ? FlowStatus::too_many_triangles : settled ? FlowStatus::converged : FlowStatus::unsettled;
      return flow;
    }
    open = level.open();
    refine(mesh, marked, open);
  }
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
