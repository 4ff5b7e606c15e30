#pragma once

#include <array>

#include "cleave/core/rng.hpp"
#include "cleave/exact/plane.hpp"

namespace cleave::testing {

using exact::LatticePoint;
using exact::Plane;
using exact::Sign;

/// Lattice points and planes for the tests of signs: spread over the whole lattice, or huddled so that they often
/// coincide, are parallel or share a point.
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

using Four = std::array<Plane, 4>;

/// Planes of all kinds: general, with small coefficients, through one point, through one point but for one site.
inline Four planes_of_kind(RandomPlanes& random, int kind) {
  const auto any = [&] { return random.plane(whole_lattice); };
  const auto small = [&] { return random.plane(1); };
  switch (kind) {
    case 0: return {any(), any(), any(), any()};
    case 1: return {small(), small(), small(), small()};
    case 2: {
      const LatticePoint a = random.point(whole_lattice / 2);
      const auto p = [&] { return random.plane_through(a, whole_lattice / 2); };
      return {p(), p(), p(), p()};
    }
    case 3: {
      const LatticePoint a = random.point(whole_lattice / 2);
      const auto p = [&] { return random.plane_through(a, whole_lattice / 2); };
      return {p(), p(), p(), random.plane_through(a + random.point(1), whole_lattice / 2)};
    }
    default: {  // nearly parallel: three planes of nearly equal corners
      const LatticePoint a = random.point(whole_lattice / 2), b = random.point(whole_lattice / 2),
                         c = random.point(whole_lattice / 2);
      const auto p = [&] {
        return Plane::through(a + random.point(2), b + random.point(2), c + random.point(2)).value();
      };
      return {p(), p(), p(), p()};
    }
  }
}

}  // namespace cleave::testing
