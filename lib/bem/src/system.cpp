#include "system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "gauss.hpp"
#include "system_parts.hpp"

namespace cleave::bem {
namespace {

constexpr double corner_shift = 1.0 / 3;

std::uint32_t u32(std::size_t value) { return static_cast<std::uint32_t>(value); }

struct Box {
  Vec2 low{1e300, 1e300};
  Vec2 high{-1e300, -1e300};
};

Box box_of(const std::vector<Region>& regions) {
  Box box;
  for (const Region& region : regions) {
    for (const Loop& loop : region.loops) {
      for (std::size_t s = 0; s < loop.size(); ++s) {
        for (const double t : {0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875}) {
          const Vec2 x = point_on(loop, s, t).x;
          box.low = {std::min(box.low.x, x.x), std::min(box.low.y, x.y)};
          box.high = {std::max(box.high.x, x.x), std::max(box.high.y, x.y)};
        }
      }
    }
  }
  return box;
}

/// The elements of one region that share a condition at a node.
struct Group {
  std::uint32_t region;
  std::uint32_t node;  ///< of the region
  std::array<Use, 2> uses;
  std::size_t count = 0;
  const Condition* condition = nullptr;
  Vec2 normal;

  [[nodiscard]] std::array<Vec2, 2> axes() const {
    if (condition->axes == Axes::normal)
      return {rotated(normal, condition->turn), rotated(turned_left(normal), condition->turn)};
    return {rotated({1, 0}, condition->turn), rotated({0, 1}, condition->turn)};
  }
};

class Builder {
 public:
  Builder(const Problem& problem, const Options& options) : problem_{problem}, options_{options} {}

  std::expected<System, SolveError> build() {
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

 private:
  std::optional<SolveError> scale() {
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
    const Box box = box_of(problem_.regions);
    system_.extent = problem_.extent;
    system_.origin = 0.5 * (box.low + box.high);
    // Four times the extent: lengths below one keep ln r of one sign and away from the degenerate scale.
    system_.scale = 4 * std::max(box.high.x - box.low.x, box.high.y - box.low.y);
    system_.mu = problem_.regions.front().material.mu();
    const double h = system_.scale;
    if (problem_.extent == Extent::half_plane) system_.surface = (problem_.surface - system_.origin.y) / h;
    MeshSize size = options_.mesh;
    if (size.element <= 0) size.element = h / 64;
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

  const Condition& condition_of(std::size_t region, const Element& e) const {
    // Loops that were turned keep their sides' own conditions, so look at the mesh's side, not the problem's.
    return problem_.regions[region].conditions[side_condition_[region][e.loop][e.side]];
  }

  std::optional<SolveError> bond() {
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
    std::vector<std::size_t> parent(total);
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    const auto find = [&](std::size_t i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
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
            parent[find(first[a.region] + ea.node[k])] = find(first[b.region] + eb.node[per - 1 - k]);
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
        std::uint32_t& id = number[find(first[r] + n)];
        if (id == UINT32_MAX) id = next++;
        system_.regions[r].global[n] = id;
      }
    }
    system_.displacement.resize(next);
    groups_of_.resize(next);
    return std::nullopt;
  }

  void find_groups() {
    for (std::size_t r = 0; r < system_.regions.size(); ++r) {
      const Mesh& mesh = system_.regions[r].mesh;
      for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
        const Node& node = mesh.nodes[n];
        const auto add = [&](std::span<const Use> uses) {
          Group g{
              .region = u32(r), .node = u32(n), .uses = {}, .count = uses.size(), .condition = nullptr, .normal = {}};
          for (std::size_t k = 0; k < uses.size(); ++k) {
            const Element& e = mesh.elements[uses[k].element];
            g.uses[k] = uses[k];
            g.normal += e.normal(local_nodes(mesh.order)[uses[k].local]);
            g.condition = &condition_of(r, e);
          }
          g.normal = g.normal / norm(g.normal);
          groups_of_[system_.regions[r].global[n]].push_back(u32(groups_.size()));
          groups_.push_back(g);
        };
        if (node.corner) {
          for (const Use& use : node.uses) add({&use, 1});
        } else {
          add(node.uses);
        }
      }
    }
  }

