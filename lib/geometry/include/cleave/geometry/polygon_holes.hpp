#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/polygon.hpp"

namespace cleave::geometry {

/// What can be wrong with the holes of a polygon.
struct HoleFault {
  enum class Kind : std::uint8_t {
    off_plane,  ///< a corner lies further from the polygon's plane than Polygon allows its own
    outside,    ///< the hole does not lie inside the polygon, or touches its outline
    overlaps    ///< the hole meets another one, or one lies in the other
  };
  std::size_t hole;  ///< from 0
  Kind kind = Kind::outside;
  Length distance = {};  ///< from the plane, for off_plane
};
/// "what is wrong; what to do", in words for an engineer.
[[nodiscard]] std::string describe(const HoleFault& fault);

/// Holes must lie in the polygon's plane, strictly inside it, and apart from each other. Decided by exact signs, seen
/// along the dominant axis of the polygon's plane. O(corners^2).
[[nodiscard]] std::optional<HoleFault> check_holes(const Polygon& polygon, std::span<const Polygon> holes);

}  // namespace cleave::geometry
