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

}  // namespace cleave::scene
