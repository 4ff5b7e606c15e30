#include "cleave/exact/plane.hpp"

#include <algorithm>
#include <cmath>

#include "cleave/core/assert.hpp"
#include "cleave/exact/predicates.hpp"
#include "cleave/exact/wide.hpp"

namespace cleave::exact {
namespace {

Int128 absolute(Int128 a) noexcept { return a < 0 ? -a : a; }

Int128 greatest_common_divisor(Int128 a, Int128 b) noexcept {
  a = absolute(a);
  b = absolute(b);
  while (b != 0) {
    if (a <= INT64_MAX && b <= INT64_MAX) {  // 64-bit division is much cheaper
      auto small_a = static_cast<std::uint64_t>(a);
      auto small_b = static_cast<std::uint64_t>(b);
      while (small_b != 0) {
        const std::uint64_t rest = small_a % small_b;
        small_a = small_b;
        small_b = rest;
      }
      return static_cast<Int128>(small_a);
    }
    const Int128 rest = a % b;
    a = b;
    b = rest;
  }
  return a;
}

Int192 dot(const std::array<Int128, 3>& a, LatticePoint b) noexcept {
  return Int192::product(a[0], b.x) + Int192::product(a[1], b.y) + Int192::product(a[2], b.z);
}

}  // namespace

std::optional<Plane> Plane::through(LatticePoint a, LatticePoint b, LatticePoint c) noexcept {
  return spanned(a, b - a, c - a);
}

std::optional<Plane> Plane::spanned(LatticePoint a, LatticePoint u, LatticePoint v) noexcept {
  const auto product = [](std::int64_t p, std::int64_t q) { return static_cast<Int128>(p) * q; };
  Plane plane;
  plane.normal_ = {product(u.y, v.z) - product(u.z, v.y), product(u.z, v.x) - product(u.x, v.z),
                   product(u.x, v.y) - product(u.y, v.x)};
  auto& n = plane.normal_;
  if (n[0] == 0 && n[1] == 0 && n[2] == 0) return std::nullopt;
  // A lattice point lies on the plane, so the common factor of the normal also divides the offset.
  const Int128 factor = greatest_common_divisor(greatest_common_divisor(n[0], n[1]), n[2]);
  if (factor > 1) {
    for (Int128& component : n) component /= factor;
  }
  plane.offset_ = -dot(n, a);
  plane.set_approx();
  return plane;
}

void Plane::set_approx() noexcept {
  const std::array<double, 3> n{static_cast<double>(normal_[0]), static_cast<double>(normal_[1]),
                                static_cast<double>(normal_[2])};
  const int exponent = std::ilogb(std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])}));
  for (std::size_t i = 0; i < 3; ++i) approx_[i] = std::ldexp(n[i], -exponent);
  approx_[3] = std::ldexp(offset_.as_double(), -exponent - 48);
}

std::optional<Plane> Plane::of_coefficients(const std::array<Int128, 3>& normal, const Int192& offset) noexcept {
  Int128 factor = 0;
  for (const Int128 component : normal) {
    if (component > (Int128{1} << 97) || component < -(Int128{1} << 97)) return std::nullopt;
    factor = greatest_common_divisor(factor, component);
  }
  if (factor != 1) return std::nullopt;  // 0: no normal
  const Int192 size = offset.negative() ? -offset : offset;
  if (size.negative() || (size.words[2] >> 18U) != 0) return std::nullopt;  // 146 bits
  Plane plane;
  plane.normal_ = normal;
  plane.offset_ = offset;
  plane.set_approx();
  return plane;
}

Plane Plane::flipped() const noexcept {
  Plane plane = *this;
  for (Int128& component : plane.normal_) component = -component;
  plane.offset_ = -plane.offset_;
  for (double& component : plane.approx_) component = -component;
  return plane;
}

std::array<double, 3> Plane::unit_normal() const noexcept {
  const double length = std::sqrt(approx_[0] * approx_[0] + approx_[1] * approx_[1] + approx_[2] * approx_[2]);
  return {approx_[0] / length, approx_[1] / length, approx_[2] / length};
}

Sign Plane::side_of(LatticePoint p) const noexcept {
  const double value = approx_[0] * std::ldexp(static_cast<double>(p.x), -48) +
                       approx_[1] * std::ldexp(static_cast<double>(p.y), -48) +
                       approx_[2] * std::ldexp(static_cast<double>(p.z), -48) + approx_[3];
  // |terms| <= 1, 1, 1, 3 and seven roundings: the error is below 64 u.
  if (const auto sign = sign_filtered(value, 64 * unit_roundoff)) return *sign;
  return sign_of(dot(normal_, p) + offset_);
}

bool Plane::coincides_with(const Plane& other) const noexcept { return *this == other || *this == other.flipped(); }

bool Plane::parallel_to(const Plane& other) const noexcept {
  // No common factors, so parallel normals are equal up to sign.
  const auto& a = normal_;
  const auto& b = other.normal_;
  return a == b || (a[0] == -b[0] && a[1] == -b[1] && a[2] == -b[2]);
}

Sign orientation(const Plane& a, const Plane& b, const Plane& c) noexcept {
  const PointApprox point = meet(line_of(a, b), c);
  if (const auto sign = det3_filtered(point)) return *sign;
  return det3_exact(a, b, c);
}

Sign dot_sign(const std::array<Int128, 3>& a, const std::array<Int128, 3>& b) noexcept {
  return sign_of<Int512>(Int512{a[0]} * Int512{b[0]} + Int512{a[1]} * Int512{b[1]} + Int512{a[2]} * Int512{b[2]});
}

Sign dot_sign(const std::array<Int128, 3>& a, LatticePoint b) noexcept { return sign_of(dot(a, b)); }

}  // namespace cleave::exact
