#pragma once

#include <boost/multiprecision/cpp_int.hpp>

#include "cleave/exact/integer.hpp"
#include "cleave/exact/plane.hpp"

namespace cleave::exact {

/// Fixed 512-bit signed integer without heap: every determinant of the cutter fits (design: <= 480 bits).
///
/// For source files only: no public header includes this one, for it brings some 600 headers of Boost with it.
using Int512 = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<512, 512, boost::multiprecision::signed_magnitude,
                                           boost::multiprecision::unchecked, void>,
    boost::multiprecision::et_off>;

[[nodiscard]] Int512 widened(const Int192& value) noexcept;

/// The line of two planes and the meet of three in integers.
struct ExactLine {
  std::array<Int512, 3> m, w;
};
struct ExactPoint {
  std::array<Int512, 3> x;
  Int512 w;
};
[[nodiscard]] ExactLine exact_line(const Plane& p, const Plane& q) noexcept;
[[nodiscard]] ExactPoint exact_meet(const ExactLine& line, const Plane& r) noexcept;

}  // namespace cleave::exact
