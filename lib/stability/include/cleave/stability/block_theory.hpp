#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/exact/integer.hpp"
#include "cleave/exact/plane.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/stability/strength.hpp"

namespace cleave::stability {

// ---- Directions -----------------------------------------------------------------------------------------------------

/// The exact direction of a plane's normal: an integer vector.
///
/// Invariant: not zero, components without a common factor and below 2^104. So equal directions (parallel, same sense)
/// have equal components, whatever planes they come from.
class Direction final {
 public:
  using Components = std::array<exact::Int128, 3>;

  /// Direction of the plane's normal towards its positive side.
  [[nodiscard]] static Direction normal_of(const exact::Plane& plane) noexcept;
  /// Empty for the zero vector and for components of 2^104 and more.
  [[nodiscard]] static std::optional<Direction> make(const Components& components) noexcept;

  [[nodiscard]] Direction opposite() const noexcept;
  /// The same, of a normal that the roundings of its corners may have turned by so much, rad: signs that this could
  /// turn are zero. Else all signs are exact.
  [[nodiscard]] Direction turned_by(double rounding) const noexcept;
  [[nodiscard]] double rounding() const noexcept { return rounding_; }
  [[nodiscard]] const Components& components() const noexcept { return components_; }
  /// Unit vector; each component within 5 * 2^-53 of its value, relative.
  [[nodiscard]] geometry::Vec3 unit() const noexcept { return unit_; }
  [[nodiscard]] bool opposite_to(const Direction& other) const noexcept;

  friend bool operator==(const Direction& a, const Direction& b) noexcept { return a.components_ == b.components_; }

 private:
  Direction(const Components& components, geometry::Vec3 unit) noexcept : components_{components}, unit_{unit} {}
  [[nodiscard]] static Direction reduced(Components components) noexcept;
  Components components_;
  geometry::Vec3 unit_;
  double rounding_ = 0;
};

/// Sign of (a x b) . c; exact, filtered; zero where the roundings of the three could turn it.
[[nodiscard]] exact::Sign orientation(const Direction& a, const Direction& b, const Direction& c) noexcept;

/// a x b of the unit vectors, in double from the exact integers: accurate to a few ulp even for nearly parallel
/// directions.
[[nodiscard]] geometry::Vec3 cross(const Direction& a, const Direction& b) noexcept;

// ---- Motion of one block --------------------------------------------------------------------------------------------

/// The cone K = {d : n.d >= 0 for every row n} of directions a block may move in; rows are the inward normals of its
/// joint faces. Equal rows are one group: what is said of a group holds for all faces with that normal.
class Cone final {
 public:
  /// Groups come in the order of their first row.
  explicit Cone(std::span<const Direction> inward_normals);

  [[nodiscard]] std::span<const Direction> groups() const noexcept { return groups_; }
  /// Group of each row given to the constructor.
  [[nodiscard]] std::span<const std::uint32_t> group_of_row() const noexcept { return group_of_row_; }

  /// Dimension of K, by exact signs: 3 opens in a solid cone; 2 or 1: only slides in a plane or along a line; 0: K =
  /// {0}, the block is tapered and cannot move. A block is removable (first motion) when it is > 0. Cost O(groups^3).
  [[nodiscard]] std::uint8_t dimension() const;

 private:
  std::vector<Direction> groups_;
  std::vector<std::uint32_t> group_of_row_;
};

/// Sum of the forces applied to a block, N, with what is known of its rounding.
class Resultant final {
 public:
  /// A force along `direction` exactly, as given: signs are then exact integers, ties do not occur (gravity alone).
  [[nodiscard]] static Resultant along(geometry::Vec3 direction, Force magnitude);
  /// Adds a force that carries rounding errors of a few ulp of `scale` (>= its magnitude). Adding zero changes nothing.
  void add(geometry::Vec3 newtons, double scale);

  [[nodiscard]] geometry::Vec3 newtons() const noexcept { return newtons_; }
  /// Sum of the magnitudes of what was added, N.
  [[nodiscard]] double scale() const noexcept { return scale_; }
  /// Whether `direction()` is the exact direction.
  [[nodiscard]] bool exact() const noexcept { return exact_; }
  /// Parallel to the resultant, not a unit vector.
  [[nodiscard]] geometry::Vec3 direction() const noexcept { return exact_ ? direction_ : newtons_; }

