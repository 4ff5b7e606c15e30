#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cleave/bem/outline.hpp"
#include "cleave/bem/vec2.hpp"

namespace cleave::bem {

/// Polynomial order of displacement and traction on an element.
enum class Order : std::uint8_t { constant = 0, linear = 1, quadratic = 2 };
[[nodiscard]] constexpr std::size_t nodes_of(Order order) noexcept { return static_cast<std::size_t>(order) + 1; }

/// x(s) = c0 + c1 s + c2 s^2, s in [-1, 1]; straight sides are exactly straight (c2 = 0), arcs quadratic.
struct Element {
  Vec2 c0, c1, c2;
  bool curved = false;
  std::array<std::uint32_t, 3> node{};  ///< displacement nodes, nodes_of(order) of them
  std::uint32_t loop = 0;
  std::uint32_t side = 0;

  [[nodiscard]] Vec2 at(double s) const noexcept { return c0 + s * (c1 + s * c2); }
  [[nodiscard]] Vec2 derivative(double s) const noexcept { return c1 + (2 * s) * c2; }
  [[nodiscard]] Vec2 normal(double s) const noexcept {
    const Vec2 t = derivative(s);
    return turned_right(t) / norm(t);
  }
};

/// Values of the shape functions at s, and their derivatives; unused places are 0.
[[nodiscard]] constexpr std::array<double, 3> shape(Order order, double s) noexcept {
  switch (order) {
    case Order::constant: return {1, 0, 0};
    case Order::linear: return {(1 - s) / 2, (1 + s) / 2, 0};
    case Order::quadratic: return {s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2};
  }
  return {};
}
[[nodiscard]] constexpr std::array<double, 3> shape_slope(Order order, double s) noexcept {
  switch (order) {
    case Order::constant: return {0, 0, 0};
    case Order::linear: return {-0.5, 0.5, 0};
    case Order::quadratic: return {s - 0.5, -2 * s, s + 0.5};
  }
  return {};
}
/// Second derivatives (constant).
[[nodiscard]] constexpr std::array<double, 3> shape_curve(Order order) noexcept {
  return order == Order::quadratic ? std::array<double, 3>{1, -2, 1} : std::array<double, 3>{0, 0, 0};
}
/// Local coordinates of the nodes.
[[nodiscard]] std::span<const double> local_nodes(Order order) noexcept;

/// One element of which a node is part.
struct Use {
  std::uint32_t element;
  std::uint32_t local;
};

struct Node {
  Vec2 x;
  std::vector<Use> uses;  ///< the element that ends here first, then the one that starts
  bool corner = false;    ///< the outline turns here (by more than 1e-7 rad), or the condition changes
};

/// Elements and nodes of one region's boundary.
struct Mesh {
  Order order = Order::quadratic;
  std::vector<Element> elements;
  std::vector<Node> nodes;

  [[nodiscard]] std::size_t per_element() const noexcept { return nodes_of(order); }
};

struct MeshSize {
  Order order = Order::quadratic;
  double element = 0;         ///< longest element, m; 0: a sixteenth of the outline's larger extent
  double arc_degrees = 15;    ///< at most this much of an arc on one element
  std::size_t subdivide = 1;  ///< every element count is multiplied by this
};

/// Coordinates become (x - origin) / scale. Precondition: the loops have passed check_loops.
[[nodiscard]] Mesh make_mesh(const std::vector<Loop>& loops, const MeshSize& size, Vec2 origin = {}, double scale = 1);

}  // namespace cleave::bem
