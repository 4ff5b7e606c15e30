#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <utility>

#include "allocation.hpp"
#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/report/write.hpp"
#include "cleave/scene/parse.hpp"
#include "cleave/scene/run.hpp"
#include "command_monte_carlo.hpp"
#include "commands.hpp"
#include "figures.hpp"
#include "interrupt.hpp"
#include "out_folder.hpp"
#include "problems.hpp"
#include "run_bodies.hpp"
#include "run_contact.hpp"
#include "write_result.hpp"

namespace cleave::cli {
namespace {

using Written = std::expected<void, report::WriteError>;

/// All files of a result; summary.json last, so that it holds what the others cost.
Written write_result(scene::RunResult& result, const std::filesystem::path& folder, StageTimer& timer,
                     Progress& progress) {
  const auto stage = [&](scene::Stage which, auto&& work) -> Written {
    progress.begin(name_of(which));
    auto done = timer.run(name_of(which), work);
    result.cost = scene::cost_of(timer, result.cost.threads);
    return done;
  };
  auto written = stage(scene::Stage::write, [&]() -> Written {
    if (auto vtu = report::write_blocks_vtu(result, folder); !vtu) return vtu;
    if (auto dangling = report::write_dangling(result, folder); !dangling) return dangling;
    auto notes = report::write_exports(result, folder);
    if (!notes) return std::unexpected(std::move(notes).error());
    for (std::string& note : *notes) result.notes.push_back(std::move(note));
    auto more = report::write_sections(result, folder);
    if (!more) return std::unexpected(std::move(more).error());
    for (std::string& note : *more) result.notes.push_back(std::move(note));
    return report::write_key_blocks_csv(result, folder);
  });
  if (written && result.plan.runs(scene::Stage::report)) {
    written = stage(scene::Stage::report, [&] { return report::write_report_html(result, folder); });
  }
  progress.end();
  if (written) written = report::write_file(folder / "log.txt", log_of(result));
  if (written) written = report::write_summary_json(result, folder);
  return written;
}

}  // namespace

ExitCode write_and_publish(scene::RunResult& result, OutFolder& out, StageTimer& timer, Progress& progress,
                           InterruptWatch& interrupts, const Saying& saying) {
  if (auto written = write_result(result, out.folder(), timer, progress); !written) {
    complain(describe(written.error()));
    return ExitCode::machine_failed;
  }
  if (auto published = interrupts.guarded([&] { return out.publish(); }); !published) {
    complain(published.error().message);
    return published.error().code;
  }
  if (!saying.quiet) {
    std::string text = figures_of(result);
    for (const std::string& note : result.notes) text += "note: " + note + "\n";
    say(text + fmt::format("result in {}\n", out.final_name().generic_string()));
  }
  if (result.complex) return ExitCode::done;
  complain(fmt::format("{}:1: certificate: the block system did not pass its own check ({}); please report this scene",
                       saying.scene, topology::describe(result.complex.error())));
  return ExitCode::check_failed;
}

ExitCode run_scene(const RunArguments& arguments) {
  keep_freed_memory(arguments.threads);
  InterruptWatch interrupts;  // before any other thread
  StageTimer timer;
  Progress progress{progress_style_of_stderr(arguments.quiet)};

  progress.begin("read");
  // Bodies, bodies in contact and blocks are different scenes; the first look says which.
  auto contact = std::optional<std::expected<scene::ContactScene, std::vector<scene::Problem>>>{};
  auto bodies = std::optional<std::expected<scene::BodiesScene, std::vector<scene::Problem>>>{};
  auto scene = timer.run("read", [&] {
    bodies = scene::load_bodies(arguments.scene);
    if (!bodies) contact = scene::load_contact(arguments.scene);
    if (bodies || contact) return std::expected<scene::Scene, std::vector<scene::Problem>>{std::unexpect};
    return scene::load(arguments.scene);
  });
  progress.end();
  if (bodies) {
    if (!*bodies) return report_problems(bodies->error());
    if (arguments.sharded) {
      complain(fmt::format("{}:1: --shard: the scene has no [monte_carlo]; run it without --shard", arguments.scene));
      return ExitCode::wrong_input;
    }
    if (arguments.seed) (*bodies)->seed = *arguments.seed;
    return run_bodies(arguments, **bodies, timer, progress, interrupts);
  }
  if (contact) {
    if (!*contact) return report_problems(contact->error());
    if (arguments.sharded) {
      complain(fmt::format("{}:1: --shard: the scene has no [monte_carlo]; run it without --shard", arguments.scene));
      return ExitCode::wrong_input;
    }
    if (arguments.seed) (*contact)->seed = *arguments.seed;
    return run_contact(arguments, **contact, timer, progress, interrupts);
  }
  if (!scene) return report_problems(scene.error());
  if (arguments.seed) scene->seed = *arguments.seed;
  if (scene->monte_carlo) return run_monte_carlo_scene(*scene, arguments, timer, progress, interrupts);
  if (arguments.sharded) {
    complain(fmt::format("{}:1: --shard: the scene has no [monte_carlo]; run it without --shard", arguments.scene));
    return ExitCode::wrong_input;
  }

  auto out = OutFolder::prepare(arguments.out);
  if (!out) {
    complain(out.error().message);
    return out.error().code;
  }
  interrupts.on_interrupt([&] { out->discard(); });
  const ExitCode end = [&] {
    auto result = scene::run(*scene, {.threads = arguments.threads}, timer, progress);
    if (!result) return report_problems(result.error());
    return write_and_publish(*result, *out, timer, progress, interrupts, {arguments.scene, arguments.quiet});
  }();
  interrupts.guarded([&] { out->discard(); });
  interrupts.on_interrupt({});
  return end;
}

}  // namespace cleave::cli
