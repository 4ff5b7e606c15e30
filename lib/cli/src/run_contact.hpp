#pragma once

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/scene2d/contact.hpp"
#include "commands.hpp"
#include "interrupt.hpp"

namespace cleave::cli {

/// `cleave run` of a scene of contact.
[[nodiscard]] ExitCode run_contact(const RunArguments& arguments, const scene::ContactScene& scene, StageTimer& timer,
                                   Progress& progress, InterruptWatch& interrupts);

}  // namespace cleave::cli
