#include "system_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cleave/core/disjoint_sets.hpp"

#include "system_parts.hpp"

namespace cleave::bem {
namespace {

std::uint32_t u32(std::size_t value) { return static_cast<std::uint32_t>(value); }

bool holds(const Component& c) {
  return c.given == Given::displacement || (c.given == Given::spring && c.stiffness > 0);
}

/// Motions of coordinates (x - origin) / length.
std::vector<std::string> names_of(const std::vector<std::array<double, 3>>& motions, Vec2 origin, double length) {
  std::vector<std::string> names;
  for (const auto& m : motions) {
    if (std::abs(m[2]) < 1e-6) {
      names.push_back(fmt::format("translation along ({:.3g}, {:.3g})", m[0] + 0.0, m[1] + 0.0));
    } else {
      const Vec2 pole = origin + length * Vec2{-m[1] / m[2], m[0] / m[2]};
      names.push_back(fmt::format("rotation about ({:.4g}, {:.4g})", pole.x, pole.y));
    }
  }
  return names;
}

}  // namespace

std::vector<std::string> unheld_motions(const Region& region) {
  Vec2 low = region.loops.front().front().start, high = low;
  for (const Side& side : region.loops.front()) {
    low = {std::min(low.x, side.start.x), std::min(low.y, side.start.y)};
    high = {std::max(high.x, side.start.x), std::max(high.y, side.start.y)};
  }
  const Vec2 origin = 0.5 * (low + high);
  const double length = 0.5 * std::max(high.x - low.x, high.y - low.y);
  std::vector<std::array<double, 3>> rows;
  for (const Loop& loop : region.loops) {
    for (std::size_t s = 0; s < loop.size(); ++s) {
      const Condition& condition = region.conditions[loop[s].condition];
      for (const double at : {0.1, 0.5, 0.9}) {
        const SidePoint p = point_on(loop, s, at);
        const Vec2 normal = (-1 / norm(p.derivative)) * turned_left(p.derivative);
        const Vec2 x = (1 / length) * (p.x - origin);
        const Vec2 first = rotated(condition.axes == Axes::normal ? normal : Vec2{1, 0}, condition.turn);
        const std::array<Vec2, 2> axes{first, turned_left(first)};
        for (std::size_t k = 0; k < 2; ++k) {
          if (holds(condition.component[k])) rows.push_back({axes[k].x, axes[k].y, cross(x, axes[k])});
        }
      }
    }
  }
  return names_of(free_motions(rows), origin, length);
}

std::optional<SolveError> SystemBuilder::bond() {
  // Conditions by loop and side as meshed (loops may have been turned).
  const bool exterior = problem_.extent != Extent::bounded;
  for (std::size_t r = 0; r < problem_.regions.size(); ++r) {
    auto checked = check_loops(problem_.regions[r].loops, exterior && r == 0);
    std::vector<std::vector<std::size_t>> of_region;
    for (const Loop& loop : checked->loops) {
      std::vector<std::size_t> sides;
      for (const Side& side : loop) sides.push_back(side.condition);
      of_region.push_back(std::move(sides));
    }
    side_condition_.push_back(std::move(of_region));
  }
  std::vector<std::size_t> first(system_.regions.size());
  std::size_t total = 0;
  for (std::size_t r = 0; r < system_.regions.size(); ++r) {
    first[r] = total;
    total += system_.regions[r].mesh.nodes.size();
  }
  DisjointSets<> nodes{total};
  struct Glued {
    std::size_t region, element;
  };
  std::vector<Glued> glued;
  for (std::size_t r = 0; r < system_.regions.size(); ++r) {
    for (std::size_t e = 0; e < system_.regions[r].mesh.elements.size(); ++e) {
      if (condition_of(r, system_.regions[r].mesh.elements[e]).bonded) glued.push_back({r, e});
    }
  }
  partner_.resize(system_.regions.size());
  for (std::size_t r = 0; r < system_.regions.size(); ++r) {
    partner_[r].assign(system_.regions[r].mesh.elements.size(), std::nullopt);
  }
  for (const Glued& a : glued) {
    if (partner_[a.region][a.element]) continue;
    const Element& ea = system_.regions[a.region].mesh.elements[a.element];
    for (const Glued& b : glued) {
      if (b.region <= a.region || partner_[b.region][b.element]) continue;
      const Element& eb = system_.regions[b.region].mesh.elements[b.element];
      const double close = 1e-7 * norm(ea.c1);
      if (norm(ea.at(-1) - eb.at(1)) < close && norm(ea.at(1) - eb.at(-1)) < close && norm(ea.c0 - eb.c0) < close) {
        partner_[a.region][a.element] = {u32(b.region), u32(b.element)};
        partner_[b.region][b.element] = {u32(a.region), u32(a.element)};
        const std::size_t per = system_.regions[a.region].mesh.per_element();
        for (std::size_t k = 0; k < per; ++k) {
          nodes.join(first[a.region] + ea.node[k], first[b.region] + eb.node[per - 1 - k]);
        }
        break;
      }
    }
    if (!partner_[a.region][a.element]) return UnbondedSide{a.region, ea.loop, ea.side};
  }
  std::vector<std::uint32_t> number(total, UINT32_MAX);
  std::uint32_t next = 0;
  for (std::size_t r = 0; r < system_.regions.size(); ++r) {
    for (std::size_t n = 0; n < system_.regions[r].mesh.nodes.size(); ++n) {
      std::uint32_t& id = number[nodes.find(first[r] + n)];
      if (id == UINT32_MAX) id = next++;
      system_.regions[r].global[n] = id;
    }
  }
  system_.displacement.resize(next);
  groups_of_.resize(next);
  return std::nullopt;
}

/// Rigid motions that no support feels, by the Gram matrix of what supports see of them.
std::optional<SolveError> SystemBuilder::check_supports() {
  if (problem_.extent != Extent::bounded) return std::nullopt;
  // Bonded regions hold each other; regions that hang together are one body.
  DisjointSets<> bodies{system_.regions.size()};
  for (std::size_t r = 0; r < partner_.size(); ++r) {
    for (const auto& p : partner_[r]) {
      if (p) bodies.join(r, p->first);
    }
  }
  for (std::size_t root = 0; root < system_.regions.size(); ++root) {
    if (bodies.find(root) != root) continue;
    std::vector<std::array<double, 3>> rows, of_ends;
    for (const SideGroup& g : groups_) {
      if (bodies.find(g.region) != root || g.condition->bonded) continue;
      const auto axes = g.axes();
      const Mesh& mesh = system_.regions[g.region].mesh;
      const Vec2 x = 4 * mesh.nodes[g.node].x;  // about 1 at the body's ends
      for (std::size_t k = 0; k < 2; ++k) {
        if (!holds(g.condition->component[k])) continue;
        rows.push_back({axes[k].x, axes[k].y, cross(x, axes[k])});
        for (const double end : {-1.0, 1.0}) {
          const Vec2 at = 4 * mesh.elements[mesh.nodes[g.node].uses.front().element].at(end);
          of_ends.push_back({axes[k].x, axes[k].y, cross(at, axes[k])});
        }
      }
    }
    const auto motions = free_motions(rows);
    if (motions.empty()) continue;
    if (options_.restrain && motions.size() == 3 && system_.regions.size() == 1) {
      system_.free_body = true;
      balance();
      continue;
    }
    FreeMotions error;
    error.finer_holds = options_.mesh.order == Order::constant && free_motions(of_ends).empty();
    error.motions = names_of(motions, system_.origin, system_.scale / 4);
    return error;
  }
  return std::nullopt;
}

}  // namespace cleave::bem
