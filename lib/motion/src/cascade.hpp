#pragma once

#include "solver.hpp"

namespace cleave::motion {

/// One way to solve the law after the other, keeping the best answer: its impulses, velocities and residual, the way
/// that found it and what that took. Whether it is good enough is told by the residual.
[[nodiscard]] Solution best_answer(const Group& group, const SolverOptions& options);

}  // namespace cleave::motion
