#pragma once

#include <array>

#include "cleave/core/rng.hpp"
#include "cleave/exact/plane.hpp"

namespace cleave::testing {

using exact::LatticePoint;
using exact::Plane;
using exact::Sign;

/// Lattice points and planes for the tests of signs: spread over the whole lattice, or huddled so that they often coincide,
/// are parallel or share a point.
class RandomPlanes final {
 public:
  explicit RandomPlanes(std::uint32_t key) : rng_{StreamKey{.seed = 3, .realization = key, .purpose = 5, .index = 0}} {}

  std::int64_t between(std::int64_t lo, std::int64_t hi) {
    return lo + static_cast<std::int64_t>(rng_.uniform() * static_cast<double>(hi - lo + 1));
  }
  LatticePoint point(std::int64_t reach) {
    const auto x = between(-reach, reach), y = between(-reach, reach), z = between(-reach, reach);
    return {x, y, z};
  }
  Plane plane(std::int64_t reach) {
    while (true) {
      const auto a = point(reach), b = point(reach), c = point(reach);
      if (auto p = Plane::through(a, b, c)) return *p;
    }
  }
  Plane plane_through(LatticePoint a, std::int64_t reach) {
    while (true) {
      const auto b = point(reach), c = point(reach);
      if (auto p = Plane::through(a, b, c)) return *p;
    }
  }

 private:
  Rng rng_;
};

inline constexpr std::int64_t whole_lattice = std::int64_t{1} << 47;

}  // namespace cleave::testing
