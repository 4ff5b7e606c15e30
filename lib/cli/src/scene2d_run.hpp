#pragma once

#include <fmt/format.h>

#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cleave/scene/problem.hpp"
#include "problems.hpp"
#include "publish.hpp"

namespace cleave::cli {

/// What two-dimensional scenes do differently.
template <class Result>
struct Scene2dRun {
  std::function<std::expected<Result, std::vector<scene::Problem>>()> run;
  Files<Result> files;                                  ///< without the log
  std::function<std::string(const Result&)> complaint;  ///< "KEY: why it stopped", when it did not converge
  /// How the program ends then, and what it says beside; empty: the complaint.
  std::function<std::optional<ExitCode>(const Result&)> stopped = {};
};

template <class Result>
[[nodiscard]] std::string scene2d_log_of(const Result& result) {
  std::string text = fmt::format("{} ({})\n", result.title, result.scene_file) + describe(result.plan);
  for (const std::string& note : result.notes) text += "note: " + note + "\n";
  return text;
}

template <class Result>
[[nodiscard]] ExitCode run_scene2d(const RunArguments& arguments, StageTimer& timer, Progress& progress,
                                   InterruptWatch& interrupts, Scene2dRun<Result> scene) {
  scene.files.log = scene2d_log_of<Result>;
  scene.files.scene_text = arguments.scene_text;
  return in_out_folder(arguments.out, interrupts, [&](OutFolder& out) {
    auto result = scene.run();
    if (!result) return report_problems(result.error());
    if (const auto failed = publish(*result, scene.files, out, timer, progress, interrupts, arguments.quiet)) {
      return *failed;
    }
    if (result->converged) return ExitCode::done;
    if (scene.stopped) {
      if (const auto code = scene.stopped(*result)) return *code;
    }
    print_error(fmt::format("{}:1: {}", arguments.scene, scene.complaint(*result)));
    return ExitCode::check_failed;
  });
}

}  // namespace cleave::cli
