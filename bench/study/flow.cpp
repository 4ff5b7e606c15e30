/// Study "flow": rates through networks of joints, error against time. Problems: a square of side 2 in one of side 4
/// (the square coaxial line of ratio 2, 36.81 ohm: sharp corners); random discs with a chamber between two sides where
/// water stands, transmissivities a hundred apart (against a tenth of the least tolerance). Method: meshes that follow
/// the error (`adaptive`). `error` is that of the value in the middle of the bounds; `condition` the relative half
/// width of the bounds, which must not be smaller than the error.

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cleave/flow/flow.hpp"
#include "cleave/topology/cut.hpp"
#include "study.hpp"
#include "workloads.hpp"

namespace cleave {
namespace {

/// Water stands at 1000 m on the first `open` sides of the domain; excavations are drained, and joints have one of
/// `kinds` transmissivities, each ten times the one before.
flow::Network network_of(topology::CutInput input, std::uint32_t open, std::size_t kinds) {
  input.keep_network = true;
  const topology::BlockComplex complex = topology::cut(input).value();
  const flow::JointSurfaces surfaces = flow::surfaces_of(*complex.network());
  flow::NetworkSpec spec{.mesh = flow::mesh_of(complex, surfaces), .transmissivity = {}, .surfaces = {}};
  for (const topology::JointPiece& piece : complex.network()->pieces) {
    const double power = static_cast<double>(piece.joints.front().index() * 7 % kinds);
    spec.transmissivity.push_back(Transmissivity::from_si(std::pow(10.0, power)));
  }
  for (const flow::RockSurface& surface : surfaces.surfaces) {
    spec.surfaces.push_back(surface.excavation               ? flow::Surface{flow::Drained{}}
                            : surface.tag.value_or(0) < open ? flow::Surface{flow::Standing{metres(1000)}}
                                                             : flow::Surface{flow::Closed{}});
  }
  return flow::Network::make(std::move(spec)).value();
}

flow::Network square_in_square() {
  topology::CutInput input{.domain = geometry::make_box({-2, -2, -1}, {2, 2, 1}).value()};
  input.joints.emplace_back(
      topology::Joint{{geometry::Polygon::make({{-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0}}).value()}});
  input.excavations.push_back(geometry::make_box({-1, -1, -0.5}, {1, 1, 0.5}).value());
  return network_of(std::move(input), 4, 1);
}

flow::Network discs(std::uint32_t count) {
  auto input = support::cut_input(support::workload_named(fmt::format("disc-{}", count)).value());
  input.excavations.push_back(geometry::make_box({38, 20, 42}, {62, 80, 58}).value());
  return network_of(std::move(input), 2, 3);
}

struct Problem {
  std::string name;
  flow::Network network;
  std::optional<double> exact;
};

void add_rows(study::Study& study, Problem problem, const std::vector<double>& tolerances,
              std::vector<study::Series>& series) {
  if (!problem.exact) {
    const auto fine = flow::solve(problem.network, {.tolerance = tolerances.back() / (study.quick() ? 3 : 10)});
    problem.exact = fine->drained.value;
  }
  const double exact = *problem.exact;
  study::Series points{.name = problem.name, .points = {}, .line = true, .fit = false};
  for (const double tolerance : tolerances) {
    flow::Flow found;
    const auto cost = study.measure([&] { found = flow::solve(problem.network, {.tolerance = tolerance}).value(); });
    const double error = std::abs(found.drained.value - exact) / exact;
    const double half = 0.5 * (found.drained.high - found.drained.low) / exact;
    const bool holds = error <= half * (1 + 1e-9) && found.status == flow::FlowStatus::converged;
    study.add({.problem = problem.name,
               .method = "adaptive",
               .setting = fmt::format("tolerance={} triangles={} rounds={}", tolerance, found.mesh.triangles.size(),
                                      found.rounds.size()),
               .error = error,
               .cost = cost,
               .condition = half,
               .status = holds ? study::Status::converged : study::Status::stopped});
    if (!holds) study.broken(fmt::format("{}: the bounds at {} do not hold the rate", problem.name, tolerance));
    points.points.emplace_back(cost.cpu_s, half);
  }
  series.push_back(std::move(points));
}

void study_flow(study::Study& study) {
  const std::vector<double> tolerances =
      study.quick() ? std::vector<double>{0.1, 0.03} : std::vector<double>{0.1, 0.03, 0.01, 3e-3, 1e-3};
  const std::vector<double> rough = study.quick() ? std::vector<double>{0.5} : std::vector<double>{0.3, 0.1, 0.05};
  std::vector<study::Series> series;
  add_rows(study, {"square_in_square", square_in_square(), 10.234092569 * 1000}, tolerances, series);
  for (const std::uint32_t count :
       study.quick() ? std::vector<std::uint32_t>{1500} : std::vector<std::uint32_t>{2000, 5000}) {
    add_rows(study, {fmt::format("disc-{}", count), discs(count), std::nullopt}, rough, series);
  }
  study.plot("bounds", {.title = "half width of the bounds against time",
                        .x_label = "processor time (s)",
                        .y_label = "half width (relative)",
                        .series = std::move(series)});
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("flow", argc, argv, cleave::study_flow); }
