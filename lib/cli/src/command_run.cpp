#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iterator>
#include <utility>

#include "allocation.hpp"
#include "cleave/core/cost.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/core/sha256.hpp"
#include "cleave/load/load.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/report/write.hpp"
#include "command_monte_carlo.hpp"
#include "commands.hpp"
#include "figures.hpp"
#include "interrupt.hpp"
#include "problems.hpp"
#include "publish.hpp"
#include "run_bodies.hpp"
#include "run_contact.hpp"
#include "saved_runs.hpp"
#include "write_result.hpp"

namespace cleave::cli {
namespace {

using Written = std::expected<void, report::WriteError>;

Written write_files(scene::RunResult& result, const std::filesystem::path& folder) {
  CLEAVE_CHECK(report::write_blocks_vtu(result, folder));
  CLEAVE_CHECK(report::write_dangling(result, folder));
  CLEAVE_CHECK(report::write_motion(result, folder));
  CLEAVE_CHECK(report::write_mapped(result, folder));
  CLEAVE_CHECK(report::write_flow(result, folder));
  for (const auto write : {report::write_exports, report::write_sections}) {
    CLEAVE_TRY(std::vector<std::string> notes, write(result, folder));
    std::ranges::move(notes, std::back_inserter(result.notes));
  }
  return report::write_key_blocks_csv(result, folder);
}

}  // namespace

std::expected<scene::MovingRun, std::vector<scene::Problem>> moving_run(const scene::Scene& scene,
                                                                        const std::string& resume,
                                                                        const std::string& out,
                                                                        InterruptWatch& interrupts) {
  if (!scene.motion) return {};
  CLEAVE_TRY(auto from, find_state(resume, out,
                                   {.file = scene::motion_state_name,
                                    .section = "motion",
                                    .sha256 = scene.sha256,
                                    .title = scene.title,
                                    .seed = scene.seed}));
  return scene::MovingRun{.from = std::move(from), .stop = stop_between_steps(interrupts)};
}

ExitCode write_and_publish(scene::RunResult& result, OutFolder& out, StageTimer& timer, Progress& progress,
                           InterruptWatch& interrupts, const PrintSettings& settings) {
  const Files<scene::RunResult> files{.write = write_files,
                                      .page = report::write_report_html,
                                      .summary = report::write_summary_json,
                                      .log = log_of,
                                      .figures = figures_of,
                                      .scene_text = settings.scene_text,
                                      .last = verdict_of};
  if (const auto failed = publish(result, files, out, timer, progress, interrupts, settings.quiet)) return *failed;
  if (result.complex && result.motion && result.motion->interrupted) {
    say_interrupted(result.motion->stopped_why, out.final_name().generic_string());
    return ExitCode::interrupted;
  }
  if (result.complex && result.motion && !result.motion->converged) {
    print_error(fmt::format("{}:1: motion: {}; {}", settings.scene, result.motion->stopped_why,
                            result.motion->refused
                                ? "shift a joint by a little, another `seed`, or release fewer blocks"
                                : "the state reached is in the result; try a smaller motion.step"));
    return ExitCode::check_failed;
  }
  if (result.complex && result.motion && result.motion->rough_steps > 0) {
    print_error(
        fmt::format("{}:1: motion: {} of {} steps did not meet the contact law to 1e-5, the worst {:.2g}; the result "
                    "is whole, but rough; try a smaller motion.step",
                    settings.scene, result.motion->rough_steps, result.motion->steps, result.motion->residual));
    return ExitCode::check_failed;
  }
  if (result.complex) return ExitCode::done;
  print_error(
      fmt::format("{}:1: certificate: the block system did not pass its own check ({}); please report this scene",
                  settings.scene, topology::describe(result.complex.error())));
  return ExitCode::check_failed;
}

namespace {

ExitCode run_blocks(const RunArguments& arguments, const scene::Scene& scene, StageTimer& timer, Progress& progress,
                    InterruptWatch& interrupts) {
  scene::RunOptions options{.threads = arguments.threads, .memory_mb = arguments.memory_mb};
  auto moving = moving_run(scene, arguments.resume, arguments.out, interrupts);
  if (!moving) return report_problems(moving.error());
  options.motion = *std::move(moving);
  return in_out_folder(arguments.out, interrupts, [&](OutFolder& out) {
    auto result = scene::run(scene, options, timer, progress);
    if (!result) return report_problems(result.error());
    return write_and_publish(*result, out, timer, progress, interrupts,
                             {arguments.scene, arguments.quiet, arguments.scene_text});
  });
}

/// Whether runs of the scene leave a state that a later one goes on from.
bool has_states(const scene::AnyScene& scene) {
  if (const auto* blocks = std::get_if<scene::Scene>(&scene)) return blocks->motion && !blocks->monte_carlo;
  return std::holds_alternative<scene::ContactScene>(scene);
}

/// The bytes that were loaded; empty where the file is another one by now.
std::string text_of(const std::string& scene, const std::string& sha256) {
  auto text = scene::read_file(scene);
  return text && sha256_hex(*text) == sha256 ? *std::move(text) : std::string{};
}

}  // namespace

ExitCode run_scene(RunArguments arguments) {
  keep_freed_memory(arguments.threads);
  InterruptWatch interrupts;  // before any other thread
  StageTimer timer;
  Progress progress{progress_style_of_stderr(arguments.quiet)};
  progress.begin("read");
  auto scene = timer.run("read", [&] { return scene::load(arguments.scene); });
  progress.end();
  if (!scene) return report_problems(scene.error());
  arguments.scene_text = text_of(arguments.scene, std::visit([](const auto& loaded) { return loaded.sha256; }, *scene));
  if (arguments.scene_text.empty()) {
    print_error(fmt::format("{}:1: scene: has changed while it was read; run it again", arguments.scene));
    return ExitCode::wrong_input;
  }
  if (arguments.seed) std::visit([&](auto& loaded) { loaded.seed = *arguments.seed; }, *scene);
  if (!arguments.resume.empty() && !has_states(*scene)) {
    print_error(
        fmt::format("{}:1: --resume: the scene has no bodies in contact and no [motion]; run it without --resume (a "
                    "Monte Carlo run goes on by itself in its folder)",
                    arguments.scene));
    return ExitCode::wrong_input;
  }
  const scene::Plan plan = std::visit([](const auto& loaded) { return make_plan(loaded); }, *scene);
  if (plan.runs(scene::Step::monte_carlo)) {
    return run_monte_carlo_scene(std::get<scene::Scene>(*scene), arguments, timer, progress, interrupts);
  }
  if (arguments.sharded) {
    print_error(fmt::format("{}:1: --shard: the scene has no [monte_carlo]; run it without --shard", arguments.scene));
    return ExitCode::wrong_input;
  }
  return std::visit(
      overloaded{
          [&](const scene::Scene& of) { return run_blocks(arguments, of, timer, progress, interrupts); },
          [&](const scene::BodiesScene& of) { return run_bodies(arguments, of, timer, progress, interrupts); },
          [&](const scene::ContactScene& of) { return run_contact(arguments, of, timer, progress, interrupts); }},
      *scene);
}

}  // namespace cleave::cli