 private:
  geometry::Vec3 newtons_;
  geometry::Vec3 direction_;
  double scale_ = 0;
  bool exact_ = true;
};

enum class MotionKind : std::uint8_t {
  none,        ///< no force
  free,        ///< the resultant lies in K
  one_plane,   ///< slides on one group
  two_planes,  ///< slides along the line of two groups
  held,        ///< the projection is zero: safe without friction
};

/// The projection s of the resultant r on K: the force that is left when every pressing face pushes back (r + sum N n =
/// s, N >= 0).
struct Motion {
  MotionKind kind = MotionKind::none;
  geometry::Vec3 s;                       ///< N; zero for none and held
  std::array<std::uint32_t, 2> groups{};  ///< the pressing ones: the first of one_plane, both of two_planes
  std::array<double, 2> reactions{};      ///< N, >= 0
  std::vector<std::uint32_t>
      touching;      ///< groups with n.s = 0, pressing ones included, ascending; empty for none and held
  bool tie = false;  ///< a sign was below the rounding of the resultant and counted as zero
};

/// Finds the projection by its optimality conditions (S1): free, then each plane, then each pair; the first that holds
/// is the answer, as the projection is unique. Signs are exact where the resultant is; else a sign below the rounding
/// error counts as zero, which takes the mode with fewer faces. An s below 2^-40 of the resultant counts as zero: that
/// is the rounding of the normals. Cost O(groups^3).
[[nodiscard]] Motion project(const Cone& cone, const Resultant& resultant);

/// Reactions (N_i, N_j) of (S2) when groups i and j alone hold the part of the resultant across their line; empty when
/// they are antiparallel or one of them would have to pull.
[[nodiscard]] std::optional<std::pair<double, double>> reactions(const Cone& cone, const Resultant& resultant,
                                                                 std::uint32_t i, std::uint32_t j);

// ---- Block theory ---------------------------------------------------------------------------------------------------

// Classical block theory (Goodman & Shi 1985): which blocks persistent joint sets can make at a free surface, from
// orientations alone.

/// The blocks on one choice of sides of all joint planes. Bit i of `code` is 1 when the block lies below plane i
/// (against its upward normal).
struct JointPyramid {
  std::uint32_t code = 0;
  std::uint8_t dimension = 0;  ///< 3: has an interior
  bool finite = false;         ///< together with the rock at the free surface it holds no direction: blocks are finite
  /// Not empty and finite: blocks of this kind can come out.
  [[nodiscard]] bool removable() const noexcept { return dimension == 3 && finite; }
  Mode mode = Mode::tapered;      ///< under the force asked
  geometry::Vec3 direction = {};  ///< unit
  double driving = 0;             ///< T / |force|
  double resistance = 0;          ///< R / |force|, cohesion none
};

/// All 2^n joint pyramids of the planes (upward normals, n <= 16) at a free surface whose outward normals (out of the
/// rock) are given: one for a plane, several for a convex edge of rock. `tan_friction` by plane. In order of code.
[[nodiscard]] std::vector<JointPyramid> joint_pyramids(std::span<const Direction> planes,
                                                       std::span<const double> tan_friction,
                                                       std::span<const Direction> free_surfaces, geometry::Vec3 force);

/// A prismatic tunnel with a convex section.
struct ConvexTunnel {
  geometry::Vec3 axis;  ///< unit
  geometry::Vec3 right, up;
  std::vector<std::array<double, 2>> outline;  ///< (u, v) m, counter-clockwise seen along the axis with u to the right
};

/// The largest block of one joint pyramid at a tunnel: its apex lies where the outermost edges just touch the section.
struct MaximumBlock {
  std::uint32_t code = 0;
  std::array<double, 2> apex{};  ///< (u, v) m
  double volume = 0;             ///< m3
  double face_area = 0;          ///< m2 of the tunnel's wall
  geometry::Vec3 face_vector{};  ///< m2: the wall's parts times their normals into the rock, summed up
  double height = 0;             ///< m, apex to the nearest point of the section
  std::array<double, 2> foot{};  ///< (u, v) m, that point
  /// By plane, m: its trace on the wall, and the largest extent of its joint face.
  std::vector<double> traces = {}, extents = {};

  /// All lengths times `factor`, seen from `foot`: the block of the same shape at the same side, its apex nearer to the
  /// wall.
  void scale(double factor);
};
/// Empty where the pyramid is empty, holds the axis, or sees the section from all round.
[[nodiscard]] std::optional<MaximumBlock> maximum_block(std::span<const Direction> planes, std::uint32_t code,
                                                        const ConvexTunnel& tunnel);

/// A direction as integers, each component to 2^-40 of the largest. Empty for the zero vector.
[[nodiscard]] std::optional<Direction> direction_of(geometry::Vec3 v);

// ---- Largest blocks at a tunnel -------------------------------------------------------------------------------------

/// A joint set as block theory sees it: planes of one orientation, anywhere and without end.
struct TheoryPlane {
  Direction upward;  ///< normal
  JointStrength strength;
};

/// The largest block of three sets at a tunnel that could come out, and its statics.
struct MaximumKeyBlock {
  std::array<std::size_t, 3> planes{};        ///< which, ascending
  std::array<geometry::Vec3, 3> upward = {};  ///< their unit normals
  MaximumBlock block;                         ///< bit i of its code: below planes[i]
  double scale = 1;                           ///< of its lengths, that no joint be longer than it may be
  [[nodiscard]] double longest_trace() const noexcept;
  [[nodiscard]] double largest_extent() const noexcept;
  std::array<double, 3> areas{};  ///< m2 of the joint faces
  Force weight = {};
  Mode mode = Mode::stable;
  geometry::Vec3 direction = {};  ///< unit; zero where nothing drives it
  Force driving = {}, resistance = {}, net = {};
  double factor_of_safety = std::numeric_limits<double>::infinity();
  double target = 1;
  /// Pa on its free face, at right angles to the wall, that reaches the target: 0 where none is needed, inf where none
  /// does.
  double required_pressure = 0;
};

/// How long joints may be, m.
struct Persistence {
  double trace = std::numeric_limits<double>::infinity();  ///< on the wall
  double size = std::numeric_limits<double>::infinity();   ///< largest extent of a joint face
};

struct TheoryLoads {
  RockMass rock;
  Loads body;
  PartialFactors partial = {};
  double target_falling = 1.5, target_sliding = 1.3;
};

/// For every three of the planes and every choice of their sides: the largest removable block (Goodman and Shi 1985),
/// its faces, mode and factor of safety; scaled down where joints are not as long. Blocks below `least` m3 are left
/// out. In order of planes, then code.
[[nodiscard]] std::vector<MaximumKeyBlock> maximum_key_blocks(std::span<const TheoryPlane> planes,
                                                              const ConvexTunnel& tunnel, const TheoryLoads& loads,
                                                              const Persistence& persistence = {}, double least = 1e-9);

/// Whether the corners, counter-clockwise, bound a convex region.
[[nodiscard]] bool is_convex(std::span<const std::array<double, 2>> outline);

}  // namespace cleave::stability
