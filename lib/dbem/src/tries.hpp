#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "natural_map.hpp"

/// The methods one by one: forces, and whether the method itself is content with them. The residual is judged outside.
namespace cleave::dbem {

struct SolverAttempt {
  std::vector<Vec2> p;
  bool converged = false;
  std::size_t iterations = 0;
};

/// Newton on the natural map of W + soft diag(W) about `centre` (empty: about no forces), at most `most` linear solves;
/// `give_up`: times the start's squared distance at which it ends.
SolverAttempt newton(PatternSolver& linear, const ContactProblem& problem, double soft, double tolerance,
                     std::size_t most, std::vector<Vec2> start, std::span<const Vec2> centre = {},
                     double give_up = 1e300);

/// One linear solve with each contact in the state its force tells: open without one, slipping at the bound, else
/// stuck. From step to step few states change, while the natural map at the old forces takes many for changed.
SolverAttempt frozen_state_solve(PatternSolver& linear, const ContactProblem& problem, const std::vector<Vec2>& start,
                                 double soft = 0);

/// Shi's iteration with implicit friction in the slip rows. Starts from all contacts closed and stuck.
SolverAttempt open_close(PatternSolver& linear, const ContactProblem& problem, std::size_t passes);

/// Newton from the side of soft contacts: W + e diag(W), e falling from 1 by `factor`.
SolverAttempt continuation(PatternSolver& linear, const ContactProblem& problem, const SolverOptions& options,
                           double factor);

/// Sweeps over the contacts, each solved alone (block Gauss-Seidel), on W + e diag(W) about `centre`. A cheap start for
/// Newton where e is large.
void sweep(const ContactProblem& problem, Work& work, double soft, const std::vector<Vec2>& centre, int sweeps,
           std::vector<Vec2>& p);

/// Proximal points: Newton on W + e diag(W) about the last answer, e as small as Newton bears. Forces that equilibrium
/// leaves open stay where they are instead of swinging, and what equilibrium fixes converges by e / (e + sigma). Inner
/// answers need be no better than the outer ones (Rockafellar 1976).
SolverAttempt proximal(PatternSolver& linear, const ContactProblem& given, std::vector<Vec2> start, double enough,
                       std::size_t max_linear_solves);

}  // namespace cleave::dbem
