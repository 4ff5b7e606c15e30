#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "world_impl.hpp"

/// Bonds of the joints that are closed at the start, and the sections that carry them.
namespace cleave::dbem {

namespace {

/// A contact of one joint, by its place along it.
struct Along {
  double at;
  std::size_t touch;
};

/// Contacts of the joint that contact `k` lies on, in order along it: same two bodies, same line.
std::vector<Along> joint_of(const World::Impl& w, std::size_t k) {
  const ContactCandidate& t = w.touches[k];
  const Vec2 along = turned_left(t.normal);
  const double feature = std::min(w.shapes[t.i].feature, w.shapes[t.j].feature);
  std::vector<Along> out;
  for (std::size_t q = 0; q < w.touches.size(); ++q) {
    const ContactCandidate& other = w.touches[q];
    const bool same = (other.i == t.i && other.j == t.j) || (other.i == t.j && other.j == t.i);
    if (!same || std::abs(cross(other.normal, t.normal)) > 1e-3) continue;
    const Vec2 d = other.point - t.point;
    const double far = std::abs(dot(d, along));
    if (std::abs(dot(d, t.normal)) > 1e-5 * feature + 1e-3 * far || other.gap > 1e-6 * feature) continue;
    out.push_back({dot(d, along), q});
  }
  std::ranges::sort(out, {}, &Along::at);
  return out;
}

/// Both bodies reach the middle between two contacts: the joint is closed there.
bool closed_between(const World::Impl& w, const ContactCandidate& a, const ContactCandidate& b) {
  const Vec2 middle = 0.5 * (a.point + b.point);
  const double allowed = 1e-5 * std::min(w.shapes[a.i].feature, w.shapes[a.j].feature) + 1e-3 * norm(b.point - a.point);
  return nearest_on(w.corners_of(w.corners, a.i), middle).distance <= allowed &&
         nearest_on(w.corners_of(w.corners, a.j), middle).distance <= allowed;
}

/// The closed stretch of the joint around a contact: those on it, in order along it.
std::vector<Along> closed_stretch(const World::Impl& w, std::size_t first) {
  std::vector<Along> all = joint_of(w, first);
  std::size_t low = 0;
  while (all[low].touch != first) ++low;
  std::size_t high = low;
  while (low > 0 && closed_between(w, w.touches[all[low - 1].touch], w.touches[all[low].touch])) --low;
  while (high + 1 < all.size() && closed_between(w, w.touches[all[high].touch], w.touches[all[high + 1].touch])) ++high;
  return {all.begin() + static_cast<std::ptrdiff_t>(low), all.begin() + static_cast<std::ptrdiff_t>(high) + 1};
}

/// Forces at the ends of a stretch under a pressure that is linear along it; where it would be negative there is none.
/// Resultant and moment are exact.
std::array<double, 2> forces_of(double length, double at_low, double at_high) {
  if (at_low <= 0 && at_high <= 0) return {0, 0};
  if (at_low >= 0 && at_high >= 0) return {length / 6 * (2 * at_low + at_high), length / 6 * (at_low + 2 * at_high)};
  const bool from_low = at_low > 0;
  const double most = std::max(at_low, at_high), wet = length * most / std::abs(at_high - at_low);
  const double whole = 0.5 * most * wet, far = whole * wet / (3 * length);
  return from_low ? std::array{whole - far, far} : std::array{far, whole - far};
}

}  // namespace

void World::Impl::push_at(std::uint32_t body, Vec2 point, Vec2 force) {
  Shape& shape = shapes[body];
  if (shape.fixed) return;
  const Vec2 local = point - start_x[body];
  bodies[body].forces.push_back({.at = local + shape.local_centroid, .force = force, .follows = true});
  const BoundaryPoint place = nearest_on(shape.corners, local);
  shape.load_places.push_back({place.edge, place.share});
  shape.timed = true;
}

void World::Impl::make_water() {
  constexpr double unit_weight = 9810;  // N/m3
  std::vector<std::uint8_t> done(touches.size(), 0);
  for (std::size_t first = 0; first < touches.size(); ++first) {
    const ContactCandidate& t = touches[first];
    const JointLaw& law = law_of(t);
    const double feature = std::min(shapes[t.i].feature, shapes[t.j].feature);
    if (done[first] != 0 || !(law.water_pressure > Stress{} || law.water_table) || t.gap > 1e-6 * feature) continue;
    const std::vector<Along> stretch = closed_stretch(*this, first);
    for (const Along& place : stretch) done[place.touch] = 1;
    // Uniform water and still water may each be there or not: a kink where the table crosses is the second one's own.
    for (std::size_t k = 0; k + 1 < stretch.size(); ++k) {
      const double length = stretch[k + 1].at - stretch[k].at;
      const Vec2 low = touches[stretch[k].touch].point, high = touches[stretch[k + 1].touch].point;
      std::array<double, 2> force = forces_of(length, law.water_pressure.si(), law.water_pressure.si());
      if (law.water_table) {
        const auto under = [&](Vec2 p) { return unit_weight * (law.water_table->si() - (anchor.y + p.y)); };
        const std::array<double, 2> still = forces_of(length, under(low), under(high));
        force = {force[0] + still[0], force[1] + still[1]};
      }
      for (const auto& [point, size] : {std::pair{low, force[0]}, std::pair{high, force[1]}}) {
        if (size <= 0) continue;
        push_at(t.i, point, size * t.normal);
        push_at(t.j, point, -size * t.normal);
      }
    }
  }
}

void World::Impl::make_bonds() {
  std::vector<std::uint8_t> done(touches.size(), 0);
  for (std::size_t first = 0; first < touches.size(); ++first) {
    const ContactCandidate& t = touches[first];
    const JointLaw& law = law_of(t);
    const double feature = std::min(shapes[t.i].feature, shapes[t.j].feature);
    const bool weakens = law.residual_friction.value_or(law.friction) < law.friction;
    const bool bonded = law.cohesion > 0 || law.tension > 0 || weakens;
    if (done[first] != 0 || !bonded || t.gap > 1e-6 * feature) continue;
    const std::vector<Along> all = closed_stretch(*this, first);
    const auto section = static_cast<std::uint32_t>(sections.size());
    const Vec2 along = turned_left(t.normal);
    const double middle = 0.5 * (all.front().at + all.back().at);
    sections.push_back({all.back().at - all.front().at, law.tension});
    double& weakest = sections.back().tension;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const double left = k > 0 ? all[k].at - all[k - 1].at : 0.0;
      const double right = k + 1 < all.size() ? all[k + 1].at - all[k].at : 0.0;
      const ContactCandidate& here = touches[all[k].touch];
      const double length = share_of(here, -along, left) * left + share_of(here, along, right) * right;
      const JointLaw& own = law_of(here);
      weakest = std::min(weakest, own.tension);
      done[all[k].touch] = 1;
      add_bond(here, {own.cohesion * length, own.tension * length, own.residual_cohesion * length, section,
                      all[k].at - middle});
    }
  }
  std::ranges::sort(bond_keys);
}

