#pragma once

#include <span>

#include "cleave/facets/prepared.hpp"

namespace cleave::topology::detail {

/// The edges drawn in one plane.
struct PlaneView {
  Index plane;
  std::span<const Index> uses;
};

/// A closed walk along half-edges with one face on its left: around a bounded face (outer), or around a connected
/// piece of the drawing seen from outside (not outer).
struct Loop {
  Index start;
  bool outer;
};

}  // namespace cleave::topology::detail
