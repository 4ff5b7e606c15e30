#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <string>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/vec3.hpp"

/// Water in the joints: steady laminar flow of constant density in a network of planes (Darcy's law with the
/// transmissivity of each joint), saturated; the rock between them lets nothing through.
namespace cleave::flow {

/// Water stands at the surface up to a level: the total head there is the level (m, as z). Above it nothing passes.
struct Standing {
  Length level;
};
/// Open to the air: water that comes out has no pressure (its head is z), and none goes in.
struct Drained {};
/// Nothing passes.
struct Closed {};
/// What water finds at a part of the rock's surface.
using Surface = std::variant<Closed, Drained, Standing>;

/// A side of a triangle that lies on a surface of the rock.
struct Border {
  std::array<std::uint32_t, 2> ends;  ///< points
  std::uint32_t surface;
};

/// Triangles in space that conform: two have a side in common, a corner, or nothing. Any number may meet in a side.
struct Mesh {
  std::vector<geometry::Vec3> points = {};  ///< m
  std::vector<std::array<std::uint32_t, 3>> triangles = {};
  std::vector<std::uint32_t> part = {};  ///< of each triangle: the flat piece of joint that it belongs to
  std::vector<Border> borders = {};
};

struct NetworkSpec {
  Mesh mesh = {};
  std::vector<double> transmissivity = {};  ///< m2/s, of each part
  std::vector<Surface> surfaces = {};
};

struct BadNetwork {
  std::string which;  ///< "triangle 3", "part 0"
  std::string what;
};
[[nodiscard]] std::string describe(const BadNetwork& error);

/// A network that water can be sent through. Invariant: all numbers finite, all indices in range; transmissivities > 0;
/// triangles have three different corners; borders are sides of triangles, each once.
class Network final {
 public:
  [[nodiscard]] static std::expected<Network, BadNetwork> make(NetworkSpec spec);
  [[nodiscard]] const Mesh& mesh() const noexcept { return spec_.mesh; }
  [[nodiscard]] const std::vector<double>& transmissivity() const noexcept { return spec_.transmissivity; }
  [[nodiscard]] const std::vector<Surface>& surfaces() const noexcept { return spec_.surfaces; }

 private:
  explicit Network(NetworkSpec spec) noexcept : spec_{std::move(spec)} {}
  NetworkSpec spec_;
};

/// m2/s of two smooth parallel walls: the cubic law, g a^3 / (12 nu). `aperture` in m, `viscosity` kinematic in m2/s.
[[nodiscard]] constexpr double cubic_law(double aperture, double viscosity, double gravity) noexcept {
  return gravity * aperture * aperture * aperture / (12 * viscosity);
}

}  // namespace cleave::flow
