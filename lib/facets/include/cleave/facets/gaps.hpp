#pragma once

#include <cstdint>
#include <vector>

#include "cleave/facets/prepared.hpp"

namespace cleave::topology::detail {

/// What is nearer than this share of the domain's extent nearly meets.
inline constexpr double near_miss = 1e-6;

/// Sides of joints that end just short of another polygon.
struct Gaps {
  std::uint64_t sides = 0;
  double largest = 0;                 ///< units of 2^48 sites
  Index first = none, second = none;  ///< facets of the largest
  std::vector<Ending> endings;        ///< those that miss by roundings only

  void add(const Gaps& other);
};

/// Tells pairs of facets that nearly meet from those that are apart.
class GapFinder final {
 public:
  explicit GapFinder(const Prepared& prepared) noexcept;

  /// Within this of each other facets nearly meet; units.
  [[nodiscard]] double limit() const noexcept { return limit_; }
  /// Of two facets without a point in common.
  void look(Index i, Index j, Gaps& found) const;

 private:
  const Prepared& prepared_;
  double limit_;
};

}  // namespace cleave::topology::detail
