#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "allocation.hpp"
#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/realize/run.hpp"
#include "command_monte_carlo.hpp"
#include "problems.hpp"
#include "publish.hpp"
#include "write_result.hpp"

namespace cleave::cli {
namespace {

/// As [motion] of the scene says, or its defaults.
void let_move(double seconds, scene::Scene& scene) {
  if (!scene.motion) scene.motion.emplace();
  if (seconds > 0) scene.motion->duration = Time::from_si(seconds);
  scene.output.only_key_blocks = false;  // what is not cut cannot be fallen on
}

}  // namespace

ExitCode replay_realization(const ReplayArguments& arguments) {
  namespace fs = std::filesystem;
  keep_freed_memory(arguments.threads);
  InterruptWatch interrupts;
  StageTimer timer;
  Progress progress{progress_style_of_stderr(arguments.quiet)};
  auto scene = timer.run("read", [&] { return load_copied_scene(arguments.result); });
  if (!scene) return report_problems(scene.error());
  std::error_code ignored;
  const fs::path result{arguments.result};
  const fs::path records =
      fs::exists(result / records_name, ignored) ? result / records_name : result / unfinished_name;
  std::optional<stochastic::Record> stored;
  auto identity = stochastic::read_records(records, [&](const stochastic::Record& record, std::string_view) {
    if (record.realization == arguments.realization) stored = record;
    return !stored;
  });
  const auto wrong = [&](const std::string& what) {
    print_error(fmt::format("{}:1: OUT: {}", arguments.result, what));
    return ExitCode::wrong_input;
  };
  if (!identity) return wrong("realizations.csv: " + describe(identity.error()));
  if (!scene->monte_carlo || scene_and_files_sha256(*scene) != identity->scene_sha256) {
    return wrong("its copy of the scene is not the one its records come from; run the scene again");
  }
  if (!stored) {
    return wrong(fmt::format("has no realization {}; give --realization a number that its realizations.csv lists",
                             arguments.realization));
  }
  scene->seed = identity->seed;
  scene->title += fmt::format(" (realization {})", arguments.realization);
  const std::string out =
      arguments.out.value_or((result / fmt::format("realization_{}", arguments.realization)).string());
  const scene::Shared shared{.questions = questions_of(*scene), .fields = nullptr, .lines = lines_in_rock(*scene)};
  if (arguments.motion) {
    if (!scene->stability) return wrong("nothing is judged in its scene, so no block is let go; run without --motion");
    let_move(*arguments.motion, *scene);
  }
  auto moving = moving_run(*scene, {}, out, interrupts);
  if (!moving) return report_problems(moving.error());
  const scene::RunOptions options{
      .threads = arguments.threads, .realization = arguments.realization, .motion = *std::move(moving)};
  return in_out_folder(out, interrupts, [&](OutFolder& folder) {
    auto run = scene::run(*scene, options, timer, progress);
    if (!run) return report_problems(run.error());
    const stochastic::Record again = record_of(arguments.realization, *run, *scene, shared);
    const bool same = line_of(again) == line_of(*stored);
    run->notes.push_back(fmt::format("realization {} of a Monte Carlo run; its record {}", arguments.realization,
                                     same ? "is reproduced to the last digit" : "is NOT reproduced"));
    const ExitCode end =
        write_and_publish(*run, folder, timer, progress, interrupts, {arguments.result, arguments.quiet});
    if (end != ExitCode::done || same) return end;
    print_error(
        fmt::format("{}:1: realizations.csv: the record of realization {} is not reproduced; was it made by "
                    "another build of cleave?",
                    arguments.result, arguments.realization));
    return ExitCode::check_failed;
  });
}

}  // namespace cleave::cli
