#pragma once

/// Many blocks: slices on a circle, columns that topple, arches, stacks.

#include <algorithm>

#include "builder.hpp"

namespace cleave::assembly::test {

/// A face of 45 degrees, 10 m high, over a circle through its foot in slices of equal width.
inline Builder circle(Freedom freedom, int slices = 10, double phi = 35) {
  const double cx = 2, cz = 16, r2 = cx * cx + cz * cz, end = cx + std::sqrt(r2 - (cz - 10) * (cz - 10));
  const auto low = [&](double x) { return cz - std::sqrt(std::max(r2 - (x - cx) * (x - cx), 0.0)); };
  const auto top = [](double x) { return std::min(x, 10.0); };
  Builder b{freedom};
  for (int k = 0; k < slices; ++k) {
    const double p = end * k / slices, q = end * (k + 1) / slices;
    std::vector<P2> corners{{p, low(p)}, {q, low(q)}};
    if (top(q) - low(q) > 1e-9) corners.push_back({q, top(q)});
    if (p < 10 && 10 < q) corners.push_back({10, 10});
    if (top(p) - low(p) > 1e-9) corners.push_back({p, top(p)});
    const std::uint32_t id = b.polygon(corners, 20);
    b.edge(id, rock, {p, low(p)}, {q, low(q)}, tan_deg(phi));
    if (k > 0) b.edge(id, id - 1, {p, top(p)}, {p, low(p)}, tan_deg(phi));
  }
  return b;
}

inline Builder column(double height, Freedom freedom = Freedom::section) {
  const double c = cos_deg(20), s = sin_deg(20);
  Builder b{freedom};
  b.polygon({{0, 0}, {c, -s}, {c + height * s, -s + height * c}, {height * s, height * c}});
  b.edge(0, rock, {0, 0}, {c, -s}, tan_deg(40));
  return b;
}

/// Ring of `stones` over the angle `opening` about the crown, mean radius `radius`.
inline Builder arch(double radius, double thickness, double opening, int stones, double friction, P2 g = {0, -1}) {
  constexpr int sides = 48;
  const double first = std::numbers::pi / 2 - opening / 2, in = radius - thickness / 2, out = radius + thickness / 2;
  const auto at = [](double r, double angle) { return P2{r * std::cos(angle), r * std::sin(angle)}; };
  const auto joint = [&](int k) { return first + opening * k / stones; };
  Builder b{Freedom::section};
  for (int k = 0; k < stones; ++k) {
    const double p = joint(k), q = joint(k + 1);
    std::vector<P2> corners;
    for (int i = 0; i <= sides; ++i) corners.push_back(at(out, p + (q - p) * i / sides));
    for (int i = 0; i <= sides; ++i) corners.push_back(at(in, q - (q - p) * i / sides));
    b.polygon(corners, 1, g);
  }
  const auto last = static_cast<std::uint32_t>(stones - 1);
  b.edge(0, rock, at(in, joint(0)), at(out, joint(0)), friction);
  for (std::uint32_t k = 1; k <= last; ++k) {
    const double angle = joint(static_cast<int>(k));
    b.edge(k, k - 1, at(in, angle), at(out, angle), friction);
  }
  b.edge(last, rock, at(out, joint(stones)), at(in, joint(stones)), friction);
  return b;
}

inline Builder level_stack() {
  Builder b{Freedom::section};
  b.polygon({{0, 0}, {3, 0}, {3, 1}, {0, 1}});
  b.polygon({{.5, 1}, {2.5, 1}, {2.5, 2}, {.5, 2}});
  b.polygon({{1, 2}, {2, 2}, {2, 3}, {1, 3}});
  b.edge(0, rock, {0, 0}, {3, 0}, .5);
  b.edge(1, 0, {.5, 1}, {2.5, 1}, .5);
  b.edge(2, 1, {1, 2}, {2, 2}, .5);
  return b;
}

/// Bricks over the edge of a table, each as far over the one below as it goes, times `share`.
inline Builder harmonic(int bricks, double share) {
  Builder b{Freedom::section};
  double right = 0, below = 0;
  for (int k = 0; k < bricks; ++k) {
    right += share / (2.0 * (bricks - k));
    const double z = 0.25 * k;
    const std::uint32_t id = b.polygon({{right - 1, z}, {right, z}, {right, z + 0.25}, {right - 1, z + 0.25}});
    b.edge(id, k == 0 ? rock : std::optional{id - 1}, {right - 1, z}, {below, z}, .5);
    below = right;
  }
  return b;
}

/// A flat roof of blocks 1 x 1 m between vertical joints.
inline Builder voussoirs() {
  Builder b{Freedom::section};
  const double m = tan_deg(35);
  for (int k = 0; k < 6; ++k) {
    const double x = k;
    const std::uint32_t id = b.polygon({{x, 0}, {x + 1, 0}, {x + 1, 1}, {x, 1}}, 25);
    b.edge(id, k == 0 ? rock : std::optional{id - 1}, {x, 1}, {x, 0}, m);
  }
  b.edge(5, rock, {6, 0}, {6, 1}, m);
  return b;
}
/// The same in translation under a thrust of `thrust` that its joints are known to carry.
inline Builder confined_voussoirs(double thrust) {
  Builder b{Freedom::section_translation};
  const double m = tan_deg(35);
  for (std::uint32_t k = 0; k < 6; ++k) b.block({0, 0, -25}, 25);
  const auto joint = [&](std::uint32_t body, std::optional<std::uint32_t> other, double side) {
    b.contact(body, other, {side, 0, 0}, 0).bonds = {{.corners = {}, .cohesion = m * thrust}};
  };
  for (std::uint32_t k = 0; k < 6; ++k) joint(k, k == 0 ? rock : std::optional{k - 1}, 1);
  joint(5, rock, -1);
  return b;
}

/// Goodman and Bray (1976): sixteen columns on steps.
inline Builder toppling_columns(double phi, double anchor = 0) {
  const double m = tan_deg(phi);
  const P2 g{-sin_deg(30), -cos_deg(30)};
  Builder b{Freedom::section};
  std::vector<double> height;
  for (int k = 1; k <= 10; ++k) height.push_back(4.0 * k);
  for (int k = 1; k <= 6; ++k) height.push_back(40 - 6.0 * k);
  for (std::uint32_t k = 0; k < 16; ++k) {
    const double x = 10.0 * k, z = k + 1.0;
    b.polygon({{x, z}, {x + 10, z}, {x + 10, z + height[k]}, {x, z + height[k]}}, 25, g);
  }
  for (std::uint32_t k = 0; k < 16; ++k) {
    const double x = 10.0 * k, z = k + 1.0;
    b.edge(k, rock, {x, z}, {x + 10, z}, m);
    if (k == 15) break;
    b.edge(k, rock, {x + 10, z}, {x + 10, z + 1}, m);
    b.edge(k, k + 1, {x + 10, z + 1}, {x + 10, std::min(z + height[k], z + 1 + height[k + 1])}, m);
  }
  if (anchor > 0) {
    Body& low = b.spec.bodies[0];
    const Vec3 force{anchor * cos_deg(30), 0, -anchor * sin_deg(30)}, arm = Vec3{0, 0, 5} - low.centroid;
    low.force += force;
    low.moment += cross(arm, force);
  }
  return b;
}

/// Half a lune of a dome without hoop forces: stones whose weight goes with the distance from the axis; smooth crown.
inline Builder lune(double thickness, int stones = 16) {
  Builder b{Freedom::section};
  const auto at = [](double r, double angle) { return P2{r * std::cos(angle), r * std::sin(angle)}; };
  const double in = 1 - thickness / 2, out = 1 + thickness / 2;
  for (int k = 0; k < stones; ++k) {
    const double p = std::numbers::pi / 2 * k / stones, q = std::numbers::pi / 2 * (k + 1) / stones;
    // Integrals of x over the sector, of x^2 and of x z.
    const double r3 = (std::pow(out, 3) - std::pow(in, 3)) / 3, r4 = (std::pow(out, 4) - std::pow(in, 4)) / 4;
    const double weight = r3 * (std::sin(q) - std::sin(p));
    const double x = r4 * ((q - p) / 2 + (std::sin(2 * q) - std::sin(2 * p)) / 4) / weight;
    const double z = r4 * (std::cos(2 * p) - std::cos(2 * q)) / 4 / weight;
    b.spec.bodies.push_back({.centroid = {x, 0, z}, .force = {0, 0, -weight}, .moment = {}, .mass = weight});
    for (double& i : b.spec.bodies.back().inertia) i *= weight * thickness * thickness;
  }
  for (int k = 0; k <= stones; ++k) {
    const double angle = std::numbers::pi / 2 * k / stones;
    const P2 inside = at(in, angle), outside = at(out, angle);
    const auto id = static_cast<std::uint32_t>(k);
    if (k == 0) b.edge(0, rock, inside, outside, 1e3);
    if (k > 0 && k < stones) b.edge(id, id - 1, inside, outside, 1e3);
    if (k == stones) b.edge(id - 1, rock, outside, inside, 0);
  }
  return b;
}

}  // namespace cleave::assembly::test
