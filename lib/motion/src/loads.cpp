#include <cmath>
#include <utility>

#include "cleave/geometry/flat_integrals.hpp"
#include "world_impl.hpp"

/// Forces beside weight and contacts: loads at points, and water at rest.
namespace cleave::motion {

void World::Impl::add_load(const Load& load) {
  const auto number = static_cast<std::uint32_t>(loads.size());
  loads_on[load.body].push_back(number);
  if (load.other) loads_on[*load.other].push_back(number);
  loads.push_back({load});
}

std::pair<Vec3, Vec3> World::Impl::points_of(const Load& load, const std::vector<State>& s) const {
  const auto at = [&](std::uint32_t b) { return centroid(s[b], b) + s[b].turn * (load.at - shapes[b].centroid); };
  return {at(load.body), load.other ? at(*load.other) : load.at};
}

Vec3 World::Impl::force_of(const Load& load, const std::vector<State>& s) const {
  return load.other ? s[*load.other].turn * load.force : load.force;
}

Wrench World::Impl::lift_of(std::uint32_t b, const State& s) const {
  Wrench out;
  if (!water) return out;
  const Vec3 middle = centroid(s, b);
  // Pressure over the skin; borders between cells cancel.
  const geometry::LinearPressure pressure{water->unit_weight.si(), water->level.si() - dot(water->up, middle),
                                          water->up};
  if (pressure.level + shapes[b].radius <= 0) return out;
  geometry::Convex corners;
  for (std::uint32_t c = shapes[b].first_cell; c < shapes[b].last_cell; ++c) {
    const Cell& cell = (*cells)[c];
    for (const Side& side : cell.sides) {
      corners.clear();
      for (const std::uint32_t v : side.corners) corners.push_back(s.turn * cell.vertices[v]);
      const geometry::Moments pushed = geometry::integrate(corners, pressure);
      const Vec3 in = -(s.turn * side.normal);
      out.force += pushed.total * in;
      out.moment += cross(pushed.first, in);
    }
  }
  return out;
}

Wrench World::Impl::loads_of(std::uint32_t b, const std::vector<State>& s) const {
  Wrench out = lift_of(b, s[b]);
  for (const std::uint32_t k : loads_on[b]) {
    const Load& load = loads[k].load;
    if (loads[k].gone) continue;
    const auto [own, other] = points_of(load, s);
    const Vec3 at = load.other ? 0.5 * (own + other) : own;
    const Vec3 force = load.body == b ? force_of(load, s) : -force_of(load, s);
    out.force += force;
    out.moment += cross(at - centroid(s[b], b), force);
  }
  return out;
}

Vector6 World::Impl::kick_of(std::uint32_t b, const std::vector<State>& mid, double step) const {
  const Wrench more = loads_of(b, mid);
  const Vec3 faster = step * (pull + more.force / shapes[b].mass);
  const Vec3 spun = step * (mid[b].turn * solve(shapes[b].inertia, mid[b].turn.back(more.moment)));
  Vector6 out;
  out << faster.x, faster.y, faster.z, spun.x, spun.y, spun.z;
  return out;
}

double World::Impl::hurry_of(std::uint32_t b) const {
  if (!water && loads_on[b].empty()) return strongest();
  const Wrench more = loads_of(b, state);
  return strongest() + norm(more.force) / shapes[b].mass +
         shapes[b].radius * norm(solve(shapes[b].inertia, state[b].turn.back(more.moment)));
}

double World::Impl::work_of_loads(const std::vector<State>& mid, const std::vector<State>& after, double step) const {
  double work = 0;
  for (std::uint32_t b = 0; b < shapes.size(); ++b) {
    if (!moves(b) || (!water && loads_on[b].empty())) continue;
    const Wrench more = loads_of(b, mid);
    const double late = theta_of(b);
    work += step * (dot(more.force, (1 - late) * mid[b].v + late * after[b].v) +
                    dot(more.moment, (1 - late) * spin(mid[b], b) + late * spin(after[b], b)));
  }
  return work;
}

void World::Impl::end_loads(std::vector<std::uint32_t>& freed) {
  for (auto& [load, gone] : loads) {
    if (gone || (std::isinf(load.opens.si()) && std::isinf(load.slides.si()))) continue;
    const auto [own, other] = points_of(load, state);
    const Vec3 apart = own - other, along = normalized(force_of(load, state));
    const double open = dot(apart, along);
    gone = std::abs(open) > load.opens.si() || norm(apart - open * along) > load.slides.si();
    if (!gone) continue;
    freed.push_back(load.body);
    if (load.other) freed.push_back(*load.other);
  }
}

bool World::load_gone(std::size_t number) const { return impl_->loads[number].gone; }

}  // namespace cleave::motion
