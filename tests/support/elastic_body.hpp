#pragma once

/// Elastic blocks from the boundary elements, for tests and studies of contact.

#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "cleave/bem/block.hpp"
#include "cleave/dbem/body.hpp"

namespace cleave::support {

struct ElasticMaterial {
  double young = 1e8;  ///< Pa
  double poisson = 0.25;
  double density = 2600;
};

/// The corners of every boundary-element node and the lowest `modes` shapes of the free body.
inline dbem::Body elastic_body(const std::vector<bem::Vec2>& corners, const ElasticMaterial& material,
                               std::size_t per_side, std::size_t modes) {
  bem::BlockOptions options;
  options.bubbles = 2;
  const auto stuff =
      bem::Material::make(pascals(material.young), material.poisson, kilograms_per_cubic_metre(material.density));
  const bem::BlockOperator block =
      bem::BlockOperator::make({bem::polygon(corners, 0, per_side)}, stuff.value(), options).value();
  const bem::Modes free = bem::free_modes(block, modes);
  dbem::Body body;
  body.density = material.density;
  dbem::ModalBasis basis;
  for (const double value : free.eigenvalues) basis.omega.push_back(std::sqrt(value));
  const bem::Mesh& mesh = block.mesh();
  for (const bem::Element& element : mesh.elements) {
    for (std::size_t k = 0; k + 1 < mesh.per_element(); ++k) {
      const std::size_t node = element.node[k];
      body.outline.push_back(mesh.nodes[node].x);
      for (const std::size_t row : {2 * node, 2 * node + 1}) {
        for (std::size_t m = 0; m < basis.omega.size(); ++m) basis.shapes.push_back(free.shapes(row, m));
      }
    }
  }
  body.origin = block.centroid();
  body.modes = std::move(basis);
  return body;
}

}  // namespace cleave::support
