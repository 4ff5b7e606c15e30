#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "cleave/geometry/solid.hpp"
#include "detail/facet_builder.hpp"

namespace cleave::topology::detail {

/// A box or hexahedron as the common inside of its faces' planes. Returns the face that has collapsed, if one has.
[[nodiscard]] std::optional<Index> add_half_spaces(const geometry::Solid& solid,
                                                   std::span<const exact::LatticePoint> sites, FacetBuilder& builder,
                                                   Prepared& out, Owner owner, Index owner_index);
/// A general closed surface: faces that are exactly planar on the lattice stay whole, all others become triangles on
/// their own corners, so that it stays closed. Returns the face that has collapsed, if one has.
[[nodiscard]] std::optional<Index> add_surface(const geometry::Solid& solid, std::span<const exact::LatticePoint> sites,
                                               FacetBuilder& builder, Prepared& out, Owner owner, Index owner_index);

/// Triangles, counter-clockwise seen from outside.
[[nodiscard]] std::vector<std::array<exact::FixedPoint, 3>> surface_of_box(exact::LatticePoint lo,
                                                                           exact::LatticePoint hi);

}  // namespace cleave::topology::detail
