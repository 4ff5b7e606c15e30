#pragma once

#include <utility>
#include <vector>

#include "cleave/facets/cut_input.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/solid.hpp"
#include "integer_scene.hpp"

namespace cleave::testing {

[[nodiscard]] inline geometry::Vec3 to_position(IntegerPoint p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}

[[nodiscard]] inline geometry::Solid to_solid(const IntegerSolid& solid) {
  std::vector<geometry::Vec3> vertices;
  for (const IntegerPoint p : solid.vertices) vertices.push_back(to_position(p));
  std::vector<geometry::SolidFace> faces;
  for (const auto& corners : solid.faces) faces.push_back({corners, 0});
  return geometry::Solid::make(std::move(vertices), std::move(faces)).value();
}

/// The scene for the cutter: the integers as metres, exactly.
[[nodiscard]] inline topology::CutInput to_cut_input(const IntegerScene& scene) {
  topology::CutInput input{.domain = scene.domain
                                         ? to_solid(*scene.domain)
                                         : geometry::make_box(to_position(scene.min), to_position(scene.max)).value(),
                           .joints = {},
                           .excavations = {},
                           .free_domain_tags = {}};
  for (const IntegerPolygon& joint : scene.joints) {
    std::vector<geometry::Vec3> corners;
    for (const IntegerPoint p : joint) corners.push_back(to_position(p));
    input.joints.emplace_back(topology::Joint{{geometry::Polygon::make(std::move(corners)).value()}});
  }
  for (const IntegerSolid& solid : scene.excavations) input.excavations.push_back(to_solid(solid));
  return input;
}

}  // namespace cleave::testing
