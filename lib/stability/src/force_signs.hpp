#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "cleave/exact/integer.hpp"
#include "cleave/exact/wide.hpp"
#include "cleave/stability/block_theory.hpp"

namespace cleave::stability {

/// Signs of expressions linear in the resultant r: double first, with a proven bound; then integers. Normals are exact,
/// or turned by roundings: signs that these could turn are zero. r is exact, or known to a rounding error: then a sign
/// that this error could turn is zero, and `tie` remembers it.
class ForceSigns final {
 public:
  /// `resultant` must not be zero.
  explicit ForceSigns(const Resultant& resultant);

  /// n.r
  [[nodiscard]] exact::Sign along(const Direction& n) {
    const double value = along_in_double(n);
    if (std::abs(value) < n.rounding() * length_) return exact::Sign::zero;
    return std::abs(value) > bound_ ? sign(value) : along_exactly(n);
  }
  /// n.r over the length of r, rounded: for `reaction` of many pairs.
  [[nodiscard]] double along_in_double(const Direction& n) const { return geometry::dot(n.unit(), scaled_); }
  /// The reaction of i when i and j press: sign of (i.j)(j.r) - (i.r)(j.j). Minus it is the sign of n_i.s when the
  /// block slides on j.
  [[nodiscard]] exact::Sign reaction(const Direction& i, const Direction& j) {
    return reaction(i, j, along_in_double(i), along_in_double(j));
  }
  [[nodiscard]] exact::Sign reaction(const Direction& i, const Direction& j, double along_i, double along_j) {
    const double value = geometry::dot(i.unit(), j.unit()) * along_j - along_i;
    if (std::abs(value) < (i.rounding() + 2 * j.rounding()) * length_) return exact::Sign::zero;
    return std::abs(value) > bound_ ? sign(value) : reaction_exactly(i, j);
  }
  /// (i x j).r
  [[nodiscard]] exact::Sign along_line(const Direction& i, const Direction& j) {
    const double value = geometry::dot(geometry::cross(i.unit(), j.unit()), scaled_);
    return std::abs(value) > bound_ ? sign(value) : along_line_exactly(i, j);
  }
  /// r parallel to n, in either sense.
  [[nodiscard]] bool parallel(const Direction& n);

  /// Whether any sign since the last call counted as zero only because of rounding.
  [[nodiscard]] bool take_tie() noexcept { return std::exchange(tie_, false); }

 private:
  [[nodiscard]] static exact::Sign sign(double value) {
    return value > 0 ? exact::Sign::positive : exact::Sign::negative;
  }
  /// What integers say when a double cannot: of an r with rounding errors, that it is a tie.
  [[nodiscard]] exact::Sign settle(exact::Sign exactly);
  [[nodiscard]] exact::Sign along_exactly(const Direction& n);
  [[nodiscard]] exact::Sign reaction_exactly(const Direction& i, const Direction& j);
  [[nodiscard]] exact::Sign along_line_exactly(const Direction& i, const Direction& j);

  /// Integers parallel to r; made when a sign first asks for them, which few do.
  [[nodiscard]] const std::array<exact::Int128, 3>& integer();
  [[nodiscard]] int integer_bits();

  geometry::Vec3 direction_;  ///< r
  geometry::Vec3 scaled_;     ///< r / scale
  double length_;             ///< of that
  bool exact_;
  double bound_;  ///< above it the sign of a double is that of the expression
  bool tie_ = false;
  std::optional<std::array<exact::Int128, 3>> integer_;
};

}  // namespace cleave::stability
