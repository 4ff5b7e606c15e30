#pragma once

#include <fmt/format.h>

#include <expected>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "cleave/core/cost.hpp"
#include "cleave/report/write.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/scene/run.hpp"
#include "commands.hpp"
#include "interrupt.hpp"
#include "out_folder.hpp"
#include "problems.hpp"

namespace cleave::cli {

/// What scenes of bodies and scenes of contact do differently.
template <class Result>
struct PlaneRun {
  using Written = std::expected<void, report::WriteError>;
  using Write = std::function<Written(const Result&, const std::filesystem::path&)>;
  std::function<std::expected<Result, std::vector<scene::Problem>>()> run;
  Write files, page, summary;
  std::function<std::string(const Result&)> figures;    ///< for the terminal
  std::function<std::string(const Result&)> complaint;  ///< "KEY: why it stopped", when it did not converge
};

template <class Result>
[[nodiscard]] std::string plane_log_of(const Result& result) {
  std::string text = fmt::format("{} ({})\n", result.title, result.scene_file);
  text += describe(result.plan);
  for (const std::string& note : result.notes) text += "note: " + note + "\n";
  return text;
}

/// Runs a plane scene, writes its files (summary.json last, with what the others cost) and puts the folder in place.
template <class Result>
[[nodiscard]] ExitCode run_plane(const RunArguments& arguments, StageTimer& timer, InterruptWatch& interrupts,
                                 const PlaneRun<Result>& scene) {
  auto out = OutFolder::prepare(arguments.out);
  if (!out) {
    complain(out.error().message);
    return out.error().code;
  }
  interrupts.on_interrupt([&] { out->discard(); });
  const ExitCode end = [&] {
    auto result = scene.run();
    if (!result) return report_problems(result.error());
    auto written = timer.run("write", [&] { return scene.files(*result, out->folder()); });
    result->cost = scene::cost_of(timer, arguments.threads);
    if (written && result->output.report) {
      written = timer.run("report", [&] { return scene.page(*result, out->folder()); });
      result->cost = scene::cost_of(timer, arguments.threads);
    }
    if (written) written = report::write_file(out->folder() / "log.txt", plane_log_of(*result));
    if (written) written = scene.summary(*result, out->folder());
    if (!written) {
      complain(describe(written.error()));
      return ExitCode::machine_failed;
    }
    if (auto published = interrupts.guarded([&] { return out->publish(); }); !published) {
      complain(published.error().message);
      return published.error().code;
    }
    if (!arguments.quiet) {
      std::string text = scene.figures(*result);
      for (const std::string& note : result->notes) text += "note: " + note + "\n";
      say(text + fmt::format("result in {}\n", out->final_name().generic_string()));
    }
    if (result->converged) return ExitCode::done;
    complain(fmt::format("{}:1: {}", arguments.scene, scene.complaint(*result)));
    return ExitCode::check_failed;
  }();
  interrupts.guarded([&] { out->discard(); });
  interrupts.on_interrupt({});
  return end;
}

}  // namespace cleave::cli
