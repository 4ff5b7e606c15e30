#include "system_builder.hpp"

#include <algorithm>
#include <cmath>

namespace cleave::bem {
namespace {

/// Of points along the sides.
Box2 sampled_box(const std::vector<Region>& regions) {
  Box2 box;
  for (const Region& region : regions) {
    for (const Loop& loop : region.loops) {
      for (std::size_t s = 0; s < loop.size(); ++s) {
        for (const double t : {0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875}) {
          box.add(point_on(loop, s, t).x);
        }
      }
    }
  }
  return box;
}

}  // namespace

std::optional<SolveError> SystemBuilder::check_numbers() const {
  if (problem_.regions.empty()) return NoRegion{};
  const MeshSize& mesh = options_.mesh;
  // Finer than rounding no rule of integration comes to an end.
  if (!(options_.integration >= 1e-15 && options_.integration < 1)) {
    return BadNumber{"the relative error of the integrals", options_.integration};
  }
  if (mesh.element && !(std::isfinite(*mesh.element) && *mesh.element > 0)) {
    return BadNumber{"the length of an element", *mesh.element};
  }
  if (!(mesh.arc_degrees > 0 && mesh.arc_degrees <= 360)) return BadNumber{"the arc on an element", mesh.arc_degrees};
  if (mesh.subdivide == 0) return BadNumber{"the number of parts of an element", 0};
  if (!(options_.memory_limit_mb > 0)) return BadNumber{"the memory allowed", options_.memory_limit_mb};
  const BodyLoad& load = problem_.load;
  const InSitu& in = problem_.in_situ;
  for (const double value : {load.gravity.x, load.gravity.y, load.spin, load.angular_acceleration, load.centre.x,
                             load.centre.y, in.stress.xx, in.stress.xy, in.stress.yy, in.level, in.gradient.xx,
                             in.gradient.xy, in.gradient.yy, problem_.surface}) {
    if (!std::isfinite(value)) return BadNumber{"a number of the loads or of the surface", value};
  }
  for (const PointForce& force : problem_.forces) {
    const double sum = force.at.x + force.at.y + force.force.x + force.force.y;
    if (!std::isfinite(sum)) return BadNumber{"a number of a point force", sum};
    if (force.region >= problem_.regions.size()) {
      return BadNumber{"the region of a point force", static_cast<double>(force.region)};
    }
  }
  return std::nullopt;
}

std::expected<System, SolveError> SystemBuilder::build() {
  if (auto e = check_numbers(); e) return std::unexpected(*std::move(e));
  if (auto e = scale(); e) return std::unexpected(*std::move(e));
  if (auto e = bond(); e) return std::unexpected(*std::move(e));
  find_groups();
  if (auto e = check_supports(); e) return std::unexpected(*std::move(e));
  if (auto e = constrain(); e) return std::unexpected(*std::move(e));
  if (auto e = add_forces(); e) return std::unexpected(*std::move(e));
  add_tractions();
  plan_equations();
  return std::move(system_);
}

std::optional<SolveError> SystemBuilder::scale() {
  const bool exterior = problem_.extent != Extent::bounded;
  std::vector<std::vector<Loop>> loops;
  for (std::size_t r = 0; r < problem_.regions.size(); ++r) {
    // In an infinite extent the first region is the infinite one; others are inclusions in it.
    auto checked = check_loops(problem_.regions[r].loops, exterior && r == 0);
    if (!checked) return BadOutline{r, checked.error()};
    loops.push_back(std::move(checked->loops));
    for (std::size_t l = 0; l < loops[r].size(); ++l) {
      for (std::size_t s = 0; s < loops[r][l].size(); ++s) {
        if (loops[r][l][s].condition >= problem_.regions[r].conditions.size()) return UnknownCondition{r, l, s};
        if (problem_.extent == Extent::half_plane) {
          for (const double t : {0.0, 0.25, 0.5, 0.75}) {
            if (!(point_on(loops[r][l], s, t).x.y < problem_.surface)) return AboveSurface{r, l};
          }
        }
      }
    }
  }
  const Box2 box = sampled_box(problem_.regions);
  system_.extent = problem_.extent;
  system_.origin = 0.5 * (box.low + box.high);
  // Four times the extent: lengths below one keep ln r of one sign and away from the degenerate scale.
  system_.scale = 4 * std::max(box.high.x - box.low.x, box.high.y - box.low.y);
  system_.mu = problem_.regions.front().material.mu();
  const double h = system_.scale;
  if (problem_.extent == Extent::half_plane) system_.surface = (problem_.surface - system_.origin.y) / h;
  MeshSize size = options_.mesh;
  if (!size.element) size.element = h / 64;
  for (std::size_t r = 0; r < problem_.regions.size(); ++r) {
    const Region& region = problem_.regions[r];
    const Material& m = region.material;
    ScaledRegion out;
    out.mesh = make_mesh(loops[r], size, system_.origin, h);
    out.elastic = {m.mu() / system_.mu, m.nu()};
    Particular& p = out.particular;
    p.mu = out.elastic.mu;
    p.nu = m.nu();
    const InSitu& in = problem_.in_situ;
    const Sym2 at_origin = in.stress + (system_.origin.y - in.level) * in.gradient;
    p.initial = (1 / system_.mu) * at_origin;
    p.initial_slope = (h / system_.mu) * in.gradient;
    const BodyLoad& load = problem_.load;
    const double f = h / system_.mu;
    const Vec2 centre = (load.centre - system_.origin) / h;
    Vec2 body = f * (m.density() * load.gravity + Vec2{in.gradient.xy, in.gradient.yy});
    p.spin = f * h * m.density() * load.spin * load.spin;
    p.twist = f * h * m.density() * load.angular_acceleration;
    body += -p.spin * centre + p.twist * turned_left(centre);
    if (exterior && r == 0) {
      const double weight = m.density() * norm(load.gravity) + norm({in.gradient.xy, in.gradient.yy});
      if (norm(body) > 1e-9 * f * weight || p.spin != 0 || p.twist != 0) return NotInBalance{body / f};
      body = {};
    }
    p.body = body;
    out.global.resize(out.mesh.nodes.size());
    system_.regions.push_back(std::move(out));
  }
  return std::nullopt;
}

const Condition& SystemBuilder::condition_of(std::size_t region, const Element& e) const {
  // Loops that were turned keep their sides' own conditions, so look at the mesh's side, not the problem's.
  return problem_.regions[region].conditions[side_condition_[region][e.loop][e.side]];
}

Vec2 SystemBuilder::position(const SideGroup& g) const {
  return system_.origin + system_.scale * system_.regions[g.region].mesh.nodes[g.node].x;
}

std::optional<SolveError> SystemBuilder::constrain() {
  for (std::uint32_t n = 0; n < system_.displacement.size(); ++n) {
    Affine& u = system_.displacement[n];
    std::vector<Vec2> held;  // orthonormal
    for (const std::uint32_t id : groups_of_[n]) {
      const SideGroup& g = groups_[id];
      if (g.condition->bonded) continue;
      const auto axes = g.axes();
      for (std::size_t k = 0; k < 2; ++k) {
        const Component& c = g.condition->component[k];
        if (c.given != Given::displacement) continue;
        const double value = c.value ? c.value(position(g), g.normal) / system_.scale : 0.0;
        Vec2 rest = axes[k];
        for (const Vec2 d : held) rest -= dot(rest, d) * d;
        const double gap = value - dot(u.constant, axes[k]);
        if (norm(rest) < 1e-6) {
          if (std::abs(gap) > 1e-9 * (std::abs(value) + norm(u.constant)) + 1e-14) {
            return TornCorner{g.region, position(g), std::abs(gap) * system_.scale};
          }
          continue;
        }
        // Move u.constant along the new direction alone.
        const Vec2 d = rest / norm(rest);
        u.constant += (gap / dot(axes[k], d)) * d;
        held.push_back(d);
      }
    }
    if (held.empty()) {
      u.add(system_.columns++, {1, 0});
      u.add(system_.columns++, {0, 1});
    } else if (held.size() == 1) {
      u.add(system_.columns++, turned_left(held.front()));
    }
  }
  return std::nullopt;
}

std::expected<System, SolveError> make_system(const Problem& problem, const Options& options) {
  return SystemBuilder{problem, options}.build();
}

}  // namespace cleave::bem
