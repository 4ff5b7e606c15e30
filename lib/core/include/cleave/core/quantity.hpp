#pragma once

#include <compare>
#include <numbers>

namespace cleave {

/// A number with the dimension length^L mass^M time^T, kept in SI units.
///
/// Dimensions are checked when multiplied, divided, added and compared; a bare double never converts by accident.
template <int L, int M, int T>
class Quantity final {
 public:
  constexpr Quantity() noexcept = default;
  [[nodiscard]] static constexpr Quantity from_si(double value) noexcept {
    Quantity q;
    q.value_ = value;
    return q;
  }
  /// The value in SI base units (m, m2, m3, kg/m3, N, Pa, ...).
  [[nodiscard]] constexpr double si() const noexcept { return value_; }

  friend constexpr auto operator<=>(Quantity, Quantity) noexcept = default;
  friend constexpr bool operator==(Quantity, Quantity) noexcept = default;
  friend constexpr Quantity operator+(Quantity a, Quantity b) noexcept { return from_si(a.value_ + b.value_); }
  friend constexpr Quantity operator-(Quantity a, Quantity b) noexcept { return from_si(a.value_ - b.value_); }
  friend constexpr Quantity operator-(Quantity a) noexcept { return from_si(-a.value_); }
  friend constexpr Quantity operator*(Quantity a, double s) noexcept { return from_si(a.value_ * s); }
  friend constexpr Quantity operator*(double s, Quantity a) noexcept { return from_si(s * a.value_); }
  friend constexpr Quantity operator/(Quantity a, double s) noexcept { return from_si(a.value_ / s); }
  constexpr Quantity& operator+=(Quantity b) noexcept {
    value_ += b.value_;
    return *this;
  }
  constexpr Quantity& operator-=(Quantity b) noexcept {
    value_ -= b.value_;
    return *this;
  }
  constexpr Quantity& operator*=(double s) noexcept {
    value_ *= s;
    return *this;
  }

 private:
  double value_ = 0.0;
};

template <int L, int M, int T, int L2, int M2, int T2>
[[nodiscard]] constexpr auto operator*(Quantity<L, M, T> a, Quantity<L2, M2, T2> b) noexcept {
  return Quantity<L + L2, M + M2, T + T2>::from_si(a.si() * b.si());
}
template <int L, int M, int T, int L2, int M2, int T2>
[[nodiscard]] constexpr auto operator/(Quantity<L, M, T> a, Quantity<L2, M2, T2> b) noexcept {
  return Quantity<L - L2, M - M2, T - T2>::from_si(a.si() / b.si());
}
template <int L, int M, int T>
[[nodiscard]] constexpr double operator/(Quantity<L, M, T> a, Quantity<L, M, T> b) noexcept {
  return a.si() / b.si();
}

using Length = Quantity<1, 0, 0>;
using Area = Quantity<2, 0, 0>;
using Volume = Quantity<3, 0, 0>;
using Density = Quantity<-3, 1, 0>;
using Acceleration = Quantity<1, 0, -2>;
using Force = Quantity<1, 1, -2>;
using Stress = Quantity<-1, 1, -2>;
using ForcePerLength = Quantity<0, 1, -2>;  ///< N/m
using UnitWeight = Quantity<-2, 1, -2>;     ///< N/m3
using Stiffness = Quantity<-2, 1, -2>;      ///< Pa/m, of a joint: stress over displacement
using Time = Quantity<0, 0, 1>;
using FlowRate = Quantity<3, 0, -1>;        ///< m3/s
using Transmissivity = Quantity<2, 0, -1>;  ///< m2/s; of a kinematic viscosity, too

[[nodiscard]] constexpr Length metres(double v) noexcept { return Length::from_si(v); }
[[nodiscard]] constexpr Area square_metres(double v) noexcept { return Area::from_si(v); }
[[nodiscard]] constexpr Volume cubic_metres(double v) noexcept { return Volume::from_si(v); }
[[nodiscard]] constexpr Density kilograms_per_cubic_metre(double v) noexcept { return Density::from_si(v); }
[[nodiscard]] constexpr Acceleration metres_per_second_squared(double v) noexcept { return Acceleration::from_si(v); }
[[nodiscard]] constexpr Force newtons(double v) noexcept { return Force::from_si(v); }
[[nodiscard]] constexpr Stress pascals(double v) noexcept { return Stress::from_si(v); }
[[nodiscard]] constexpr ForcePerLength newtons_per_metre(double v) noexcept { return ForcePerLength::from_si(v); }
[[nodiscard]] constexpr UnitWeight newtons_per_cubic_metre(double v) noexcept { return UnitWeight::from_si(v); }
[[nodiscard]] constexpr Stiffness pascals_per_metre(double v) noexcept { return Stiffness::from_si(v); }
[[nodiscard]] constexpr Time seconds(double v) noexcept { return Time::from_si(v); }

/// An angle of one kind (a dip is not a friction angle); made from degrees or radians, never from a bare double.
template <class Kind>
class Angle final {
 public:
  constexpr Angle() noexcept = default;
  [[nodiscard]] static constexpr Angle degrees(double v) noexcept {
    Angle a;
    a.degrees_ = v;
    return a;
  }
  [[nodiscard]] static constexpr Angle radians(double v) noexcept { return degrees(v * (180.0 / std::numbers::pi)); }
  [[nodiscard]] constexpr double degrees() const noexcept { return degrees_; }
  [[nodiscard]] constexpr double radians() const noexcept { return degrees_ * (std::numbers::pi / 180.0); }
  friend constexpr auto operator<=>(Angle, Angle) noexcept = default;
  friend constexpr bool operator==(Angle, Angle) noexcept = default;

 private:
  double degrees_ = 0.0;
};

struct DipKind;
struct DipDirectionKind;
struct FrictionKind;
using Dip = Angle<DipKind>;                    ///< 0..90 from horizontal
using DipDirection = Angle<DipDirectionKind>;  ///< 0..360 clockwise from north (+y)
using FrictionAngle = Angle<FrictionKind>;     ///< [0, 90)

}  // namespace cleave
