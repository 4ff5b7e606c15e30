#include "system_builder.hpp"

#include <algorithm>
#include <cmath>

#include "gauss.hpp"
#include "system_parts.hpp"

namespace cleave::bem {
namespace {

std::uint32_t u32(std::size_t value) { return static_cast<std::uint32_t>(value); }

}  // namespace

/// Traction known at a node of an element, scaled (0 where it is not known).
Vec2 SystemBuilder::given_traction(std::size_t region, std::uint32_t element, std::uint32_t local) const {
  const Mesh& mesh = system_.regions[region].mesh;
  const Element& e = mesh.elements[element];
  const double s = local_nodes(mesh.order)[local];
  SideGroup g{.region = u32(region),
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

/// Inertia relief: the body accelerates as its loads ask, and this acceleration is a load that balances them.
void SystemBuilder::balance() {
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

std::optional<SolveError> SystemBuilder::add_forces() {
  for (ScaledRegion& region : system_.regions) region.t_forces.assign(region.mesh.elements.size(), {});
  for (std::size_t f = 0; f < problem_.forces.size(); ++f) {
    const PointForce& force = problem_.forces[f];
    ScaledRegion& region = system_.regions[std::min(force.region, system_.regions.size() - 1)];
    const Vec2 at = (force.at - system_.origin) / system_.scale;
    const auto [on, where] = nearest_place(region.mesh, at);
    const Element& element = region.mesh.elements[on];
    const double off = norm(element.at(where) - at);
    if (off > 1e-4) return ForceOffBoundary{f, off * system_.scale};
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

void SystemBuilder::add_tractions() {
  for (std::size_t r = 0; r < system_.regions.size(); ++r) {
    ScaledRegion& region = system_.regions[r];
    const std::size_t count = region.mesh.elements.size();
    region.slot.assign(count, {});
    region.slot_sign.assign(count, {1, 1, 1});
  }
  for (const SideGroup& g : groups_) {
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

}  // namespace cleave::bem
