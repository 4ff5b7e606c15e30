#pragma once

#include <array>
#include <span>
#include <vector>

#include "detail/lattice_polygon.hpp"

/// Polygons that share a side with others but have corners off their plane (all doubles are rounded) are cut as a
/// folded sheet: triangles on their own corners, so that the sheet's rim is exactly the chain of its sides and
/// neighbours meet without a gap. Blocks see one face on one plane: pieces of one sheet are put together again.
namespace cleave::topology::detail {

/// The most that corners may lie off the plane for the pieces to count as one flat face, sites; in small scenes far
/// from the origin of coordinates, more: as many roundings of the coordinates.
inline constexpr double flat_within = 4096;
inline constexpr double roundings_of_corners = 16;

/// Distance of a site from the plane, sites.
[[nodiscard]] double distance_sites(const exact::Plane& plane, exact::LatticePoint p);

/// Triangles whose rim is the closed chain of the corners: the same ones whichever corner is first and whichever way
/// round. Those with the largest smallest height, so that rounded corners on straight sides make no needle that looks
/// anywhere. Empty where no area is left.
[[nodiscard]] std::vector<std::array<exact::LatticePoint, 3>> fold(std::vector<exact::LatticePoint> corners);
/// Whether no such triangles fill the ring without lying on one another.
[[nodiscard]] bool crosses_itself(std::vector<exact::LatticePoint> corners);

}  // namespace cleave::topology::detail
