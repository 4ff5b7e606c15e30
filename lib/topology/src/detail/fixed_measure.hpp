#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "cleave/exact/fixed.hpp"
#include "cleave/exact/wide.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::topology::detail {

/// Volume and first moment of a closed surface of triangles, in integers, from corners good to 2^-64 of a site: for
/// what is too thin for doubles. Each triangle costs the same however many there are.
class FixedMeasure final {
 public:
  /// `apex`: a point near by; the surface may lie anywhere.
  explicit FixedMeasure(const exact::FixedPoint& apex) noexcept : apex_{apex} {}

  /// Counter-clockwise seen from outside.
  void add(const exact::FixedPoint& a, const exact::FixedPoint& b, const exact::FixedPoint& c);

  /// Sign of the volume; empty when it is smaller than what the rounding of the corners may do.
  [[nodiscard]] std::optional<exact::Sign> sign() const;
  /// Of the corners as they are rounded; units^3, a unit is 2^48 sites.
  [[nodiscard]] double volume() const;
  /// Units. Empty where the volume is not positive.
  [[nodiscard]] std::optional<geometry::Vec3> centroid() const;

 private:
  exact::FixedPoint apex_;
  exact::Int512 six_volumes_ = 0;
  std::array<exact::Int512, 3> moment_{};  ///< 24 times, about the apex
  exact::Int128 reach_ = 0;                ///< the largest component of a corner, from the apex
  std::uint64_t triangles_ = 0;
};

}  // namespace cleave::topology::detail
