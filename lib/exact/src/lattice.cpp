#include "cleave/exact/plane.hpp"

#include <algorithm>
#include <cmath>

#include "cleave/core/assert.hpp"

namespace cleave::exact {

Lattice Lattice::covering(const std::array<double, 3>& lo, const std::array<double, 3>& hi) noexcept {
  double half = 0.0;
  for (std::size_t i = 0; i < 3; ++i) half = std::max(half, hi[i] / 2 - lo[i] / 2);
  if (!(half > 0)) half = 1.0;
  int exponent = 0;
  std::frexp(half, &exponent);  // half < 2^exponent
  const double pitch = std::ldexp(1.0, exponent - 46);
  // A coarse origin: its last bit is far above the pitch, so that x - origin is exact for every x near the scene.
  const double coarse = std::ldexp(1.0, exponent);
  std::array<double, 3> origin{};
  for (std::size_t i = 0; i < 3; ++i) {
    origin[i] = std::nearbyint((lo[i] / 2 + hi[i] / 2) / coarse) * coarse;
  }
  return {pitch, origin};
}

LatticePoint Lattice::snap(double x, double y, double z) const noexcept {
  const std::array<double, 3> p{x, y, z};
  std::array<std::int64_t, 3> site{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double steps = std::nearbyint((p[i] - origin_[i]) / pitch_);
    CLEAVE_ASSERT(std::abs(steps) <= 0x1p47);
    site[i] = static_cast<std::int64_t>(steps);
  }
  return {site[0], site[1], site[2]};
}

}  // namespace cleave::exact
