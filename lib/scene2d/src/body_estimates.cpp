#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "body_runs.hpp"

namespace cleave::scene {

using bem::Vec2;

bem::Sym2 in_world(bem::Sym2 own, double angle) {
  const double c = std::cos(angle), d = std::sin(angle);
  return {c * c * own.xx - 2 * c * d * own.xy + d * d * own.yy, c * d * (own.xx - own.yy) + (c * c - d * d) * own.xy,
          d * d * own.xx + 2 * c * d * own.xy + c * c * own.yy};
}

double von_mises(bem::Sym2 v, double z) {
  const double squares = std::pow(v.xx - v.yy, 2) + std::pow(v.yy - z, 2) + std::pow(z - v.xx, 2);
  return std::sqrt(0.5 * squares + 3 * v.xy * v.xy);
}

std::array<double, 3> principal(bem::Sym2 v, double z) {
  const double mean = 0.5 * (v.xx + v.yy), radius = std::hypot(0.5 * (v.xx - v.yy), v.xy);
  std::array<double, 3> out{mean + radius, mean - radius, z};
  std::ranges::sort(out, std::greater{});
  return out;
}

namespace {

/// What changes are thought to fall by beyond those that are known, from what they fell by.
double share_to_come(double ratio, Course course) {
  constexpr double doubtful = 0.4;  // moving: faster is chance
  if (course == Course::moving) return std::max(ratio, doubtful);
  // At rest the order shows, but on coarse meshes not yet: half as much again, no faster than a third order and, where
  // the meshes are surely too coarse to tell, as was seen.
  constexpr double margin = 1.5, third_order = 0.125, coarse = 0.3, no_order = 0.6;
  if (course == Course::at_rest_coarse) return std::max(no_order, ratio);
  return std::max({third_order, ratio, std::min(margin * ratio, coarse)});
}

}  // namespace

ErrorEstimate estimate_from(double first_change, double last_change, Course course) {
  constexpr double rounding = 1e-8;  // below it changes are no series
  constexpr double too_much = 0.3;
  constexpr double slowest = 0.85;  // ratio of a series that is believed
  if (!std::isfinite(first_change) || !std::isfinite(last_change))
    return {std::nullopt, "the coarser runs differ without bound"};
  if (last_change <= rounding) return {std::max(first_change * 0.01, last_change), ""};
  const double ratio = first_change > 0 ? last_change / first_change : 1.0;
  if (ratio > slowest) {
    return {std::nullopt, fmt::format("half the fineness changes it by {:.2g}, a quarter by {:.2g} more: this does not "
                                      "fall as in a series",
                                      last_change, first_change)};
  }
  const double share = share_to_come(ratio, course);
  const double error = last_change * share / (1 - share);
  if (error > too_much) {
    return {std::nullopt,
            fmt::format("half the fineness changes it by {:.2g}: too coarse for an estimate", last_change)};
  }
  return {error, ""};
}

std::vector<double> frequencies_of(const bem::Modes& modes, std::size_t count) {
  std::vector<double> out;
  for (const double value : modes.eigenvalues) {
    if (out.size() == count) break;
    if (value > 0) out.push_back(std::sqrt(value) / (2 * std::numbers::pi));
  }
  return out;
}

NodeSupports supports_of(const bem::BlockOperator& block, const BodySpec& spec) {
  const bem::Mesh& mesh = block.mesh();
  NodeSupports out;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    for (const bem::Use& use : mesh.nodes[n].uses) {
      const bem::Element& e = mesh.elements[use.element];
      const bem::Condition& c = spec.region.conditions[spec.region.loops[e.loop][e.side].condition];
      const Vec2 normal = e.normal(bem::local_nodes(mesh.order)[use.local]);
      const auto axes = c.axes == bem::Axes::normal
                            ? std::array{rotated(normal, c.turn), rotated(turned_left(normal), c.turn)}
                            : std::array{rotated({1, 0}, c.turn), rotated({0, 1}, c.turn)};
      for (std::size_t k = 0; k < 2; ++k) {
        if (c.component[k].given == bem::Given::displacement) out.held.push_back({n, axes[k]});
        if (c.component[k].given == bem::Given::spring) {
          // Lumped by the node's share of the element.
          const double share = mesh.order == bem::Order::quadratic ? (use.local == 1 ? 2.0 / 3 : 1.0 / 6) : 0.5;
          out.springs.push_back({n, axes[k], c.component[k].stiffness * share * 2 * norm(e.c1)});
        }
      }
    }
  }
  return out;
}

}  // namespace cleave::scene
