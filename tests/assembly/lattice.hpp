#pragma once

/// Many blocks with a known answer: a shell of unit cubes on a plane of 20 degrees, all held by friction of 30, and
/// loose cubes on top of it, each on a joint of 10 degrees. The loose ones slide, one by one; nothing else moves.

#include "builder.hpp"

namespace cleave::assembly::test {

struct Lattice {
  Builder builder{Freedom::rigid};
  std::vector<std::uint32_t> loose;
  double factor = tan_deg(10) / tan_deg(20);  ///< of each loose cube
};

/// `side` x `side` cubes in two layers (three would topple); every `every`th of the top one bears a loose cube.
/// Neighbours in a layer touch in joints of 30 degrees.
inline Lattice lattice(std::uint32_t side, std::uint32_t every = 6, Freedom freedom = Freedom::rigid) {
  constexpr std::uint32_t layers = 2;
  Lattice out;
  out.builder.spec.freedom = freedom;
  const Vec3 along{cos_deg(20), 0, -sin_deg(20)}, across{0, 1, 0}, up{sin_deg(20), 0, cos_deg(20)};
  const auto at = [&](double x, double y, double z) { return x * along + y * across + z * up; };
  const auto cube = [&](double x, double y, double z) {
    const std::uint32_t id = out.builder.block({0, 0, -1}, 1);
    out.builder.spec.bodies[id].centroid = at(x + 0.5, y + 0.5, z + 0.5);
    out.builder.spec.bodies[id].inertia = {1.0 / 6, 1.0 / 6, 1.0 / 6, 0, 0, 0};
    return id;
  };
  const auto corners = [&](double x, double y, double z, Vec3 a, Vec3 b) {
    const Vec3 p = at(x, y, z);
    return std::vector<Vec3>{p, p + a, p + a + b, p + b};
  };
  const auto number = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) { return (k * side + j) * side + i; };
  for (std::uint32_t k = 0; k < layers; ++k) {
    for (std::uint32_t j = 0; j < side; ++j) {
      for (std::uint32_t i = 0; i < side; ++i) {
        const std::uint32_t id = cube(i, j, k);
        const std::optional<std::uint32_t> below = k > 0 ? std::optional{number(i, j, k - 1)} : rock;
        out.builder.contact(id, below, up, tan_deg(30), corners(i, j, k, along, across));
        if (i > 0) out.builder.contact(id, number(i - 1, j, k), along, tan_deg(30), corners(i, j, k, across, up));
        if (j > 0) out.builder.contact(id, number(i, j - 1, k), across, tan_deg(30), corners(i, j, k, along, up));
      }
    }
  }
  for (std::uint32_t j = 0; j < side; ++j) {
    for (std::uint32_t i = j % every; i < side; i += every) {
      const std::uint32_t id = cube(i, j, layers);
      out.loose.push_back(id);
      out.builder.contact(id, number(i, j, layers - 1), up, tan_deg(10), corners(i, j, layers, along, across));
    }
  }
  return out;
}

}  // namespace cleave::assembly::test
