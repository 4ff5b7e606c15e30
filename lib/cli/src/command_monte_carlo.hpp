#pragma once

#include <vector>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/scene/monte_carlo.hpp"
#include "commands.hpp"
#include "interrupt.hpp"
#include "monte_carlo_folder.hpp"

namespace cleave::cli {

/// `cleave run` of a scene with [monte_carlo]. `make`: who makes the records instead of the threads of this process.
[[nodiscard]] ExitCode run_monte_carlo_scene(const scene::Scene& scene, const RunArguments& arguments,
                                             StageTimer& timer, Progress& progress, InterruptWatch& interrupts,
                                             const scene::MakeRecords* make = nullptr);

/// Writes the result of a run or a merge and says how the program ends.
[[nodiscard]] ExitCode publish_monte_carlo(const scene::Scene& scene, scene::MonteCarloResult result,
                                           MonteCarloFolder& folder, std::vector<MonteCarloFolder::File> copies,
                                           StageTimer& timer, unsigned threads, bool quiet, InterruptWatch* interrupts);

}  // namespace cleave::cli
