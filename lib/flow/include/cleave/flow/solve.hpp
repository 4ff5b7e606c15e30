#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cleave/flow/network.hpp"

namespace cleave::flow {

/// m3/s, with bounds that hold for the exact solution of the same network, up to rounding.
struct Rate {
  double value = 0, low = 0, high = 0;
};

/// What passes a surface.
struct SurfaceFlow {
  double out = 0;  ///< m3/s, out of the rock; below 0: into it
  /// Bounds of it; none where the surface touches another one that water passes: what is near the line between the two
  /// cannot be told apart within bounds, only what passes all of them.
  std::optional<Rate> bounds = {};
  double open_length = 0, dry_length = 0;  ///< m of borders of wet joints: where water passes, and where none does
};

struct FlowOptions {
  /// The mesh is refined until the half widths of the rates out of drained surfaces (of standing water, where nothing
  /// is drained) add up to no more than this share of the rates.
  double tolerance = 0.02;
  std::size_t most_triangles = 1'000'000;
};

/// Different heads stand side by side: the rate between them has no bound. One of the two surfaces ends there, or is
/// closed.
struct HeadsMeet {
  std::uint32_t surface, other;
  geometry::Vec3 at;  ///< m
  double head, other_head;
};
struct BadOption {
  std::string which;
};
/// The equations could not be factored.
struct NotSolved {};
using FlowError = std::variant<HeadsMeet, BadOption, NotSolved>;
[[nodiscard]] std::string describe(const FlowError& error);

enum class FlowStatus : std::uint8_t {
  converged,
  too_many_triangles,  ///< the bounds are wider than was asked for
  unsettled,           ///< which parts of drained surfaces water comes out of was not settled
};

/// One mesh of the series.
struct FlowRound {
  std::size_t triangles = 0;
  double width = 0;  ///< relative, as FlowOptions::tolerance is meant
};

/// Two solutions on one mesh: heads that are continuous (linear in triangles), and rates that are balanced to the last
/// (linear, continuous in the middle of sides: Crouzeix and Raviart 1973; their gradients are the rates of the lowest
/// mixed elements, Marini 1985). The one has too much energy and the other too little (Prager and Synge 1947), so that
/// rates through surfaces have bounds from both.
struct Flow {
  Mesh mesh = {};                                ///< refined; parts and surfaces as in the network
  std::vector<std::uint8_t> wet = {};            ///< of each triangle: a surface where water stands reaches it
  std::vector<std::array<double, 3>> head = {};  ///< m, at the corners of each triangle; 0 where it is not wet
  std::vector<geometry::Vec3> q = {};  ///< m2/s, of each triangle: rate across a unit width of joint; 0 where not wet
  std::vector<SurfaceFlow> surfaces = {};
  std::vector<double> out_of_border = {};              ///< m3/s, of each of the mesh's borders
  std::vector<std::uint32_t> triangle_of_border = {};  ///< one that lies there
  Rate drained = {};                                   ///< out of all drained surfaces
  double wet_area = 0, area = 0;                       ///< m2 of joints
  double residual = 0;                                 ///< of the equations, relative, the largest
  double imbalance = 0;                                ///< of all rates, of the sum of their sizes
  std::vector<FlowRound> rounds = {};
  FlowStatus status = FlowStatus::converged;
};

/// Error: rates of the lowest order with meshes that follow the error; the width of the bounds falls like one over the
/// number of triangles, whatever the shape of the network.
[[nodiscard]] std::expected<Flow, FlowError> solve(const Network& network, const FlowOptions& options = {});

}  // namespace cleave::flow
