#pragma once

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cleave/dbem/world.hpp"

/// Small scenes of blocks for the tests.
namespace cleave::dbem::scenes {

inline constexpr double g = 9.81;

inline double radians(double degrees) { return degrees * std::numbers::pi / 180; }

inline std::vector<Vec2> rectangle(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

inline std::vector<Vec2> turned(std::vector<Vec2> corners, double angle) {
  for (Vec2& c : corners) c = rotated(c, angle);
  return corners;
}

inline Body fixed(std::string name, std::vector<Vec2> corners) {
  Body body{.name = std::move(name), .outline = std::move(corners)};
  body.held = {true, true, true};
  return body;
}

inline Body block(std::string name, std::vector<Vec2> corners, double density = 2600) {
  return Body{.name = std::move(name), .outline = std::move(corners), .density = density};
}

inline Laws law(double friction, double restitution = 0) {
  Laws laws;
  laws.otherwise.friction = friction;
  laws.otherwise.restitution = restitution;
  return laws;
}

/// Body 0: a slope at `angle`; body 1: a block of width x height on it.
inline std::vector<Body> slider(double angle, double width = 1, double height = 0.5, Vec2 origin = {}) {
  std::vector<Body> bodies{fixed("slope", turned(rectangle(-10, -1, 20, 1), angle)),
                           block("block", turned(rectangle(5, 0, width, height), angle))};
  for (Body& body : bodies) body.origin = origin;
  return bodies;
}

inline std::vector<Body> stack(std::size_t count, double ratio_top = 1) {
  std::vector<Body> bodies{fixed("floor", rectangle(-5, -1, 10, 1))};
  for (std::size_t k = 0; k < count; ++k) {
    bodies.push_back(block(fmt::format("b{}", k), rectangle(-0.5, static_cast<double>(k), 1, 1),
                           k + 1 == count ? 2600 * ratio_top : 2600));
  }
  return bodies;
}

/// Body 0: the ground; then the voussoirs from right to left, arcs in `pieces` straight parts.
inline std::vector<Body> arch(std::size_t count, double thickness, std::size_t pieces = 6) {
  std::vector<Body> bodies{fixed("ground", rectangle(-3, -1, 6, 1))};
  const double a = 1 - thickness / 2;
  const double b = 1 + thickness / 2;
  const auto at = [](double r, double t) { return Vec2{r * std::cos(t), r * std::sin(t)}; };
  for (std::size_t k = 0; k < count; ++k) {
    const double t0 = std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
    const double t1 = std::numbers::pi * static_cast<double>(k + 1) / static_cast<double>(count);
    std::vector<Vec2> corners;
    for (std::size_t q = 0; q <= 2 * pieces + 1; ++q) {
      const bool out = q <= pieces;
      const double share = static_cast<double>(out ? q : 2 * pieces + 1 - q) / static_cast<double>(pieces);
      corners.push_back(at(out ? b : a, t0 + share * (t1 - t0)));
    }
    bodies.push_back(block(fmt::format("v{}", k), corners));
  }
  return bodies;
}

/// Throws when the scene is wrong.
inline World make(std::vector<Body> bodies, Laws laws, WorldOptions options) {
  auto world = World::make(std::move(bodies), std::move(laws), std::move(options));
  if (!world) throw std::runtime_error(describe(world.error()));
  return *std::move(world);
}

inline void run(World& world, double until) {
  while (world.time() < until * (1 - 1e-12)) {
    const auto report = world.step(until - world.time());
    if (!report) throw std::runtime_error(describe(report.error()));
  }
}

}  // namespace cleave::dbem::scenes
