#pragma once

#include <expected>
#include <span>

#include "cleave/geometry/solid.hpp"
#include "detail/facet_builder.hpp"

namespace cleave::topology::detail {

/// A box or hexahedron as the common inside of its faces' planes. Returns its volume, or the face that has collapsed.
[[nodiscard]] std::expected<double, Index> add_half_spaces(const geometry::Solid& solid,
                                                           std::span<const exact::LatticePoint> sites,
                                                           FacetBuilder& builder, Prepared& out, Owner owner,
                                                           Index owner_index);
/// A general closed surface: faces that are exactly planar on the lattice stay whole, all others become triangles on
/// their own corners, so that it stays closed. Returns its volume, or the face that has collapsed.
[[nodiscard]] std::expected<double, Index> add_surface(const geometry::Solid& solid,
                                                       std::span<const exact::LatticePoint> sites,
                                                       FacetBuilder& builder, const Prepared& out, Owner owner,
                                                       Index owner_index);

}  // namespace cleave::topology::detail
