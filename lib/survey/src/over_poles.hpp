#pragma once

#include <functional>
#include <span>

#include "cleave/geometry/vec3.hpp"
#include "cleave/survey/traces.hpp"

/// Means over poles as they were measured, where Fisher's law is refused.
namespace cleave::survey::detail {

using OfNormal = std::function<double(geometry::Vec3)>;

[[nodiscard]] double mean_over_poles(std::span<const geometry::Vec3> normals, std::span<const double> weights,
                                     const OfNormal& figure);
/// Mean of `above` over mean of `below`, each joint one independent piece.
[[nodiscard]] Estimate over_poles(std::span<const geometry::Vec3> normals, std::span<const double> weights,
                                  const OfNormal& above, const OfNormal& below, double confidence);

}  // namespace cleave::survey::detail
