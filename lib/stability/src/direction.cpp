#include "cleave/stability/block_theory.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "cleave/core/assert.hpp"
#include "integers.hpp"

namespace cleave::stability {
namespace {

using exact::Int128;
using exact::Int512;
using exact::Sign;

int trailing_zeros(Int128 v) noexcept {  // v != 0
  const auto low = static_cast<std::uint64_t>(v);
  if (low != 0) return std::countr_zero(low);
  return 64 + std::countr_zero(static_cast<std::uint64_t>(v >> 64));
}

/// Binary algorithm; a, b >= 0, not both zero.
Int128 greatest_common_divisor(Int128 a, Int128 b) noexcept {
  if (a == 0) return b;
  if (b == 0) return a;
  const int za = trailing_zeros(a);
  const int zb = trailing_zeros(b);
  a >>= za;
  b >>= zb;
  while (a != b) {
    if (a < b) std::swap(a, b);
    a -= b;
    a >>= trailing_zeros(a);
  }
  return a << (za < zb ? za : zb);
}

template <class Integer>
Sign exact_orientation(const Direction& a, const Direction& b, const Direction& c) noexcept {
  const auto u = integers<Integer>(a.components());
  const auto v = integers<Integer>(b.components());
  const auto w = integers<Integer>(c.components());
  return exact::sign_of(dot3<Integer>(cross3<Integer>(u, v), w));
}

}  // namespace

Direction Direction::reduced(Components components) noexcept {
  Int128 divisor = 0;
  for (const Int128 c : components) divisor = greatest_common_divisor(divisor, magnitude(c));
  if (divisor != 1) {
    for (Int128& c : components) c /= divisor;
  }
  // Below 2^104 each: squares below 2^208, far from overflow. Each conversion rounds once.
  const geometry::Vec3 v{static_cast<double>(components[0]), static_cast<double>(components[1]),
                         static_cast<double>(components[2])};
  return {components, geometry::normalized(v)};
}

Direction Direction::normal_of(const exact::Plane& plane) noexcept { return reduced(plane.normal()); }

std::optional<Direction> Direction::make(const Components& components) noexcept {
  constexpr Int128 limit = Int128{1} << 104;
  bool zero = true;
  for (const Int128 c : components) {
    if (c >= limit || c <= -limit) return std::nullopt;
    zero = zero && c == 0;
  }
  if (zero) return std::nullopt;
  return reduced(components);
}

Direction Direction::opposite() const noexcept {
  return Direction{{-components_[0], -components_[1], -components_[2]}, -unit_}.turned_by(rounding_);
}

Direction Direction::turned_by(double rounding) const noexcept {
  Direction turned = *this;
  turned.rounding_ = rounding;
  return turned;
}

bool Direction::opposite_to(const Direction& other) const noexcept {
  return components_[0] == -other.components_[0] && components_[1] == -other.components_[1] &&
         components_[2] == -other.components_[2];
}

Sign orientation(const Direction& a, const Direction& b, const Direction& c) noexcept {
  // Each of the six products carries 15 u of its three factors (u = 2^-53) and 5 u of the operations; the sum of their
  // absolute values is at most the product of the rows' 1-norms, 3 sqrt 3. 20 * 5.2 u < 2^-46.
  const double value = geometry::dot(geometry::cross(a.unit(), b.unit()), c.unit());
  if (std::abs(value) <= a.rounding() + b.rounding() + c.rounding()) {
    const double turned = a.rounding() * geometry::norm(geometry::cross(b.unit(), c.unit())) +
                          b.rounding() * geometry::norm(geometry::cross(a.unit(), c.unit())) +
                          c.rounding() * geometry::norm(geometry::cross(a.unit(), b.unit()));
    if (std::abs(value) < turned) return Sign::zero;
  }
  if (std::abs(value) > 0x1p-46) return value > 0 ? Sign::positive : Sign::negative;
  if (bits(a.components()) + bits(b.components()) + bits(c.components()) + 3 < 127) {
    return exact_orientation<Int128>(a, b, c);
  }
  return exact_orientation<Int512>(a, b, c);
}

geometry::Vec3 cross(const Direction& a, const Direction& b) noexcept {
  // Far from parallel, doubles lose little: each component is 12 u off, the length is 0.5 at least.
  const geometry::Vec3 plain = geometry::cross(a.unit(), b.unit());
  if (geometry::dot(plain, plain) > 0.25) return plain;
  const auto u = integers<Int512>(a.components());
  const auto v = integers<Int512>(b.components());
  const auto e = cross3<Int512>(u, v);
  const auto length = [](const Direction::Components& c) {
    return geometry::norm({static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])});
  };
  const double la = length(a.components());
  const double lb = length(b.components());
  const auto scaled = [&](const Int512& w) { return w.convert_to<double>() / la / lb; };
  return {scaled(e[0]), scaled(e[1]), scaled(e[2])};
}

}  // namespace cleave::stability
