#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/geometry/vec3.hpp"

/// Ground surfaces, and the bodies below or above them.
namespace cleave::geometry {

/// A triangulated surface; in which sense each triangle is listed does not matter.
struct Ground {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Heights (m) of `columns` x `rows` points, row by row from the north, each row from the west; NaN: none there.
struct Heights {
  std::uint32_t columns, rows;
  double x, y;            ///< m, of the south-west point
  double step_x, step_y;  ///< m, > 0
  std::span<const double> values;
};

/// Each cell with four heights becomes two triangles along its diagonal from south-west to north-east; a cell that
/// lacks a height is left out.
[[nodiscard]] Ground ground_of(const Heights& heights);

struct EmptyGround {};  ///< no triangle
struct BadTriangle {
  std::size_t triangle;  ///< a vertex number out of range, or one that comes twice
};
struct LevelWithin {  ///< the level that closes the body must lie wholly below or wholly above the ground
  Length level;
  Length lowest, highest;  ///< of the ground
};
struct TwistedGround {};  ///< triangles cannot be given one sense, or more than two share an edge
using TerrainError = std::variant<EmptyGround, BadTriangle, LevelWithin, TwistedGround, SolidError>;
/// "what is wrong; what to do", in words for an engineer.
[[nodiscard]] std::string describe(const TerrainError& error);

/// The body between the ground and a level: below the ground when the level is lower (a domain), above it when the
/// level is higher (an excavation). Sides are vertical; neighbouring ones that go straight on are one face. Tags are
/// those of a box: the ground is `top` of a domain and `bottom` of an excavation, sides are named by the way they look.
[[nodiscard]] std::expected<Solid, TerrainError> close_ground(const Ground& ground, double level);

}  // namespace cleave::geometry
