#include "cleave/geometry/polygon.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"

namespace cleave::geometry {
namespace {

/// Two unit vectors in the plane: the first side and, a quarter turn counter-clockwise from it, the second.
struct Axes {
  Vec3 first, second;
};

Axes axes_of(Attitude plane, InPlaneRotation rotation) {
  const Vec3 strike = strike_vector(plane.direction);
  const Vec3 up_dip = -dip_vector(plane);  // = normal x strike
  const double c = cos_degrees(rotation.degrees());
  const double s = sin_degrees(rotation.degrees());
  return {c * strike + s * up_dip, c * up_dip - s * strike};
}

std::optional<ShapeError> bad_size(const char* what, Length value) {
  if (value > metres(0)) return std::nullopt;
  return NonPositiveSize{what, value};
}

std::expected<Polygon, ShapeError> polygon(std::vector<Vec3> corners) {
  auto made = Polygon::make(std::move(corners));
  if (!made) return std::unexpected(ShapeError{made.error()});
  return *std::move(made);
}

}  // namespace

double same_area_radius(std::uint32_t sides) noexcept {
  return std::sqrt(2 * std::numbers::pi / (sides * sin_degrees(360.0 / sides)));
}

std::expected<Polygon, ShapeError> ellipse(Vec3 centre, Attitude plane, Length half_axis_a, Length half_axis_b,
                                           InPlaneRotation rotation, std::uint32_t sides) {
  if (auto bad = bad_size("half axis a", half_axis_a)) return std::unexpected(*std::move(bad));
  if (auto bad = bad_size("half axis b", half_axis_b)) return std::unexpected(*std::move(bad));
  if (sides < 3) return std::unexpected(TooFewSides{sides});
  const auto [u, v] = axes_of(plane, rotation);
  const double a = half_axis_a.si() * same_area_radius(sides);
  const double b = half_axis_b.si() * same_area_radius(sides);
  std::vector<Vec3> corners;
  corners.reserve(sides);
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double t = 360.0 * i / sides;
    corners.push_back(centre + a * cos_degrees(t) * u + b * sin_degrees(t) * v);
  }
  return polygon(std::move(corners));
}

std::expected<Polygon, ShapeError> disc(Vec3 centre, Attitude plane, Length radius, std::uint32_t sides) {
  if (auto bad = bad_size("radius", radius)) return std::unexpected(*std::move(bad));
  return ellipse(centre, plane, radius, radius, {}, sides);
}

std::expected<Polygon, ShapeError> rectangle(Vec3 centre, Attitude plane, Length side_a, Length side_b,
                                             InPlaneRotation rotation) {
  if (auto bad = bad_size("side a", side_a)) return std::unexpected(*std::move(bad));
  if (auto bad = bad_size("side b", side_b)) return std::unexpected(*std::move(bad));
  const auto [u, v] = axes_of(plane, rotation);
  const Vec3 a = side_a.si() / 2 * u;
  const Vec3 b = side_b.si() / 2 * v;
  return polygon({centre - a - b, centre + a - b, centre + a + b, centre - a + b});
}

std::string describe(const ShapeError& error) {
  return std::visit(
      overloaded{
          [](const NonPositiveSize& e) { return fmt::format("{} is {} m; it must be positive", e.what, e.value.si()); },
          [](TooFewSides e) { return fmt::format("a disc drawn with {} sides has no area; give at least 3", e.sides); },
          [](const PolygonError& e) { return describe(e); },
      },
      error);
}

}  // namespace cleave::geometry