  Vec2 position(const Group& g) const {
    return system_.origin + system_.scale * system_.regions[g.region].mesh.nodes[g.node].x;
  }

  /// Rigid motions that no support feels, by the Gram matrix of what supports see of them.
  std::optional<SolveError> check_supports() {
    if (problem_.extent != Extent::bounded) return std::nullopt;
    // Bonded regions hold each other; regions that hang together are one body.
    std::vector<std::size_t> body(system_.regions.size());
    std::iota(body.begin(), body.end(), std::size_t{0});
    const auto find = [&](std::size_t i) {
      while (body[i] != i) i = body[i];
      return i;
    };
    for (std::size_t r = 0; r < partner_.size(); ++r) {
      for (const auto& p : partner_[r]) {
        if (p) body[find(r)] = find(p->first);
      }
    }
    for (std::size_t root = 0; root < system_.regions.size(); ++root) {
      if (find(root) != root) continue;
      std::vector<std::array<double, 3>> rows;
      for (const Group& g : groups_) {
        if (find(g.region) != root || g.condition->bonded) continue;
        const auto axes = g.axes();
        const Vec2 x = 4 * system_.regions[g.region].mesh.nodes[g.node].x;  // about 1 at the body's ends
        for (std::size_t k = 0; k < 2; ++k) {
          const Component& c = g.condition->component[k];
          if (c.given == Given::displacement || (c.given == Given::spring && c.stiffness > 0)) {
            rows.push_back({axes[k].x, axes[k].y, cross(x, axes[k])});
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
      for (const auto& m : motions) {
        if (std::abs(m[2]) < 1e-6) {
          error.motions.push_back(fmt::format("translation along ({:.3g}, {:.3g})", m[0] + 0.0, m[1] + 0.0));
        } else {
          const Vec2 pole = system_.origin + (system_.scale / 4) * Vec2{-m[1] / m[2], m[0] / m[2]};
          error.motions.push_back(fmt::format("rotation about ({:.4g}, {:.4g})", pole.x, pole.y));
        }
      }
      return error;
    }
    return std::nullopt;
  }

  /// Inertia relief: the body accelerates as its loads ask, and this acceleration is a load that balances them.
  void balance() {
    ScaledRegion& region = system_.regions.front();
    const Mesh& mesh = region.mesh;
    const AreaMoments area = area_moments(problem_.regions.front().loops);
    const double h = system_.scale;
    const double a = std::abs(area.area) / (h * h);
    const Vec2 c = (area.centroid - system_.origin) / h;
    const double polar = std::abs(area.polar) / (h * h * h * h);
    // The body constant holds the divergence of the initial stress, which is not a force.
    const Vec2 divergence{region.particular.initial_slope.xy, region.particular.initial_slope.yy};
    Vec2 force = a * (region.particular.body - divergence) + a * region.particular.spin * c -
                 a * region.particular.twist * turned_left(c);
    double moment = cross(c, force) - region.particular.twist * polar;
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      const Element& element = mesh.elements[e];
      const GaussRule& rule = gauss(12);
      for (std::size_t k = 0; k < rule.s.size(); ++k) {
        const auto n = shape(mesh.order, rule.s[k]);
        Vec2 t;
        for (std::size_t i = 0; i < mesh.per_element(); ++i) t += n[i] * given_traction(0, u32(e), u32(i));
        const Vec2 f = (rule.w[k] * norm(element.derivative(rule.s[k]))) * t;
        force += f;
        moment += cross(element.at(rule.s[k]), f);
      }
    }
    for (const PointForce& p : problem_.forces) {
      const Vec2 f = p.force / (system_.mu * h);
      force += f;
      moment += cross((p.at - system_.origin) / h, f);
    }
    const double about_centroid = moment - cross(c, force);
    const double alpha = about_centroid / polar;  // density times angular acceleration
    region.particular.twist += alpha;
    region.particular.body += -(1 / a) * force + alpha * turned_left(c);
  }

  /// Traction known at a node of an element, scaled (0 where it is not known).
  Vec2 given_traction(std::size_t region, std::uint32_t element, std::uint32_t local) const {
    const Mesh& mesh = system_.regions[region].mesh;
    const Element& e = mesh.elements[element];
    const double s = local_nodes(mesh.order)[local];
    Group g{.region = u32(region),
            .node = e.node[local],
            .uses = {},
            .count = 1,
            .condition = &condition_of(region, e),
            .normal = e.normal(s)};
    if (g.condition->bonded) return {};
    const auto axes = g.axes();
    Vec2 t;
    for (std::size_t k = 0; k < 2; ++k) {
      const Component& c = g.condition->component[k];
      if (c.given != Given::displacement && c.value) t += (c.value(position(g), g.normal) / system_.mu) * axes[k];
    }
    return t;
  }

  std::optional<SolveError> constrain() {
    for (std::uint32_t n = 0; n < system_.displacement.size(); ++n) {
      Affine& u = system_.displacement[n];
      std::vector<Vec2> held;  // orthonormal
      for (const std::uint32_t id : groups_of_[n]) {
        const Group& g = groups_[id];
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

  void add_tractions() {
    for (std::size_t r = 0; r < system_.regions.size(); ++r) {
      ScaledRegion& region = system_.regions[r];
      const std::size_t count = region.mesh.elements.size();
      region.slot.assign(count, {});
      region.slot_sign.assign(count, {1, 1, 1});
    }
    for (const Group& g : groups_) {
      ScaledRegion& region = system_.regions[g.region];
      const Use use = g.uses.front();
      const std::size_t per = region.mesh.per_element();
      if (g.condition->bonded) {
        const auto partner = *partner_[g.region][use.element];
        if (partner.first < g.region) {
          // The lower region owns the traction; here it acts the other way.
          for (std::size_t k = 0; k < g.count; ++k) {
            const auto other = *partner_[g.region][g.uses[k].element];
            region.slot[g.uses[k].element][g.uses[k].local] =
                system_.regions[other.first].slot[other.second][per - 1 - g.uses[k].local];
            region.slot_sign[g.uses[k].element][g.uses[k].local] = -1;
          }
          continue;
        }
      }
      Affine t;
      if (g.condition->bonded) {
        t.add(system_.columns++, {1, 0});
        t.add(system_.columns++, {0, 1});
      } else {
        const auto axes = g.axes();
        const Affine& u = system_.displacement[region.global[g.node]];
        std::vector<std::pair<std::uint32_t, Vec2>> of_displacement;
        for (std::size_t k = 0; k < 2; ++k) {
          const Component& c = g.condition->component[k];
          if (c.given == Given::displacement) {
            t.add(system_.columns++, axes[k]);
            continue;
          }
          if (c.value) t.constant += (c.value(position(g), g.normal) / system_.mu) * axes[k];
          if (c.given == Given::spring) {
            const double stiffness = c.stiffness * system_.scale / system_.mu;
            t.constant -= (stiffness * dot(u.constant, axes[k])) * axes[k];
            for (std::uint32_t i = 0; i < u.count; ++i) {
              const Vec2 d = (-stiffness * dot(u.terms[i].direction, axes[k])) * axes[k];
              const auto same =
                  std::ranges::find(of_displacement, u.terms[i].column, &std::pair<std::uint32_t, Vec2>::first);
              if (same == of_displacement.end()) {
                of_displacement.emplace_back(u.terms[i].column, d);
              } else {
                same->second += d;
              }
            }
          }
        }
        for (const auto& [column, d] : of_displacement) t.add(column, d);
      }
      for (std::size_t k = 0; k < g.count; ++k)
        region.slot[g.uses[k].element][g.uses[k].local] = u32(system_.traction.size());
      system_.traction.push_back(t);
    }
    for (ScaledRegion& region : system_.regions) {
      for (const Node& node : region.mesh.nodes) region.u_particular.push_back(region.particular.displacement(node.x));
      const auto local = local_nodes(region.mesh.order);
      for (const Element& e : region.mesh.elements) {
        std::array<Vec2, 3> t{};
        for (std::size_t a = 0; a < local.size(); ++a) {
          // At the point of a force its traction is the one beside it: none on a straight side.
          const double s = at_force(region.particular, e.at(local[a])) ? 0.98 * local[a] : local[a];
          t[a] = region.particular.stress(e.at(s)) * e.normal(s);
        }
        region.t_particular.push_back(t);
      }
      if (!region.particular.points.empty()) keep_momentum(region);
      for (std::size_t e = 0; e < region.t_particular.size(); ++e) {
        for (std::size_t a = 0; a < local.size(); ++a) region.t_particular[e][a] -= region.t_forces[e][a];
      }
    }
  }

  std::optional<SolveError> add_forces() {
    for (ScaledRegion& region : system_.regions) region.t_forces.assign(region.mesh.elements.size(), {});
    for (std::size_t f = 0; f < problem_.forces.size(); ++f) {
      const PointForce& force = problem_.forces[f];
      ScaledRegion& region = system_.regions[std::min(force.region, system_.regions.size() - 1)];
      const Vec2 at = (force.at - system_.origin) / system_.scale;
      double best = 1e300;
      std::size_t on = 0;
      double where = 0;
      for (std::size_t e = 0; e < region.mesh.elements.size(); ++e) {
        const Element& element = region.mesh.elements[e];
        double s = std::clamp(dot(at - element.c0, element.c1) / dot(element.c1, element.c1), -1.0, 1.0);
        for (int pass = 0; pass < 20 && element.curved; ++pass) {
          const Vec2 t = element.derivative(s);
          s = std::clamp(s + dot(at - element.at(s), t) / dot(t, t), -1.0, 1.0);
        }
        if (const double d = norm(element.at(s) - at); d < best) {
          best = d;
          on = e;
          where = s;
        }
      }
      if (best > 1e-4) return ForceOffBoundary{f, best * system_.scale};
      const Element& element = region.mesh.elements[on];
      const Condition& condition = condition_of(std::min(force.region, system_.regions.size() - 1), element);
      if (condition.bonded || condition.component[0].given == Given::displacement ||
          condition.component[1].given == Given::displacement) {
        return ForceOnSupport{f};
      }
      const Vec2 p = force.force / (system_.mu * system_.scale);
      if (system_.extent == Extent::bounded && flamant_fits(region, element.at(where), element.normal(where), on)) {
        region.particular.points.push_back({element.at(where), element.normal(where), p, 1e-6 * norm(element.c1)});
        continue;
      }
      // Traction sum N_b t_b with integral of N_a t = N_a(s) P: solve with the element's Gram matrix.
      const std::size_t per = region.mesh.per_element();
      std::array<std::array<double, 4>, 3> m{};
      const GaussRule& rule = gauss(12);
      for (std::size_t k = 0; k < rule.s.size(); ++k) {
        const auto n = shape(region.mesh.order, rule.s[k]);
        const double w = rule.w[k] * norm(element.derivative(rule.s[k]));
        for (std::size_t a = 0; a < per; ++a) {
          for (std::size_t b = 0; b < per; ++b) m[a][b] += w * n[a] * n[b];
        }
      }
      const auto n = shape(region.mesh.order, where);
      for (std::size_t a = 0; a < per; ++a) m[a][3] = n[a];
      for (std::size_t a = 0; a < per; ++a) {
        for (std::size_t b = 0; b < per; ++b) {
          if (a == b) continue;
          const double ratio = m[b][a] / m[a][a];
          for (std::size_t c = 0; c < 4; ++c) m[b][c] -= ratio * m[a][c];
        }
      }
      for (std::size_t a = 0; a < per; ++a) region.t_forces[on][a] += (m[a][3] / m[a][a]) * p;
    }
    return std::nullopt;
  }

  /// Directions in which the traction of a group is unknown.
  static std::vector<Vec2> unknown_directions(const Group& g) {
    if (g.condition->bonded) return {{1, 0}, {0, 1}};
    std::vector<Vec2> out;
    const auto axes = g.axes();
    for (std::size_t k = 0; k < 2; ++k) {
      if (g.condition->component[k].given == Given::displacement) out.push_back(axes[k]);
    }
    return out;
  }

  void plan_equations() {
    for (std::size_t r = 0; r < system_.regions.size(); ++r) {
      const Mesh& mesh = system_.regions[r].mesh;
      std::vector<std::vector<const Group*>> of_node(mesh.nodes.size());
      for (const Group& g : groups_) {
        if (g.region == r) of_node[g.node].push_back(&g);
      }
      for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
        const Node& node = mesh.nodes[n];
        EquationGroup group{.region = u32(r), .equations = {}};
        const auto at_node = [&] {
          Equation q{.y = node.x, .own = {}, .at_point = {{u32(n), 1.0}}, .rows = {}};
          for (const Use& use : node.uses) q.own.push_back({use.element, local_nodes(mesh.order)[use.local]});
          q.rows = {{system_.rows, {1, 0}}, {system_.rows + 1, {0, 1}}};
          system_.rows += 2;
          return q;
        };
        const auto beside = [&](const Use& use) {
          const double s = local_nodes(mesh.order)[use.local] * (1 - corner_shift);
          const Element& e = mesh.elements[use.element];
          Equation q{.y = e.at(s), .own = {{use.element, s}}, .at_point = {}, .rows = {}};
          const auto v = shape(mesh.order, s);
          for (std::size_t a = 0; a < mesh.per_element(); ++a) q.at_point.emplace_back(e.node[a], v[a]);
          return q;
        };
        if (of_node[n].size() < 2) {
          group.equations.push_back(at_node());
        } else {
          const auto a = unknown_directions(*of_node[n][0]);
          const auto b = unknown_directions(*of_node[n][1]);
          std::vector<Vec2> both;
          if (a.size() == 2) {
            both = b;
          } else if (b.size() == 2) {
            both = a;
          } else if (a.size() == 1 && b.size() == 1 && std::abs(cross(a[0], b[0])) < 1e-6) {
            both = a;
          }
          if (both.empty()) {
            group.equations.push_back(at_node());
          } else {
            Equation first = beside(of_node[n][0]->uses.front());
            Equation second = beside(of_node[n][1]->uses.front());
            const std::uint32_t row = system_.rows;
            if (both.size() == 2) {
              first.rows = {{row, {1, 0}}, {row + 1, {0, 1}}};
              second.rows = {{row + 2, {1, 0}}, {row + 3, {0, 1}}};
              system_.rows += 4;
            } else {
              const Vec2 d = both.front();
              const Vec2 across = 0.5 * turned_left(d);
              first.rows = {{row, d}, {row + 2, across}};
              second.rows = {{row + 1, d}, {row + 2, across}};
              system_.rows += 3;
            }
            group.equations.push_back(std::move(first));
            group.equations.push_back(std::move(second));
          }
        }
        system_.groups.push_back(std::move(group));
      }
    }
  }

  const Problem& problem_;
  const Options& options_;
  System system_;
  std::vector<std::vector<std::vector<std::size_t>>> side_condition_;
  std::vector<std::vector<std::optional<std::pair<std::uint32_t, std::uint32_t>>>> partner_;
  std::vector<Group> groups_;
  std::vector<std::vector<std::uint32_t>> groups_of_;
};

}  // namespace

std::expected<System, SolveError> make_system(const Problem& problem, const Options& options) {
  return Builder{problem, options}.build();
}

}  // namespace cleave::bem
