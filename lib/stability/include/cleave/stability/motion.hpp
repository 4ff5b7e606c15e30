#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/stability/direction.hpp"

namespace cleave::stability {

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

}  // namespace cleave::stability
