#include <algorithm>
#include <cmath>
#include <utility>

#include "hull.hpp"
#include "world_impl.hpp"

/// Bonds of patches: where they carry pressure, pull and shear, and when they give.
namespace cleave::motion {
Core core_of(const std::vector<Bond::Share>& patch, Vec3 normal) {
  Core out;
  const Frame frame = frame_of(normal);
  double area = 0;
  Vec3 middle;
  for (const Bond::Share& s : patch) {
    area += s.area;
    middle += s.area * s.point;
  }
  if (!(area > 0)) return out;
  middle = 1 / area * middle;
  std::vector<Flat> points;
  double xx = 0, xy = 0, yy = 0, size = 0;
  for (const Bond::Share& s : patch) {
    const Flat p{dot(frame.t1, s.point - middle), dot(frame.t2, s.point - middle)};
    points.push_back(p);
    xx += s.area / area * p.x * p.x;
    xy += s.area / area * p.x * p.y;
    yy += s.area / area * p.y * p.y;
    size = std::max(size, std::hypot(p.x, p.y));
  }
  const std::vector<std::uint32_t> hull = hull_of(points, 1e-9 * size);
  if (hull.size() < 3) return out;
  // Pressure that is none along a side a . x = 1 of the hull has its resultant at -S a, S the mean of x x^T. The sides
  // of a polygon add up to none, so triangles on them balance these points about the middle.
  double whole = 0;
  for (std::size_t k = 0; k < hull.size(); ++k) {
    const Flat p = points[hull[k]], q = points[hull[(k + 1) % hull.size()]];
    const double twice = p.x * q.y - p.y * q.x;
    if (!(twice > 0)) return {};
    const Flat a{(q.y - p.y) / twice, (p.x - q.x) / twice};
    const Flat at{-(xx * a.x + xy * a.y), -(xy * a.x + yy * a.y)};
    out.corners.push_back({middle + at.x * frame.t1 + at.y * frame.t2, twice});
    out.hull.push_back(middle + p.x * frame.t1 + p.y * frame.t2);
    whole += twice;
  }
  for (Bond::Share& s : out.corners) s.area *= area / whole;
  return out;
}

void World::Impl::add_bond(Bond bond) {
  BondState made{.bond = std::move(bond), .core = {}};
  const Bond& own = made.bond;
  made.pull = own.friction > 0 ? std::min(own.tension, own.cohesion / own.friction) : own.tension;
  if (made.pull > 0) made.core = core_of(own.patch.empty() ? own.shares : own.patch, own.normal);
  torn.push_back(made.core.corners.empty() ? 1 : 0);
  bonds.push_back(std::move(made));
}

std::uint32_t World::Impl::points_of(std::uint32_t bond) const {
  const BondState& own = bonds[bond];
  const auto shares = static_cast<std::uint32_t>(own.bond.shares.size());
  if (!pulls(bond)) return shares;
  const bool more = own.bond.cohesion > (1 + 1e-12) * own.bond.friction * own.pull;
  return static_cast<std::uint32_t>(own.core.corners.size()) + (more ? shares : 0);
}

BondPoint World::Impl::point_of(std::uint32_t bond, std::uint32_t number) const {
  const BondState& own = bonds[bond];
  if (!pulls(bond)) {
    const Bond::Share& s = own.bond.shares[number];
    return {s.point, own.bond.friction, own.bond.cohesion * s.area, 0, false};
  }
  const double at_apex = own.bond.friction * own.pull;
  if (number < own.core.corners.size()) {
    const Bond::Share& s = own.core.corners[number];
    return {s.point, own.bond.friction, at_apex * s.area, own.pull * s.area, false};
  }
  const Bond::Share& s = own.bond.shares[number - own.core.corners.size()];
  const double cohesion = (own.bond.cohesion - at_apex) * s.area;
  return {s.point, 0, cohesion, cohesion, true};
}

void World::Impl::set_law(std::uint32_t bond, std::uint32_t number, Vec3 normal, double step, Point& p) const {
  const BondPoint own = point_of(bond, number);
  p.mu = own.friction;
  p.cohesion = own.cohesion * step;
  p.tension = own.tension * step;
  p.shear = own.shear;
  if (own.shear) {
    p.on_body.col(0).setZero();
    p.on_other.col(0).setZero();
  }
  const std::vector<Vec3>& last = bonds[bond].impulse;
  if (last.size() != points_of(bond) || !(last_step > 0)) return;
  const Frame frame = frame_of(normal);
  const Vec3 impulse = step / last_step * last[number];
  p.start << dot(frame.n, impulse), dot(frame.t1, impulse), dot(frame.t2, impulse);
}

void World::Impl::drop_bonded(std::vector<Touch>& list, const std::vector<State>& s) const {
  std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>> by_pair;
  for (std::uint32_t k = 0; k < bonds.size(); ++k) {
    const Bond& b = bonds[k].bond;
    if (pulls(k)) by_pair.push_back({{std::min(b.body, b.other), std::max(b.body, b.other)}, k});
  }
  if (by_pair.empty()) return;
  std::ranges::sort(by_pair);
  std::erase_if(list, [&](const Touch& t) {
    const std::pair pair{std::min(t.body, t.other), std::max(t.body, t.other)};
    const auto own = std::ranges::equal_range(by_pair, pair, {}, [](const auto& entry) { return entry.first; });
    return std::ranges::any_of(own, [&](const auto& entry) {
      const Bond& bond = bonds[entry.second].bond;
      const std::vector<Vec3>& hull = bonds[entry.second].core.hull;
      const std::uint32_t b = bond.other;
      const Vec3 at = shapes[b].centroid + s[b].turn.back(t.point - centroid(s[b], b));
      const double near = 1e-4 * t.size;
      if (std::abs(dot(s[b].turn.back(t.normal), bond.normal)) < 0.999) return false;
      if (std::abs(dot(bond.normal, at - hull[0])) > near) return false;
      for (std::size_t k = 0; k < hull.size(); ++k) {
        const Vec3 side = hull[(k + 1) % hull.size()] - hull[k];
        if (dot(cross(bond.normal, side), at - hull[k]) < -near * norm(side)) return false;
      }
      return true;
    });
  });
}

std::pair<Vec3, Vec3> World::Impl::place_of(std::uint32_t bond, Vec3 at_start, const std::vector<State>& s) const {
  const auto [body, other] = std::pair{bonds[bond].bond.body, bonds[bond].bond.other};
  const auto at = [&](std::uint32_t b) { return centroid(s[b], b) + s[b].turn * (at_start - shapes[b].centroid); };
  return {0.5 * (at(body) + at(other)), s[other].turn * bonds[bond].bond.normal};
}

void World::Impl::note_bond(std::uint32_t bond, std::uint32_t number, const Eigen::Vector3d& impulse,
                            const Eigen::Vector3d& slip, const std::vector<State>& mid, double step,
                            Attempt& out) const {
  const Bond& own = bonds[bond].bond;
  const auto [at, normal] = place_of(bond, point_of(bond, number).at_start, mid);
  const Vec3 given = in_space(frame_of(normal), impulse);
  out.bond_impulse[bond].resize(points_of(bond));
  out.bond_impulse[bond][number] = given;
  if (pulls(bond)) {
    out.contacts.push_back({own.body, own.other, at, normal, 0, given / step, slip.tail<2>().norm(), true});
  }
  const auto note = [&](std::vector<std::uint32_t>& list) {
    if (list.empty() || list.back() != bond) list.push_back(bond);
  };
  const double loose = 1e-3 * step * strongest() + 1e-9;
  if (slip.cwiseAbs().maxCoeff() > loose && slip[0] > -loose) note(pulls(bond) ? out.torn : out.broken);
}

}  // namespace cleave::motion
