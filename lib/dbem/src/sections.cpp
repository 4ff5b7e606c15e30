#include <algorithm>
#include <cmath>

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
  const Touch& t = w.touches[k];
  const Vec2 along = turned_left(t.normal);
  const double feature = std::min(w.shapes[t.i].feature, w.shapes[t.j].feature);
  std::vector<Along> out;
  for (std::size_t q = 0; q < w.touches.size(); ++q) {
    const Touch& other = w.touches[q];
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
bool closed_between(const World::Impl& w, const Touch& a, const Touch& b) {
  const Vec2 middle = 0.5 * (a.point + b.point);
  const double allowed = 1e-5 * std::min(w.shapes[a.i].feature, w.shapes[a.j].feature) + 1e-3 * norm(b.point - a.point);
  return nearest_on(w.corners_of(w.corners, a.i), middle).distance <= allowed &&
         nearest_on(w.corners_of(w.corners, a.j), middle).distance <= allowed;
}

}  // namespace

void World::Impl::make_bonds() {
  std::vector<std::uint8_t> done(touches.size(), 0);
  for (std::size_t first = 0; first < touches.size(); ++first) {
    const Touch& t = touches[first];
    const JointLaw& law = law_of(t);
    const double feature = std::min(shapes[t.i].feature, shapes[t.j].feature);
    const bool weakens = law.residual_friction.value_or(law.friction) < law.friction;
    const bool bonded = law.cohesion > 0 || law.tension > 0 || weakens;
    if (done[first] != 0 || !bonded || t.gap > 1e-6 * feature) continue;
    // The closed stretch of the joint around this contact.
    const std::vector<Along> all = joint_of(*this, first);
    std::size_t low = 0;
    while (all[low].touch != first) ++low;
    std::size_t high = low;
    while (low > 0 && closed_between(*this, touches[all[low - 1].touch], touches[all[low].touch])) --low;
    while (high + 1 < all.size() && closed_between(*this, touches[all[high].touch], touches[all[high + 1].touch]))
      ++high;
    const auto section = static_cast<std::uint32_t>(sections.size());
    const double middle = 0.5 * (all[low].at + all[high].at);
    sections.push_back({all[high].at - all[low].at, law.tension});
    double& weakest = sections.back().tension;
    for (std::size_t k = low; k <= high; ++k) {
      const double left = k > low ? all[k].at - all[k - 1].at : 0.0;
      const double right = k < high ? all[k + 1].at - all[k].at : 0.0;
      const double length = 0.5 * (left + right);
      const JointLaw& own = law_of(touches[all[k].touch]);
      weakest = std::min(weakest, own.tension);
      done[all[k].touch] = 1;
      add_bond(touches[all[k].touch], {own.cohesion * length, own.tension * length, own.residual_cohesion * length,
                                       section, all[k].at - middle});
    }
  }
  std::ranges::sort(bond_keys);
}

void World::Impl::add_bond(const Touch& t, const Bond& bond) {
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
    const bool torn = !torn_now.empty() && torn_now[bonds[b].section] != 0;
    if (bonds[b].broken && (closed[b] == 0 || torn)) bonds[b].opened = true;
  }
}

/// Stress at the edge of a section is linear in its normal force and moment, N / l + 6 M / l2, whatever number of
/// contacts carries them. Where it passes the strength the joint tears as a whole.
bool World::Impl::tear_sections(const std::vector<Touch>& list, const Attempt& out,
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
