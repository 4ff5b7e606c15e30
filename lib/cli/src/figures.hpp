#pragma once

#include <string>

#include "cleave/realize/run_result.hpp"

namespace cleave::cli {

/// The key figures of a run, a few lines for people.
[[nodiscard]] std::string figures_of(const scene::RunResult& result);

/// The last line of a run whose support does not pass, or was not judged in full; empty where it passes.
[[nodiscard]] std::string verdict_of(const scene::RunResult& result);

/// "time ...": what it took.
[[nodiscard]] std::string cost_line(const scene::RunCost& cost);

/// log.txt: what ran, why, at what cost, with the notes and the key figures.
[[nodiscard]] std::string log_of(const scene::RunResult& result);

}  // namespace cleave::cli
