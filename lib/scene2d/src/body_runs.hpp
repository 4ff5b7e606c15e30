#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cleave/bem/block.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/scene2d/bodies.hpp"

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

/// Stress in axes that the body has turned by `angle`.
[[nodiscard]] bem::Sym2 in_world(bem::Sym2 own, double angle);
[[nodiscard]] double von_mises(bem::Sym2 in_plane, double out_of_plane);
/// Largest, middle and smallest, tension positive.
[[nodiscard]] std::array<double, 3> principal(bem::Sym2 in_plane, double out_of_plane);

/// What a series of runs is about. At rest changes fall as the order of the elements and the corners say, moving they
/// are the worst of many moments and fall by chance now and then. On very coarse meshes at rest, and next to point
/// forces, which are spread over an element, no order shows.
enum class Course : std::uint8_t { at_rest, at_rest_coarse, moving };

/// An estimate of the error, or why there is none.
struct ErrorEstimate {
  std::optional<double> error;
  std::string why_not;
};
/// From the change between runs of a quarter and half the elements, and from that to the run itself. Changes that fall
/// like a geometric series add up to the last times r / (1 - r).
[[nodiscard]] ErrorEstimate estimate_from(double first_change, double last_change, Course course);

/// Lowest natural frequencies of a body with these supports, Hz; without rigid motions.
[[nodiscard]] std::vector<double> frequencies_of(const bem::Modes& modes, std::size_t count);

/// Held freedoms and springs of a body's sides on a block operator.
struct NodeSupports {
  std::vector<bem::HeldFreedom> held;
  std::vector<bem::NodeSpring> springs;
};
[[nodiscard]] NodeSupports supports_of(const bem::BlockOperator& block, const BodySpec& spec);

/// Scenes with [elastic.time]. Notes, frames and histories go into the result.
[[nodiscard]] std::optional<Problem> run_motion(const BodiesScene& scene, unsigned threads, BodiesResult& result,
                                                Progress& progress);

}  // namespace cleave::scene
