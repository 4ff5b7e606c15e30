#pragma once

#include <array>
#include <optional>

#include "cleave/exact/integer.hpp"
#include "cleave/exact/plane.hpp"
#include "cleave/exact/sign.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::stability {

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
};

/// Sign of (a x b) . c; exact, filtered.
[[nodiscard]] exact::Sign orientation(const Direction& a, const Direction& b, const Direction& c) noexcept;

/// a x b of the unit vectors, in double from the exact integers: accurate to a few ulp even for nearly parallel
/// directions.
[[nodiscard]] geometry::Vec3 cross(const Direction& a, const Direction& b) noexcept;

}  // namespace cleave::stability
