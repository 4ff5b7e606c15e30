#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/geometry/tunnel.hpp"
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

// ---- Cuts into the ground from above: slopes, benches, pits

/// Box that a cut must clear: that of the domain.
struct Reach {
  Vec3 min, max;
};

/// All above a plane. Its body reaches a little beyond `reach`.
struct PlaneCut {
  Vec3 through;
  Attitude plane;
};
/// All above a profile that is the same along its strike: points (s, z), s in m from `origin` along `direction`,
/// growing. Beyond its ends the ground goes on level.
struct ProfileCut {
  std::array<double, 2> origin;  ///< x, y
  DipDirection direction;
  std::vector<std::array<double, 2>> points;
};

/// A pit: benches downwards from a polygon in plan.
struct BenchCut {
  std::vector<std::array<double, 2>> plan;  ///< crest of the uppermost bench, (x, y), in either sense
  double top;                               ///< m, level of that crest
  std::uint32_t count;                      ///< benches
  Length height;                            ///< of each
  Length width;                             ///< of the berm between two faces
  double angle;                             ///< degrees of the faces from horizontal, above 0 to 90
};

struct NothingCut {};  ///< the plane or profile lies above all of `reach`
struct BadProfile {
  std::size_t point;  ///< its s is not larger than that of the one before, or it is not a number
};
struct BadBench {
  std::string what;  ///< "height", "width", "angle", "count"
};
struct BadPlan {
  PolygonError reason;
};
struct BenchCloses {
  std::uint32_t bench;  ///< from 1: where the plan of the pit has shrunk to nothing or crosses itself
};
using SlopeError = std::variant<NothingCut, BadProfile, BadBench, BadPlan, BenchCloses, TunnelError, SolidError>;
/// "what is wrong; what to do", in words for an engineer.
[[nodiscard]] std::string describe(const SlopeError& error);

[[nodiscard]] std::expected<Solid, SlopeError> make_plane_cut(const PlaneCut& cut, const Reach& reach);
[[nodiscard]] std::expected<Solid, SlopeError> make_profile_cut(const ProfileCut& cut, const Reach& reach);
/// One solid a bench, from the top; tags face, floor, top. When `clear_to` lies above `cut.top` the first one is the
/// room above the crest up to there. Benches of a convex plan are half-space solids, so each face is one plane.
[[nodiscard]] std::expected<std::vector<Solid>, SlopeError> make_benches(const BenchCut& cut, double clear_to);

}  // namespace cleave::geometry
