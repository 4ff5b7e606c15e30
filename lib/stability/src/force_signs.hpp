#pragma once

#include <array>
#include <optional>
#include <utility>

#include "cleave/exact/sign.hpp"
#include "cleave/exact/wide.hpp"
#include "cleave/stability/direction.hpp"
#include "cleave/stability/motion.hpp"

namespace cleave::stability {

/// Signs of expressions linear in the resultant r: double first, with a proven bound; then integers. Normals are exact;
/// r is exact, or known to a rounding error: then a sign that this error could turn is zero, and `tie` remembers it.
class ForceSigns final {
 public:
  /// `resultant` must not be zero.
  explicit ForceSigns(const Resultant& resultant);

  /// n.r
  [[nodiscard]] exact::Sign along(const Direction& n);
  /// The reaction of i when i and j press: sign of (i.j)(j.r) - (i.r)(j.j). Minus it is the sign of n_i.s when the
  /// block slides on j.
  [[nodiscard]] exact::Sign reaction(const Direction& i, const Direction& j);
  /// (i x j).r
  [[nodiscard]] exact::Sign along_line(const Direction& i, const Direction& j);
  /// r parallel to n, in either sense.
  [[nodiscard]] bool parallel(const Direction& n);

  /// Whether any sign since the last call counted as zero only because of rounding.
  [[nodiscard]] bool take_tie() noexcept { return std::exchange(tie_, false); }

 private:
  template <class Exact>
  [[nodiscard]] exact::Sign decide(double value, Exact exact_sign);

  /// Integers parallel to r; made when a sign first asks for them, which few do.
  [[nodiscard]] const std::array<exact::Int128, 3>& integer();
  [[nodiscard]] int integer_bits();

  geometry::Vec3 direction_;  ///< r
  geometry::Vec3 scaled_;     ///< r / scale
  bool exact_;
  bool tie_ = false;
  std::optional<std::array<exact::Int128, 3>> integer_;
};

}  // namespace cleave::stability
