#pragma once

#include <expected>
#include <string>
#include <vector>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/realize/run_result.hpp"
#include "cleave/scene/plan.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "out_folder.hpp"

namespace cleave::cli {

struct PrintSettings {
  std::string scene;  ///< how messages name it
  bool quiet = false;
  std::string scene_text = {};  ///< kept as scene.toml; empty: none is
};

/// How a scene's [motion] begins and ends: goes on from --resume, or from an interrupted run of the same scene in OUT.
[[nodiscard]] std::expected<scene::MovingRun, std::vector<scene::Problem>> moving_run(const scene::Scene& scene,
                                                                                      const std::string& resume,
                                                                                      const std::string& out,
                                                                                      InterruptWatch& interrupts);

/// Writes all files of a single run, puts the folder in its place and prints the key figures.
[[nodiscard]] ExitCode write_and_publish(scene::RunResult& result, OutFolder& out, StageTimer& timer,
                                         Progress& progress, InterruptWatch& interrupts, const PrintSettings& settings);

}  // namespace cleave::cli
