#pragma once

/// Random single blocks and what key block theory says of them.

#include <algorithm>
#include <cmath>
#include <vector>

#include "builder.hpp"
#include "cleave/core/rng.hpp"

namespace cleave::assembly::test {

inline std::vector<Side> random_sides(Rng& rng) {
  const auto number = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(rng.between(0, 1 << 30)) / static_cast<double>(1 << 30);
  };
  const auto count = rng.between(1, 4);
  std::vector<Side> sides;
  for (int k = 0; k < count; ++k) {
    Vec3 n{number(-1, 1), number(-1, 1), number(-1, 1)};
    if (norm(n) < 0.1) n = {1, 0, 0};
    sides.push_back({normalized(n), number(0.1, 1.2)});
  }
  return sides;
}

/// Key block theory of a block on two planes, in closed form (Goodman and Shi 1985, with true reactions).
inline double conventional(const std::vector<Side>& sides, Vec3 r) {
  const auto fits = [&](Vec3 s) {
    return std::ranges::all_of(sides, [&](const Side& k) { return dot(k.normal, s) >= -1e-12 * norm(r); });
  };
  if (fits(r)) return 0;
  for (const Side& k : sides) {
    const double n = -dot(k.normal, r);
    const Vec3 s = r + n * k.normal;
    if (n > 0 && norm(s) > 1e-12 && fits(s)) return n * k.friction / norm(s);
  }
  for (std::size_t i = 0; i < sides.size(); ++i) {
    for (std::size_t j = i + 1; j < sides.size(); ++j) {
      const double a = dot(sides[i].normal, r), b = dot(sides[j].normal, r), c = dot(sides[i].normal, sides[j].normal);
      const double q = 1 - c * c, ni = (c * b - a) / q, nj = (c * a - b) / q;
      const Vec3 e = normalized(cross(sides[i].normal, sides[j].normal));
      const Vec3 s = dot(e, r) * e;
      if (q > 1e-9 && ni >= 0 && nj >= 0 && norm(s) > 1e-12 && fits(s)) {
        return (ni * sides[i].friction + nj * sides[j].friction) / norm(s);
      }
    }
  }
  return infinite;
}

}  // namespace cleave::assembly::test
