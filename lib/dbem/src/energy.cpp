#include "world_impl.hpp"

namespace cleave::dbem {

double WorldState::kinetic_of(const State& at) const {
  double sum = 0;
  for (std::size_t b = 0; b < size(); ++b) {
    if (shapes[b].fixed) continue;
    sum += 0.5 * shapes[b].mass * dot(at.v[b], at.v[b]) + 0.5 * shapes[b].inertia * at.spin[b] * at.spin[b];
  }
  for (const double de : at.de) sum += 0.5 * de * de;
  return sum;
}

double JointState::elastic_of(const State& at, const std::vector<CachedContact>& forces) const {
  double sum = 0;
  for (std::size_t b = 0; b < size(); ++b) {
    for (std::size_t m = 0; m < shapes[b].modes; ++m) {
      const double w = bodies[b].modes->omega[m] * at.e[first_mode[b] + m];
      sum += 0.5 * w * w;
    }
  }
  sum += elastic_of_ties();
  for (const CachedContact& memory_of : forces) {
    const Vec2 soft = memory_of.compliance, force = memory_of.force;
    sum += 0.5 * (soft.x * force.x * force.x + soft.y * force.y * force.y);
  }
  return sum;
}

double WorldState::potential_of(const State& at) const {
  double sum = 0;
  for (std::size_t b = 0; b < size(); ++b) {
    if (!shapes[b].fixed) sum -= shapes[b].mass * dot(options.gravity, at.x[b] - start_x[b]);
  }
  return sum;
}

double ContactSolve::energy_brought_in(const std::vector<ContactCandidate>& list, const Island& island,
                                       const Rows& rows, const ContactSolution& found, const State& after) const {
  if (island.theta < 1) return 0;
  double gain = 0, size = 0;
  for (std::size_t k = 0; k < island.touches.size(); ++k) {
    const ContactCandidate& touch = list[island.touches[k]];
    if (touch.tie != no_tie) continue;
    if (law_of(touch).restitution > 0 || compliance_of(touch) != Vec2{}) return 0;
    gain += dot(found.impulse[k], velocity_of(rows, k, after));
  }
  for (const std::uint32_t b : island.bodies) {
    size += shapes[b].mass * (dot(state.v[b], state.v[b]) + shapes[b].feature * norm(options.gravity));
  }
  return size > 0 ? gain / size : 0;
}

}  // namespace cleave::dbem
