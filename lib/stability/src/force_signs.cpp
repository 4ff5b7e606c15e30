#include "force_signs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "integers.hpp"

namespace cleave::stability {
namespace {

using exact::Int128;
using exact::Int512;
using exact::Sign;

// Bounds, with u = 2^-53, unit normals (each component 5 u off) and |r| <= 1 (each component 2 u off):
//   n.r                       13 u
//   (i.j)(j.r) - (i.r)        13 u + 13 u + 13 u + 3 u
//   (i x j).r                 6 products, sum <= 3 sqrt 3, each 12 u + 5 u: 89 u
//   n x r                     10 u a component
// all below 2^-46 = 128 u. An inexact r adds its own error times at most 2 for the second and 3 sqrt 3 for the third.
constexpr double filter_bound = 0x1p-46;
constexpr double uncertainty_bound = 0x1p-44;

/// Integers parallel to a vector of doubles, at most 101 bits; parts below 2^-100 of the largest component are dropped.
std::array<Int128, 3> integers_along(geometry::Vec3 v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  int exponent = 0;
  std::frexp(largest, &exponent);
  const auto integer = [&](double c) { return static_cast<Int128>(std::ldexp(c, 100 - exponent)); };
  std::array<Int128, 3> result{integer(v.x), integer(v.y), integer(v.z)};
  // Shorter numbers, same direction: most forces are along an axis.
  const Int128 all = result[0] | result[1] | result[2];
  const auto low = static_cast<std::uint64_t>(all);
  const int shift = low != 0 ? std::countr_zero(low) : 64 + std::countr_zero(static_cast<std::uint64_t>(all >> 64));
  for (Int128& c : result) c >>= shift;
  return result;
}

template <class Integer>
Sign exact_reaction(const Direction& i, const Direction& j, const std::array<Int128, 3>& force) {
  const auto a = integers<Integer>(i.components());
  const auto b = integers<Integer>(j.components());
  const auto r = integers<Integer>(force);
  const Integer left = dot3<Integer>(a, b) * dot3<Integer>(b, r);
  const Integer right = dot3<Integer>(a, r) * dot3<Integer>(b, b);
  return exact::sign_of<Integer>(left - right);
}

template <class Integer>
Sign exact_line(const Direction& i, const Direction& j, const std::array<Int128, 3>& force) {
  return exact::sign_of<Integer>(dot3<Integer>(
      cross3<Integer>(integers<Integer>(i.components()), integers<Integer>(j.components())), integers<Integer>(force)));
}

}  // namespace

ForceSigns::ForceSigns(const Resultant& resultant)
    : direction_{resultant.direction()}, exact_{resultant.exact()}, bound_{exact_ ? filter_bound : uncertainty_bound} {
  const geometry::Vec3 r = direction_;
  // A direction given exactly is its own measure; else rounding is relative to the sum of what was added.
  const double scale = exact_ ? geometry::norm(r) : std::max(resultant.scale(), geometry::norm(r));
  scaled_ = r / scale;
  length_ = geometry::norm(scaled_);
}

const std::array<Int128, 3>& ForceSigns::integer() {
  if (!integer_) integer_ = integers_along(direction_);
  return *integer_;
}

int ForceSigns::integer_bits() { return bits(integer()); }

Sign ForceSigns::settle(Sign exactly) {
  if (exact_ || exactly == Sign::zero) return exactly;
  tie_ = true;
  return Sign::zero;
}

Sign ForceSigns::along_exactly(const Direction& n) {
  // 104 + 101 bits: too long for 128 in general.
  return settle(exact::sign_of<Int512>(dot3<Int512>(integers<Int512>(n.components()), integers<Int512>(integer()))));
}

Sign ForceSigns::reaction_exactly(const Direction& i, const Direction& j) {
  if (bits(i.components()) + 2 * bits(j.components()) + integer_bits() + 5 < 127) {
    return settle(exact_reaction<Int128>(i, j, integer()));
  }
  return settle(exact_reaction<Int512>(i, j, integer()));
}

Sign ForceSigns::along_line_exactly(const Direction& i, const Direction& j) {
  if (bits(i.components()) + bits(j.components()) + integer_bits() + 3 < 127) {
    return settle(exact_line<Int128>(i, j, integer()));
  }
  return settle(exact_line<Int512>(i, j, integer()));
}

bool ForceSigns::parallel(const Direction& n) {
  const geometry::Vec3 c = geometry::cross(n.unit(), scaled_);
  const std::array<double, 3> value{c.x, c.y, c.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (std::abs(value[axis]) > bound_) return false;
    const Int512 exactly = cross3<Int512>(integers<Int512>(n.components()), integers<Int512>(integer()))[axis];
    if (settle(exact::sign_of<Int512>(exactly)) != Sign::zero) return false;
  }
  return true;
}

}  // namespace cleave::stability
