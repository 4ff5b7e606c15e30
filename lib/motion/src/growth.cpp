#include "growth.hpp"

#include <algorithm>
#include <cstddef>

#include "judge.hpp"

namespace cleave::motion {

using Eigen::Vector3d;

bool grow_friction(Scaled& scaled, Unknowns& x, const Moves& moves) {
  constexpr int shares = 16, sweeps = 60;
  std::vector<double> friction;
  for (const auto& e : scaled.elements) friction.push_back(e.mu);
  bool goes_on = true;
  for (int share = 1; share <= shares && goes_on; ++share) {
    for (std::size_t e = 0; e < friction.size(); ++e) scaled.elements[e].mu = share * friction[e] / shares;
    sweep(scaled, x, sweeps);
    goes_on = moves(x);
  }
  for (std::size_t e = 0; e < friction.size(); ++e) scaled.elements[e].mu = friction[e];
  return goes_on;
}

Alone alone(const Group& group, std::uint32_t body, const std::vector<Vector6>& velocity) {
  Alone out;
  out.group.mass = {group.mass[body]};
  out.group.free = {group.free[body]};
  for (std::size_t k = 0; k < group.points.size(); ++k) {
    Point p = group.points[k];
    const bool first = p.body == body;
    if (!first && p.other != body) continue;
    if (p.other) p.b += (first ? p.on_other : p.on_body).transpose() * velocity[first ? *p.other : p.body];
    if (!first) p.on_body = p.on_other;
    p.body = 0;
    p.other.reset();
    p.on_other.setZero();
    out.group.points.push_back(p);
    out.from.push_back(k);
  }
  return out;
}

Unknowns moving_alone(const Group& own) {
  Scaled scaled{own};
  Unknowns x(own.points.size(), Vector3d::Zero());
  if (!(scaled.unit > 0)) return {};
  const auto impulses = [&](const Unknowns& at) {
    Unknowns out;
    for (std::size_t k = 0; k < at.size(); ++k) out.emplace_back(at[k] * scaled.elements[k].scale);
    return out;
  };
  const auto moves = [&](const Unknowns& at) {
    constexpr double barely = 1e-4;  // of free motion: less may be what sweeps leave
    return respond(own, impulses(at)).velocity[0].norm() > barely * own.free[0].norm();
  };
  return grow_friction(scaled, x, moves) ? impulses(x) : Unknowns{};
}

}  // namespace cleave::motion
