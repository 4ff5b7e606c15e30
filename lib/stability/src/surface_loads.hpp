#pragma once

#include <functional>

#include "cleave/core/id.hpp"
#include "cleave/stability/actions.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

/// Forces on one block summed up, N, and their moment about the block's centroid, Nm.
struct ForceSum {
  geometry::Vec3 force;
  geometry::Vec3 moment;
  double scale = 0;  ///< N, sum of the magnitudes
  void add(geometry::Vec3 f, geometry::Vec3 arm) {
    force += f;
    moment += geometry::cross(arm, f);
    scale += geometry::norm(f);
  }
};

/// Whether a free face is part of a free surface.
[[nodiscard]] bool lies_on(const topology::Face& face, const FreeSurface& surface);

/// Calls visit(block, force, at) for each of surcharge, line and point forces, N and m.
void for_each_surface_load(
    const topology::BlockComplex& complex, const Actions& actions,
    const std::function<void(topology::BlockId, geometry::Vec3 force, geometry::Vec3 at)>& visit);
/// The same summed up by block. Empty when there are none.
[[nodiscard]] IdVector<topology::BlockId, ForceSum> surface_forces(const topology::BlockComplex& complex,
                                                                   const Actions& actions);

}  // namespace cleave::stability
