#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "space.hpp"

namespace cleave::flow {

/// Numbers of a space that may not lie above a ceiling: heads on drained surfaces. Where they are held down to it water
/// comes out and never goes in; elsewhere none passes (Signorini's conditions).
struct Ceiling {
  std::vector<double> at;  ///< of each number; infinite where there is none
  double near = 0;         ///< m: no more above it than rounding
};

/// Heads of least energy under a ceiling.
struct Seepage {
  Eigen::MatrixXd heads = {};           ///< one column
  std::vector<std::uint8_t> held = {};  ///< numbers at the ceiling
  bool settled = false;
  double residual = 0;
  std::shared_ptr<const LeastEnergy> equations = {};  ///< the last ones that were solved
};

/// What hangs together in equations.
struct Equations {
  const Space& space;
  std::span<const Stiffness> stiffness;
  std::span<const std::uint8_t> wet;
};

/// From a guess: its heads solve the equations for its held numbers where `solved` says so. Numbers of `standing` are
/// given. False where equations have no solution.
[[nodiscard]] bool settle(const Equations& equations, std::span<const std::uint8_t> standing, const Ceiling& ceiling,
                          bool solved, Seepage& guess);

}  // namespace cleave::flow
