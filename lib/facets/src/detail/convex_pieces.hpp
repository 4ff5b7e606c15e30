#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "detail/lattice_polygon.hpp"

namespace cleave::topology::detail {

/// A convex part of a polygon: inside all its sides. Each side goes through two sites, or through one and along an
/// axis.
struct ConvexPiece {
  static constexpr std::size_t cut = SIZE_MAX;
  struct Side {
    exact::LatticePoint at;
    exact::LatticePoint direction;  ///< the piece is on the left
    std::size_t number;             ///< of the outline's side that begins at this corner, or `cut`
  };
  std::vector<Side> sides;
  std::vector<std::array<double, 3>> corners;  ///< sites, about; in order round the piece
};

/// Parts a polygon in two directions at each corner where it is not convex, all cuts along one axis as seen against
/// `along`: no two cuts meet, so no corner gets many. Of the two axes the one with the shorter cuts. `loops`: the
/// outline counter-clockwise, then holes clockwise; sides are numbered through. Empty where loops touch or cross.
[[nodiscard]] std::vector<ConvexPiece> convex_pieces(std::span<const std::vector<exact::LatticePoint>> loops,
                                                     exact::LatticePoint along);

}  // namespace cleave::topology::detail
