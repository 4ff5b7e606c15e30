#pragma once

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/scene2d/bodies.hpp"
#include "commands.hpp"
#include "interrupt.hpp"

namespace cleave::cli {

/// `cleave run` of a scene of bodies.
[[nodiscard]] ExitCode run_bodies(const RunArguments& arguments, const scene::BodiesScene& scene, StageTimer& timer,
                                  Progress& progress, InterruptWatch& interrupts);

}  // namespace cleave::cli
