#pragma once

#include <boost/multiprecision/cpp_int.hpp>

namespace cleave::exact {

/// Fixed 512-bit signed integer without heap: every determinant of the cutter fits (design: <= 480 bits).
using Wide = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<512, 512, boost::multiprecision::signed_magnitude,
                                           boost::multiprecision::unchecked, void>,
    boost::multiprecision::et_off>;

__extension__ using Int128 = __int128;  ///< g++ and clang both have it; the components of a plane's normal fit in it

}  // namespace cleave::exact
