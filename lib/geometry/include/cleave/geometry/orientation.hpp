#pragma once

#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/core/vec2.hpp"
#include "cleave/geometry/vec3.hpp"

/// Planes and lines as geologists write them, and as vectors (x = east, y = north, z = up).
/// Sines and cosines of multiples of 90 degrees are exact, so that a vertical joint is exactly vertical.
namespace cleave::geometry {

struct TrendKind;
struct PlungeKind;
struct NorthKind;
struct StrikeKind;
using Trend = Angle<TrendKind>;    ///< 0..360 clockwise from north
using Plunge = Angle<PlungeKind>;  ///< -90..90, positive downwards
using Strike = Angle<StrikeKind>;  ///< right-hand rule: dip direction - 90
/// From the y axis to true north, clockwise.
using North = Angle<NorthKind>;

struct Attitude {
  Dip dip;
  DipDirection direction;
  friend bool operator==(const Attitude&, const Attitude&) = default;
};
struct LineAttitude {
  Trend trend;
  Plunge plunge;
  friend bool operator==(const LineAttitude&, const LineAttitude&) = default;
};

/// Sine and cosine of degrees; reduced in degrees first, so exact at multiples of 90 and symmetric about them.
[[nodiscard]] double sin_degrees(double degrees) noexcept;
[[nodiscard]] double cos_degrees(double degrees) noexcept;
/// The same angle in [0, 360).
[[nodiscard]] double wrap_degrees(double degrees) noexcept;

/// (sin d sin a, sin d cos a, cos d): unit, z >= 0.
[[nodiscard]] Vec3 upward_normal(Attitude plane) noexcept;
/// (cos d sin a, cos d cos a, -sin d): unit, line of steepest descent.
[[nodiscard]] Vec3 dip_vector(Attitude plane) noexcept;
/// (-cos a, sin a, 0): unit, horizontal, the strike by the right-hand rule. strike x dip vector = -(upward normal).
[[nodiscard]] Vec3 strike_vector(DipDirection direction) noexcept;
/// Inverse of `upward_normal` for a normal of any length and sense, not zero. Vertical planes: the dip direction the
/// normal points to; horizontal ones: dip direction 0.
[[nodiscard]] Attitude attitude_of(Vec3 normal) noexcept;

[[nodiscard]] DipDirection dip_direction_of(Strike strike) noexcept;
[[nodiscard]] Strike strike_of(DipDirection direction) noexcept;

/// (cos p sin t, cos p cos t, -sin p): unit.
[[nodiscard]] Vec3 line_vector(LineAttitude line) noexcept;
/// Inverse of `line_vector` for a vector of any length, not zero; keeps its sense (plunge < 0 points up). Vertical
/// lines: trend 0.
[[nodiscard]] LineAttitude line_attitude_of(Vec3 direction) noexcept;
/// The downward normal of a plane: trend a + 180, plunge 90 - d.
[[nodiscard]] LineAttitude pole_of(Attitude plane) noexcept;

/// From "clockwise from true north" to "clockwise from the y axis" and back.
[[nodiscard]] DipDirection from_true_north(DipDirection direction, North north) noexcept;
[[nodiscard]] DipDirection to_true_north(DipDirection direction, North north) noexcept;

enum class Net { equal_area, equal_angle };  ///< Schmidt, Wulff

/// Position on a net of radius 1, x to the east, y to the north.
using NetPoint = Vec2;
/// Lower hemisphere: equal area r = sqrt 2 sin(theta / 2), equal angle r = tan(theta / 2), theta = 90 - plunge. A line
/// that points up is turned round.
[[nodiscard]] NetPoint project(LineAttitude line, Net net) noexcept;
[[nodiscard]] NetPoint project(Vec3 direction, Net net) noexcept;
/// The plane's great circle as segments + 1 points, from its strike through its dip vector to the opposite strike.
[[nodiscard]] std::vector<NetPoint> great_circle(Attitude plane, Net net, int segments = 64);

}  // namespace cleave::geometry
