#include "run_contact.hpp"

#include <fmt/format.h>

#include "cleave/report/contact.hpp"
#include "cleave/scene/run.hpp"
#include "out_folder.hpp"
#include "problems.hpp"

namespace cleave::cli {
namespace {

std::string log_of(const scene::ContactResult& result) {
  std::string text = fmt::format("{} ({})\n", result.title, result.scene_file);
  for (const scene::PlannedStage& stage : result.plan.stages) {
    text += fmt::format("  {:<12} {:<9} {}\n", name_of(stage.stage), stage.run ? "run" : "left out", stage.why);
  }
  for (const std::string& note : result.notes) text += "note: " + note + "\n";
  return text;
}

std::string figures_of(const scene::ContactResult& result) {
  std::string text = fmt::format("{} steps to {:.6g} s, largest displacement {:.6g} m, residual {:.1e}\n", result.steps,
                                 result.end_time, result.largest_displacement, result.residual);
  for (std::size_t p = 0; p < result.points.size() && !result.history.empty(); ++p) {
    const bem::Vec2 u = result.history.back().points[p];
    text += fmt::format("{}: displacement ({:.6g}, {:.6g}) m\n", result.points[p].name, u.x, u.y);
  }
  for (const std::string& note : result.notes) text += "note: " + note + "\n";
  return text;
}

}  // namespace

ExitCode run_contact(const RunArguments& arguments, const scene::ContactScene& scene, StageTimer& timer,
                     Progress& progress, InterruptWatch& interrupts) {
  auto out = OutFolder::prepare(arguments.out);
  if (!out) {
    complain(out.error().message);
    return out.error().code;
  }
  interrupts.on_interrupt([&] { out->discard(); });
  const ExitCode end = [&] {
    auto result = scene::run(scene, arguments.threads, timer, progress);
    if (!result) return report_problems(result.error());
    auto written = timer.run("write", [&] { return report::write_contact_files(*result, out->folder()); });
    result->cost = scene::cost_of(timer, arguments.threads);
    if (written && result->output.report) {
      written = timer.run("report", [&] { return report::write_contact_report(*result, out->folder()); });
      result->cost = scene::cost_of(timer, arguments.threads);
    }
    if (written) written = report::write_file(out->folder() / "log.txt", log_of(*result));
    if (written) written = report::write_contact_summary(*result, out->folder());
    if (!written) {
      complain(describe(written.error()));
      return ExitCode::machine_failed;
    }
    if (auto published = interrupts.guarded([&] { return out->publish(); }); !published) {
      complain(published.error().message);
      return published.error().code;
    }
    if (!arguments.quiet) say(figures_of(*result) + fmt::format("result in {}\n", out->final_name().generic_string()));
    if (result->converged) return ExitCode::done;
    complain(
        fmt::format("{}:1: contact: {}; the state reached is in the result", arguments.scene, result->stopped_why));
    return ExitCode::check_failed;
  }();
  interrupts.guarded([&] { out->discard(); });
  interrupts.on_interrupt({});
  return end;
}

}  // namespace cleave::cli
