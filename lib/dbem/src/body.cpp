#include "cleave/dbem/body.hpp"

namespace cleave::dbem {

const JointLaw& Laws::of(std::size_t property_a, std::size_t property_b) const noexcept {
  for (const PairLaw& pair : pairs) {
    if ((pair.a == property_a && pair.b == property_b) || (pair.a == property_b && pair.b == property_a)) {
      return pair.law;
    }
  }
  return otherwise;
}

PolygonMoments polygon_moments(const std::vector<Vec2>& corners) {
  PolygonMoments m;
  if (corners.size() < 3) return m;
  const Vec2 origin = corners.front();  // differences only: nothing is lost far from zero
  Vec2 first{};
  const auto each = [&](auto&& use) {
    for (std::size_t k = 0; k < corners.size(); ++k) {
      use(corners[k] - origin, corners[k + 1 == corners.size() ? 0 : k + 1] - origin);
    }
  };
  each([&](Vec2 a, Vec2 b) {
    const double c = cross(a, b);
    m.area += c / 2;
    first += (c / 6) * (a + b);
  });
  if (m.area == 0) return m;
  const Vec2 centre = first / m.area;
  each([&](Vec2 a, Vec2 b) {
    const Vec2 p = a - centre;
    const Vec2 q = b - centre;
    m.polar += cross(p, q) * (dot(p, p) + dot(p, q) + dot(q, q)) / 12;
  });
  m.centroid = origin + centre;
  return m;
}

}  // namespace cleave::dbem
