#pragma once

#include <span>
#include <vector>

#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::scene {

using geometry::Box;
using geometry::box_of;
[[nodiscard]] Box box_of(const geometry::Solid& solid) noexcept;
/// The same axis with z >= 0; level ones with y > 0, or x > 0.
[[nodiscard]] geometry::Vec3 upward(geometry::Vec3 axis) noexcept;
/// Area vector of a polygon (Newell), relative to its first corner.
[[nodiscard]] geometry::Vec3 area_vector(const geometry::Polygon& polygon);
/// Area vector of the part of a flat loop that lies in the box.
[[nodiscard]] geometry::Vec3 area_within(std::vector<geometry::Vec3> corners, const Box& box);
/// No common volume, for certain: a side of the boxes or the plane of a face of one of them parts them. Bodies that
/// only a plane between edges parts count as not parted.
[[nodiscard]] bool parted(const geometry::Solid& a, const geometry::Solid& b) noexcept;

}  // namespace cleave::scene
