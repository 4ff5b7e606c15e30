#include "system_builder.hpp"

#include <cmath>
#include <span>

namespace cleave::bem {
namespace {

constexpr double corner_shift = 1.0 / 3;

std::uint32_t u32(std::size_t value) { return static_cast<std::uint32_t>(value); }

}  // namespace

void SystemBuilder::find_groups() {
  for (std::size_t r = 0; r < system_.regions.size(); ++r) {
    const Mesh& mesh = system_.regions[r].mesh;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      const Node& node = mesh.nodes[n];
      const auto add = [&](std::span<const Use> uses) {
        SideGroup g{
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

/// Directions in which the traction of a group is unknown.
std::vector<Vec2> SystemBuilder::unknown_directions(const SideGroup& g) {
  if (g.condition->bonded) return {{1, 0}, {0, 1}};
  std::vector<Vec2> out;
  const auto axes = g.axes();
  for (std::size_t k = 0; k < 2; ++k) {
    if (g.condition->component[k].given == Given::displacement) out.push_back(axes[k]);
  }
  return out;
}

void SystemBuilder::plan_equations() {
  for (std::size_t r = 0; r < system_.regions.size(); ++r) {
    const Mesh& mesh = system_.regions[r].mesh;
    std::vector<std::vector<const SideGroup*>> of_node(mesh.nodes.size());
    for (const SideGroup& g : groups_) {
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

}  // namespace cleave::bem
