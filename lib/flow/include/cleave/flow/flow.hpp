#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/topology/block_complex.hpp"

/// Water in the joints: steady laminar flow of constant density in a network of planes (Darcy's law with the
/// transmissivity of each joint), saturated; the rock between them lets nothing through.
namespace cleave::flow {

// ---- A network, and what water finds at its surfaces ----------------------------------------------------------------

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
  std::vector<Transmissivity> transmissivity = {};  ///< of each part
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
  [[nodiscard]] const std::vector<Transmissivity>& transmissivity() const noexcept { return spec_.transmissivity; }
  [[nodiscard]] const std::vector<Surface>& surfaces() const noexcept { return spec_.surfaces; }

 private:
  explicit Network(NetworkSpec spec) noexcept : spec_{std::move(spec)} {}
  NetworkSpec spec_;
};

/// Of water in joints.
inline constexpr Acceleration earth_gravity = Acceleration::from_si(9.81);

/// m2/s of two smooth parallel walls: the cubic law, g a^3 / (12 nu). `aperture` in m, `viscosity` kinematic in m2/s.
[[nodiscard]] constexpr double cubic_law(double aperture, double viscosity, double gravity) noexcept {
  return gravity * aperture * aperture * aperture / (12 * viscosity);
}

// ---- Flow -----------------------------------------------------------------------------------------------------------

/// m3/s, with bounds that hold for the exact solution of the same network, up to rounding, whatever is dry.
struct Rate {
  double value = 0, low = 0, high = 0;
};

/// What passes a surface.
struct SurfaceFlow {
  FlowRate out = {};  ///< out of the rock; below 0: into it
  /// Bounds of it; none where the surface touches another one that water passes: what is near the line between the two
  /// cannot be told apart within bounds, only what passes all of them. Nor where some drained surface is dry in part.
  std::optional<Rate> bounds = {};
  Length open_length = {}, dry_length = {};  ///< of borders of wet joints: where water passes, and where none does
};

struct FlowOptions {
  /// The mesh is refined until the half widths of the rates out of drained surfaces (of standing water, where nothing
  /// is drained) add up to no more than this share of the rates.
  double tolerance = 0.02;
  /// Heads of pressure are used: it is also refined until `FlowRound::pressures` is no more than the tolerance.
  bool pressures = false;
  std::size_t most_triangles = 1'000'000;
};

/// Different heads stand side by side: the rate between them has no bound. One of the two surfaces ends there, or is
/// closed.
struct HeadsMeet {
  std::uint32_t surface, other;
  geometry::Vec3 at;  ///< m
  double head, other_head;
};
struct BadOption {
  std::string which;
};
/// The equations could not be factored.
struct NotSolved {};
using FlowError = std::variant<HeadsMeet, BadOption, NotSolved>;
[[nodiscard]] std::string describe(const FlowError& error);

enum class FlowStatus : std::uint8_t {
  converged,
  too_many_triangles,  ///< the bounds are wider than was asked for, or pressures less good
  unsettled,           ///< which parts of drained surfaces water comes out of was not settled
};

/// One mesh of the series.
struct FlowRound {
  std::size_t triangles = 0;
  /// Relative, as FlowOptions::tolerance is meant; on meshes before the last it may be that of a network in which just
  /// what is dry there is closed.
  double width = 0;
  /// Where asked for: of the flat piece of joint where it is most, the integral of the square by which the gradients of
  /// the two solutions differ, over the square of the largest head of pressure there, or of half the root of the
  /// piece's area, where that is more. A measure, not a bound.
  double pressures = 0;
};

/// Two solutions on one mesh: heads that are continuous (linear in triangles), and rates that are balanced to the last
/// (linear, continuous in the middle of sides: Crouzeix and Raviart 1973; their gradients are the rates of the lowest
/// mixed elements, Marini 1985). The one has too much energy and the other too little (Prager and Synge 1947), so that
/// rates through surfaces have bounds from both.
struct Flow {
  Mesh mesh = {};                                ///< refined; parts and surfaces as in the network
  std::vector<std::uint8_t> wet = {};            ///< of each triangle: a surface where water stands reaches it
  std::vector<std::array<Length, 3>> head = {};  ///< at the corners of each triangle; 0 where it is not wet
  std::vector<geometry::Vec3> q = {};  ///< m2/s, of each triangle: rate across a unit width of joint; 0 where not wet
  std::vector<SurfaceFlow> surfaces = {};
  std::vector<FlowRate> out_of_border = {};            ///< of each of the mesh's borders
  std::vector<std::uint32_t> triangle_of_border = {};  ///< one that lies there
  std::vector<std::uint8_t> open = {};                 ///< of each border: water passes, at balanced rates
  /// Of each triangle's corners: continuous heads are given there, by standing water or as z where water comes out.
  std::vector<std::array<std::uint8_t, 3>> held = {};
  Rate drained = {};              ///< out of all drained surfaces
  Area wet_area = {}, area = {};  ///< of joints
  double residual = 0;            ///< of the equations, relative, the largest
  double imbalance = 0;           ///< of all rates, of the sum of their sizes
  std::vector<FlowRound> rounds = {};
  FlowStatus status = FlowStatus::converged;
};

/// Error: rates of the lowest order with meshes that follow the error; the width of the bounds falls like one over the
/// number of triangles, whatever the shape of the network.
[[nodiscard]] std::expected<Flow, FlowError> solve(const Network& network, const FlowOptions& options = {});

// ---- For programs that send water from cell to cell ----------------------------------------------------------------

