#pragma once

#include <span>

#include "cleave/geometry/solid.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::scene {

/// Axis-parallel box, metres.
struct Box {
  geometry::Vec3 min, max;
};
/// Precondition: not empty.
[[nodiscard]] Box box_of(std::span<const geometry::Vec3> points) noexcept;
[[nodiscard]] Box box_of(const geometry::Solid& solid) noexcept;
/// No common point.
[[nodiscard]] bool apart(const Box& a, const Box& b) noexcept;
/// No common volume, for certain: a side of the boxes or the plane of a face of one of them parts them. Bodies that
/// only a plane between edges parts count as not parted.
[[nodiscard]] bool parted(const geometry::Solid& a, const geometry::Solid& b) noexcept;

}  // namespace cleave::scene
