#pragma once

#include <array>
#include <boost/multiprecision/cpp_int.hpp>

#include "detail/phases.hpp"

namespace cleave::topology::detail {

using Rational = boost::multiprecision::cpp_rational;
using RationalPoint = std::array<Rational, 3>;

/// Where a vertex is, sites; exact.
[[nodiscard]] RationalPoint rational_position(const Prepared& prepared, const Meet& planes);

}  // namespace cleave::topology::detail
