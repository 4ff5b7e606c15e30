#include "cleave/exact/fixed.hpp"

#include <cmath>

#include "cleave/exact/wide.hpp"

namespace cleave::exact {

std::optional<FixedPoint> fixed_meet(const Plane& p, const Plane& q, const Plane& r) noexcept {
  const ExactPoint point = exact_meet(exact_line(p, q), r);
  if (point.w == 0) return std::nullopt;
  const bool turned = point.w < 0;
  const Int512 w = turned ? Int512{-point.w} : point.w;
  FixedPoint out{};
  for (std::size_t k = 0; k < 3; ++k) {
    // Numerators have at most 343 bits: 407 with the 64 of the fraction.
    const Int512 x = (turned ? Int512{-point.x[k]} : point.x[k]) << 64U;
    Int512 quotient = x / w;
    if (x < 0 && quotient * w != x) --quotient;  // division cuts towards zero
    constexpr Int128 limit = Int128{1} << 126;
    if (quotient >= limit || quotient <= -limit) return std::nullopt;
    out[k] = static_cast<Int128>(quotient);
  }
  return out;
}

std::array<double, 3> as_position(const FixedPoint& point) noexcept {
  std::array<double, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) out[k] = std::ldexp(static_cast<double>(point[k]), -112);
  return out;
}

}  // namespace cleave::exact
