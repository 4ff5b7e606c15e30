#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "cleave/geometry/solid.hpp"
#include "cleave/topology/cut.hpp"

namespace cleave::statics {

inline const double slope = std::tan(35 * std::numbers::pi / 180);

inline topology::Joint polygon(std::vector<geometry::Vec3> corners) {
  return {{geometry::Polygon::make(std::move(corners)).value()}};
}

/// A slope of 35 degrees; a slab 2 m thick on a joint along it behind a toe on a level joint, both between two walls.
inline topology::CutInput slab_behind_toe(double width = 6) {
  const double low = -5, y0 = 2, y1 = 2 + width, far = 10;
  const auto face = [](double x) { return 40 - x * slope; };
  const std::array<std::array<double, 2>, 4> profile{{{low, 0}, {31, 0}, {31, face(31)}, {low, face(low)}}};
  std::vector<geometry::Vec3> vertices;
  for (const double y : {-4.0, far + 4}) {
    for (const auto& [x, z] : profile) vertices.push_back({x, y, z});
  }
  std::vector<geometry::SolidFace> faces{{{0, 1, 2, 3}, 0}, {{7, 6, 5, 4}, 0}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t j = (i + 1) % 4;
    faces.push_back({{j, i, i + 4, j + 4}, i == 1 || i == 2 ? 1U : 0U});
  }
  const double e = 0.05;
  const auto base = [&](double x) { return 38 - x * slope; };
  const auto across = [&](double x, double bottom) {
    return polygon({{x, y0 - e, bottom}, {x, y1 + e, bottom}, {x, y1 + e, 45}, {x, y0 - e, 45}});
  };
  const auto wall = [&](double y) {
    return polygon(
        {{4 - e, y, 45}, {4 - e, y, base(4) - e}, {30, y, base(30) - 2}, {32, y, base(30) - 2}, {32, y, 45}});
  };
  return {.domain = geometry::Solid::make(vertices, faces, {"rock", "ground"}).value(),
          .joints = {polygon({{4 - e, y0 - e, base(4 - e)},
                              {30 + e, y0 - e, base(30 + e)},
                              {30 + e, y1 + e, base(30 + e)},
                              {4 - e, y1 + e, base(4 - e)}}),
                     polygon({{30 - e, y0 - e, 15.5}, {32, y0 - e, 15.5}, {32, y1 + e, 15.5}, {30 - e, y1 + e, 15.5}}),
                     across(30, 15.5 - e), across(4, base(4) - e), wall(y0), wall(y1)},
          .excavations = {},
          .free_domain_tags = {1}};
}

}  // namespace cleave::statics
