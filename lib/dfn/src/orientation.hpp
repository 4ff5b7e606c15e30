#pragma once

#include "cleave/dfn/joint_set.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::dfn::detail {

/// A joint's own axes. All unit, at right angles.
struct Frame {
  geometry::Vec3 normal;  ///< upwards
  geometry::Vec3 strike;  ///< horizontal, dip direction less 90 degrees; normal x strike is the up-dip direction
};

/// Of a plane with dip and dip direction in degrees; dips outside [0, 90] are folded back (-10 -> 10 the other way, 100
/// -> 80 the other way).
[[nodiscard]] Frame frame_of(double dip_degrees, double dip_direction_degrees) noexcept;
/// Of a normal; one without dip direction of its own (horizontal joint) keeps the strike it is given.
[[nodiscard]] Frame frame_of_normal(geometry::Vec3 normal, geometry::Vec3 strike_if_flat) noexcept;
/// One draw of Fisher's law about a normal; u, v in (0, 1).
[[nodiscard]] Frame turned_by_fisher(geometry::Vec3 normal, double kappa, double u, double v) noexcept;
/// Of the law's mean.
[[nodiscard]] Frame mean_frame(const OrientationLaw& law) noexcept;

/// One draw; u, v in (0, 1). Fisher by exact inversion: 1 - cos t = -log1p(u expm1(-2 kappa))/kappa, azimuth 2 pi v.
[[nodiscard]] Frame draw(const OrientationLaw& law, double u, double v) noexcept;
/// The same, `mean` being the law's mean frame: for many draws.
[[nodiscard]] Frame draw(const OrientationLaw& law, const Frame& mean, double u, double v) noexcept;

}  // namespace cleave::dfn::detail