/// The same water on a mesh for two-point fluxes, made from that of `flow`: sides are turned until no flat piece has
/// two angles across a side that add up to more than half a turn (Lawson 1977), and what no turn mends (obtuse angles
/// across from lines in which joints meet, and from borders) is split in the middle, in a few passes. `flow` has come
/// from `solve`. Continuous heads alone: no rates and no bounds, those of `flow` hold.
[[nodiscard]] std::expected<Flow, FlowError> solve_for_two_points(const Network& network, const Flow& flow,
                                                                  std::size_t most_triangles = 1'000'000);

/// The water around a corner of the mesh: a third of each triangle there.
struct FlowCell {
  geometry::Vec3 at;  ///< m
  Volume volume = {};
  Length head = {};
};
/// Two cells that share a side of the mesh: conductance times the difference of their heads passes between them. It is
/// the sum over the triangles at the side of T cot(angle across) / 2.
struct FlowConnection {
  std::array<std::uint32_t, 2> cells;  ///< ascending
  Transmissivity conductance = {};
};
/// A cell whose head is given.
struct HeldCell {
  std::uint32_t cell;
  std::uint32_t surface;  ///< of several the first with standing water
  FlowRate out = {};      ///< that the cells around send it, at the heads of the Flow
};

/// What is wet of a mesh as cells about its corners. Sums over connections are the equations of heads that are linear
/// in triangles, to the last digit: a program of two-point fluxes that is given the heads of held cells finds all.
/// Of drained surfaces those cells are held that water comes out of; the others are closed, and no head is above z.
struct FlowCells {
  std::vector<FlowCell> cells = {};
  std::vector<std::array<std::uint32_t, 3>> triangles = {};  ///< the cells at their corners
  std::vector<std::uint32_t> triangle_of = {};               ///< of each of them: its number in Flow::mesh
  std::vector<FlowConnection> connections = {};              ///< one a side, ascending
  std::vector<HeldCell> held = {};                           ///< ascending
  std::size_t negative = 0;                                  ///< connections whose conductance is below 0
  double negative_share = 0;                                 ///< theirs of the sum of all sizes
  double imbalance = 0;  ///< the largest of what stays in a cell that is not held, of what goes through it
};
/// `flow` is a solution of `network`; `openings`: of each of its parts how far the walls are apart, m.
[[nodiscard]] FlowCells cells_of(const Flow& flow, const Network& network, std::span<const Length> openings);

// ---- From a cut -----------------------------------------------------------------------------------------------------

/// A surface of the rock: an excavation, or a side of the domain.
struct RockSurface {
  topology::Role role;                      ///< free, fixed or window
  std::optional<std::uint32_t> excavation;  ///< index into CutInput::excavations
  std::optional<std::uint32_t> tag;         ///< of the domain's sides
  friend auto operator<=>(const RockSurface&, const RockSurface&) = default;
};

/// Where the joints of a cut end on surfaces of the rock: those that any reaches, domain sides before excavations.
struct JointSurfaces {
  std::vector<RockSurface> surfaces;
  std::vector<std::uint32_t> of_border;                              ///< of each of JointNetwork::borders
  std::vector<std::pair<std::uint32_t, std::uint32_t>> others = {};  ///< border, one more surface there
};
[[nodiscard]] JointSurfaces surfaces_of(const topology::JointNetwork& network);

/// Borders that lie in an edge of the rock become those of the surface there that water passes, if any; `conditions`
/// are those of the surfaces. Two that would give water different heads are refused.
[[nodiscard]] std::expected<void, HeadsMeet> settle_edges(const topology::BlockComplex& complex,
                                                          std::span<const Surface> conditions, JointSurfaces& surfaces);

/// The mesh of a cut that was made with CutInput::keep_network: parts are its pieces. Points are in m relative to the
/// complex's origin, and so are heads. Sides shorter than 1e-11 of the network's extent, whose direction positions in
/// doubles do not tell, become points.
[[nodiscard]] Mesh mesh_of(const topology::BlockComplex& complex, const JointSurfaces& surfaces);

// ---- What hangs together --------------------------------------------------------------------------------------------

/// A part of a joint: its pieces that hang together by sides. An excavation may cut one joint into several.
struct JointPart {
  topology::JointId joint;  ///< the first of those that lie there
  Area area;
  std::uint32_t cluster;
  /// It lies on a path from a fixed side of the domain to an opening that passes no part twice: water in all others
  /// only goes in and comes out again where it went in.
  bool backbone;
};

/// Joints that hang together.
struct Cluster {
  std::vector<topology::JointId> joints;  ///< ascending
  Area area;
  std::vector<std::uint32_t> surfaces;  ///< that it reaches, into JointSurfaces::surfaces; ascending
};

/// Which joints hang together: exact, as two that share a line of any length do. What touches in a point does not.
struct Connectivity {
  std::vector<JointPart> parts;
  std::vector<std::uint32_t> part_of;  ///< of each of JointNetwork::pieces
  std::vector<Cluster> clusters;       ///< by area, the largest first; of equals that with the first joint
  Area area;                           ///< of all joints in the rock
  std::size_t meetings = 0;            ///< pairs of joints that meet in a line
  Length meeting_length;               ///< of all these lines
  /// Domain sides that one cluster connects: pairs of JointSurfaces::surfaces, ascending.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> percolates;
};
[[nodiscard]] Connectivity connectivity(const topology::BlockComplex& complex, const JointSurfaces& surfaces);

}  // namespace cleave::flow
