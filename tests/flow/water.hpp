#pragma once

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "cleave/flow/flow.hpp"
#include "complexes.hpp"

// Networks of cut joints with water at their sides.

namespace cleave::testing {

using flow::Closed;
using flow::Drained;
using flow::Flow;
using flow::FlowStatus;
using flow::Standing;

/// Sides of make_box by their tags.
enum Tag : std::uint32_t { west, east, south, north, bottom, top };

inline Standing at(double level) { return {metres(level)}; }

struct Water {
  std::map<std::uint32_t, flow::Surface> sides = {};  ///< by tag; others are closed
  flow::Surface excavation = Drained{};
  std::vector<double> transmissivity = {};  ///< of joints by number; 1e-6 m2/s where there is none
};

struct Built {
  flow::Network network;
  flow::JointSurfaces surfaces;
  topology::BlockComplex complex;

  [[nodiscard]] std::size_t of_tag(std::uint32_t tag) const {
    for (std::size_t s = 0; s < surfaces.surfaces.size(); ++s) {
      if (surfaces.surfaces[s].tag == tag) return s;
    }
    throw std::runtime_error{"no joint reaches that side"};
  }
  [[nodiscard]] std::size_t of_excavation(std::uint32_t excavation) const {
    for (std::size_t s = 0; s < surfaces.surfaces.size(); ++s) {
      if (surfaces.surfaces[s].excavation == excavation) return s;
    }
    throw std::runtime_error{"no joint reaches that excavation"};
  }
};

inline Built build(topology::CutInput input, const Water& water) {
  input.keep_network = true;
  auto complex = certified(input).complex();
  const double up = complex.origin().z;
  flow::JointSurfaces surfaces = flow::surfaces_of(*complex.network());
  std::vector<flow::Surface> conditions;
  for (const auto& surface : surfaces.surfaces) {
    const auto given = surface.tag ? water.sides.find(*surface.tag) : water.sides.end();
    flow::Surface condition = surface.excavation           ? water.excavation
                              : given != water.sides.end() ? given->second
                                                           : flow::Surface{Closed{}};
    if (auto* standing = std::get_if<Standing>(&condition)) standing->level = standing->level - metres(up);
    conditions.push_back(condition);
  }
  if (const auto settled = flow::settle_edges(complex, conditions, surfaces); !settled) throw settled.error();
  flow::NetworkSpec spec{.mesh = flow::mesh_of(complex, surfaces)};
  for (const auto& piece : complex.network()->pieces) {
    double sum = 0;
    for (const auto joint : piece.joints) {
      sum += joint.index() < water.transmissivity.size() ? water.transmissivity[joint.index()] : 1e-6;
    }
    spec.transmissivity.push_back(Transmissivity::from_si(sum));
  }
  spec.surfaces = std::move(conditions);
  auto network = flow::Network::make(std::move(spec));
  if (!network) throw std::runtime_error{describe(network.error())};
  return {*std::move(network), std::move(surfaces), std::move(complex)};
}

inline Flow solved(const flow::Network& network, double tolerance = 0.01) {
  auto flow = flow::solve(network, {.tolerance = tolerance});
  if (!flow) throw std::runtime_error{describe(flow.error())};
  EXPECT_LT(flow->residual, 1e-12);
  EXPECT_LT(flow->imbalance, 1e-9);
  return *std::move(flow);
}

/// An upright joint 10 m wide and 10 m high of two triangles: water stands in the west, the east side is drained.
inline flow::Network seeping(double level) {
  flow::NetworkSpec spec;
  spec.mesh = {.points = {{0, 0, 0}, {10, 0, 0}, {10, 0, 10}, {0, 0, 10}},
               .triangles = {{0, 1, 2}, {0, 2, 3}},
               .part = {0, 0},
               .borders = {{{1, 2}, 0}, {{3, 0}, 1}}};
  spec.transmissivity = {Transmissivity::from_si(1)};
  spec.surfaces = {Drained{}, at(level)};
  return flow::Network::make(std::move(spec)).value();
}

inline geometry::Solid room() { return box({0, 0, 0}, {4, 3, 2}); }

}  // namespace cleave::testing
