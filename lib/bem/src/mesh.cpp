#include "cleave/bem/problem.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cleave::bem {
namespace {

constexpr std::array<double, 1> at_middle{0.0};
constexpr std::array<double, 2> at_ends{-1.0, 1.0};
constexpr std::array<double, 3> at_three{-1.0, 0.0, 1.0};

/// Where along the side (0..1) a share k/n of its elements ends.
double graded(double share, double from_start, double from_end) {
  if (from_start == 1 && from_end == 1) return share;
  if (from_end == 1) return std::pow(share, from_start);
  if (from_start == 1) return 1 - std::pow(1 - share, from_end);
  return share <= 0.5 ? 0.5 * std::pow(2 * share, from_start) : 1 - 0.5 * std::pow(2 * (1 - share), from_end);
}

double extent_of(const std::vector<Loop>& loops) {
  Box2 box;
  for (const Loop& loop : loops) {
    for (std::size_t s = 0; s < loop.size(); ++s) {
      for (const double t : {0.0, 0.25, 0.5, 0.75}) box.add(point_on(loop, s, t).x);
    }
  }
  return std::max(box.high.x - box.low.x, box.high.y - box.low.y);
}

}  // namespace

std::span<const double> local_nodes(Order order) noexcept {
  switch (order) {
    case Order::constant: return at_middle;
    case Order::linear: return at_ends;
    case Order::quadratic: return at_three;
  }
  return {};
}

Mesh make_mesh(const std::vector<Loop>& loops, const MeshSize& size, Vec2 origin, double scale) {
  Mesh mesh{.order = size.order, .elements = {}, .nodes = {}};
  const double target = size.element ? *size.element : extent_of(loops) / 16;
  const std::size_t per = mesh.per_element();
  const auto local = [&](Vec2 x) { return (x - origin) / scale; };
  for (std::size_t l = 0; l < loops.size(); ++l) {
    const Loop& loop = loops[l];
    const std::size_t first_element = mesh.elements.size();
    const auto first_node = static_cast<std::uint32_t>(mesh.nodes.size());
    std::vector<bool> starts_corner;  // of each element's first node
    for (std::size_t s = 0; s < loop.size(); ++s) {
      const Side& side = loop[s];
      const double sweep = std::abs(sweep_of(loop, s));
      std::size_t count = std::max<std::size_t>(1, side.elements.value_or(1));
      if (!side.elements) {
        const double by_length = std::ceil(length_of(loop, s) / target - 1e-9);
        const double by_arc = std::ceil(sweep * (180 / std::numbers::pi) / size.arc_degrees - 1e-9);
        count = static_cast<std::size_t>(std::clamp(std::max(by_length, by_arc), 1.0, 1e5));
      }
      count *= size.subdivide;
      const std::size_t before = (s + loop.size() - 1) % loop.size();
      const Vec2 into = point_on(loop, before, 1).derivative;
      const Vec2 out = point_on(loop, s, 0).derivative;
      const bool turns = std::abs(std::atan2(cross(into, out), dot(into, out))) > 1e-7;
      for (std::size_t k = 0; k < count; ++k) {
        const double n = static_cast<double>(count);
        const double t0 = graded(static_cast<double>(k) / n, side.grade_start, side.grade_end);
        const double t1 = graded(static_cast<double>(k + 1) / n, side.grade_start, side.grade_end);
        const Vec2 a = local(point_on(loop, s, t0).x);
        const Vec2 b = k + 1 == count ? local(loop[(s + 1) % loop.size()].start) : local(point_on(loop, s, t1).x);
        Element e;
        e.loop = static_cast<std::uint32_t>(l);
        e.side = static_cast<std::uint32_t>(s);
        e.curved = sweep > 0;
        const Vec2 m = e.curved ? local(point_on(loop, s, 0.5 * (t0 + t1)).x) : 0.5 * (a + b);
        e.c0 = m;
        e.c1 = 0.5 * (b - a);
        e.c2 = e.curved ? 0.5 * (a + b) - m : Vec2{};
        mesh.elements.push_back(e);
        starts_corner.push_back(k == 0 && (turns || loop[before].condition != side.condition));
      }
    }
    const std::size_t count = mesh.elements.size() - first_element;
    const std::size_t step = std::max<std::size_t>(per - 1, 1);
    const std::size_t nodes = count * step;
    for (std::size_t i = 0; i < nodes; ++i) mesh.nodes.emplace_back();
    for (std::size_t k = 0; k < count; ++k) {
      Element& e = mesh.elements[first_element + k];
      for (std::size_t a = 0; a < per; ++a) {
        const auto id = static_cast<std::uint32_t>(first_node + (k * step + a) % nodes);
        e.node[a] = id;
        mesh.nodes[id].x = e.at(local_nodes(size.order)[a]);
      }
      if (per > 1) mesh.nodes[e.node[0]].corner = starts_corner[k];
    }
    for (std::size_t pass = 0; pass < 2; ++pass) {  // ends first
      for (std::size_t k = 0; k < count; ++k) {
        const auto id = static_cast<std::uint32_t>(first_element + k);
        for (std::size_t a = 0; a < per; ++a) {
          const bool ends = per > 1 && a + 1 == per;
          if (ends == (pass == 0)) {
            mesh.nodes[mesh.elements[id].node[a]].uses.push_back({id, static_cast<std::uint32_t>(a)});
          }
        }
      }
    }
  }
  return mesh;
}

BoundaryPlace nearest_place(const Mesh& mesh, Vec2 x) {
  BoundaryPlace best;
  double closest = 1e300;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const Element& element = mesh.elements[e];
    double s = std::clamp(dot(x - element.c0, element.c1) / dot(element.c1, element.c1), -1.0, 1.0);
    for (int pass = 0; pass < 20 && element.curved; ++pass) {
      const Vec2 t = element.derivative(s);
      s = std::clamp(s + dot(x - element.at(s), t) / dot(t, t), -1.0, 1.0);
    }
    if (const double d = norm(element.at(s) - x); d < closest) {
      closest = d;
      best = {e, s};
    }
  }
  return best;
}

}  // namespace cleave::bem
