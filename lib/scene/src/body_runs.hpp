#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cleave/core/progress.hpp"
#include "cleave/scene/bodies.hpp"

/// What runs of bodies share.
namespace cleave::scene {

[[nodiscard]] Problem problem_of(const BodiesScene& scene, std::size_t body, const std::string& what);

constexpr std::size_t samples_of_element = 6;  ///< for drawing

/// Values along every loop of a mesh, closed.
template <class Value, class At>
std::vector<std::vector<Value>> along(const bem::Mesh& mesh, const At& at) {
  std::vector<std::vector<Value>> loops;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    if (mesh.elements[e].loop >= loops.size()) loops.resize(mesh.elements[e].loop + 1);
    for (std::size_t k = 0; k < samples_of_element; ++k) {
      loops[mesh.elements[e].loop].push_back(at(e, -1 + 2 * static_cast<double>(k) / samples_of_element));
    }
  }
  for (auto& loop : loops) loop.push_back(loop.front());
  return loops;
}

/// Scenes with [elastic.time]. Notes, frames and histories go into the result.
[[nodiscard]] std::optional<Problem> run_motion(const BodiesScene& scene, unsigned threads, BodiesResult& result,
                                                Progress& progress);

}  // namespace cleave::scene
