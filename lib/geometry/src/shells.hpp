#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "cleave/geometry/solid.hpp"
#include "crossing.hpp"

namespace cleave::geometry {

/// Which way each closed shell of the surface looks: outwards when an even number of other shells hold it, inwards (the
/// wall of a cavity) when an odd number do. The first shell that does not is the error. `shell_of_face` numbers shells
/// from 0.
[[nodiscard]] std::optional<InsideOut> wrong_shell(std::span<const Vec3> vertices,
                                                   std::span<const SurfaceTriangle> triangles,
                                                   std::span<const std::uint32_t> shell_of_face, std::uint32_t shells);

}  // namespace cleave::geometry
