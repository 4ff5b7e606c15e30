#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "closed_sets.hpp"

namespace cleave::support {

/// Polygons of a closed set as joints in a cube about the placed origin, and what must come out.
struct ClosedTrial {
  std::vector<Corners> polygons;
  Placement at;
  double half = 1.2;  ///< of the cube, before scaling
  std::size_t expected = 0;
  double snap = 0;      ///< m
  bool convex = false;  ///< all blocks but one are
};

/// What is wrong with the blocks and their certificate, in words; empty when nothing is. None where the corners are no
/// polygons: too close together, or off one plane.
[[nodiscard]] std::optional<std::string> fault_of(const ClosedTrial& trial);

}  // namespace cleave::support
