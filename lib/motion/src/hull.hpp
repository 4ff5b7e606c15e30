#pragma once

#include <cstdint>
#include <vector>

namespace cleave::motion {

struct Flat {
  double x = 0, y = 0;
};

/// Numbers of the corners of the convex hull, counter-clockwise. A corner that lies within `tolerance` of the line of
/// its neighbours or of another point is none; nor does it matter to which side of one another points fall that are as
/// near as that.
[[nodiscard]] std::vector<std::uint32_t> hull_of(const std::vector<Flat>& points, double tolerance);

}  // namespace cleave::motion