void World::Impl::add_bond(const ContactCandidate& t, const Bond& bond) {
  const auto index = static_cast<std::uint32_t>(bonds.size());
  bonds.push_back(bond);
  bond_keys.push_back({t.i, t.vertex, t.j, index});
  // A contact of two corners may be found from either.
  const auto others = corners_of(corners, t.j);
  for (std::uint32_t q = 0; q < others.size(); ++q) {
    if (norm(others[q] - t.point) < 1e-5 * std::min(shapes[t.i].feature, shapes[t.j].feature)) {
      bond_keys.push_back({t.j, q, t.i, index});
    }
  }
}

void World::Impl::weaken(const Attempt& done) {
  std::vector<std::uint8_t> closed(bonds.size(), 0);
  for (const std::uint32_t bond : done.closed) closed[bond] = 1;
  for (const BondKey& key : bond_keys) {
    if (asleep[key.body] != 0 || asleep[key.other] != 0) closed[key.bond] = 1;
  }
  for (const std::uint32_t bond : done.broken) bonds[bond].broken = true;
  for (std::size_t b = 0; b < bonds.size(); ++b) {
    const bool torn =
        (!torn_now.empty() && torn_now[bonds[b].section] != 0) || lost(static_cast<std::uint32_t>(b)) == Loss::torn;
    if (bonds[b].broken && (closed[b] == 0 || torn)) bonds[b].opened = true;
  }
}

/// Stress at the edge of a section is linear in its normal force and moment, N / l + 6 M / l2, whatever number of
/// contacts carries them. Where it passes the strength the joint tears as a whole.
bool World::Impl::tear_sections(const std::vector<ContactCandidate>& list, const Attempt& out,
                                const std::vector<ContactSolution>& solutions, double step) {
  if (sections.empty()) return false;
  std::vector<double> force(sections.size(), 0.0), moment(sections.size(), 0.0);
  for (std::size_t s = 0; s < out.islands.size(); ++s) {
    for (std::size_t k = 0; k < out.islands[s].touches.size(); ++k) {
      const Bond* bond = bond_of(list[out.islands[s].touches[k]]);
      if (bond == nullptr) continue;
      const double n = solutions[s].impulse[k].x / step;
      force[bond->section] += n;
      moment[bond->section] += n * bond->at;
    }
  }
  bool any = false;
  for (std::size_t s = 0; s < sections.size(); ++s) {
    const double length = sections[s].length;
    if (torn_now[s] != 0 || !(sections[s].tension > 0) || !(length > 0)) continue;
    const double edge = (6 * std::abs(moment[s]) / length - force[s]) / length;
    if (edge <= sections[s].tension * (1 + 1e-9)) continue;
    torn_now[s] = 1;
    any = true;
  }
  return any;
}

}  // namespace cleave::dbem
