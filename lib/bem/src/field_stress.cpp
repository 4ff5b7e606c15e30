#include "field_stress.hpp"

#include <algorithm>
#include <cmath>

#include "cleave/core/assert.hpp"
#include "gauss.hpp"

namespace cleave::bem {

std::vector<FaceForces> forces_on_faces(const Solution& solution, std::size_t region,
                                        const std::vector<BlockFace>& faces) {
  const GaussRule& rule = gauss(16);
  std::vector<FaceForces> out;
  for (const BlockFace& face : faces) {
    const Vec2 span = face.b - face.a;
    const double length = norm(span);
    const Vec2 along = span / length;
    const Vec2 outward = turned_right(along);  // out of the block
    FaceForces f{.length = length};
    for (std::size_t k = 0; k < rule.s.size(); ++k) {
      const std::optional<Sym2> stress = solution.stress(region, face.a + (0.5 * (1 + rule.s[k])) * span);
      if (!stress) continue;  // in an opening: nothing acts there
      const Vec2 t = *stress * outward;
      const double w = 0.5 * length * rule.w[k];
      f.normal -= w * dot(t, outward);
      f.shear += w * dot(t, along);
    }
    out.push_back(f);
  }
  return out;
}

ClampedFactors factors_of_safety(const std::vector<BlockFace>& faces, const std::vector<FaceForces>& forces,
                                 Vec2 active) {
  CLEAVE_ASSERT(faces.size() == forces.size());
  const double driving = norm(active);
  if (driving == 0) return {INFINITY, INFINITY};
  const Vec2 motion = active / driving;
  ClampedFactors out;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const Vec2 along = (faces[k].b - faces[k].a) / forces[k].length;
    const double share = std::abs(dot(along, motion));  // of the strength that acts against the motion
    const double cohesion = faces[k].cohesion * forces[k].length;
    out.without += share * cohesion / driving;
    out.with += share * (cohesion + std::max(0.0, forces[k].normal) * std::tan(faces[k].friction)) / driving;
  }
  return out;
}

}  // namespace cleave::bem
