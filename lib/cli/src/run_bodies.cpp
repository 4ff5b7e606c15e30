#include <fmt/format.h>

#include <filesystem>

#include "cleave/report/bodies.hpp"
#include "cleave/scene/run.hpp"
#include "commands.hpp"
#include "interrupt.hpp"
#include "out_folder.hpp"
#include "problems.hpp"
#include "run_bodies.hpp"

namespace cleave::cli {
namespace {

std::string log_of(const scene::BodiesResult& result) {
  std::string text = fmt::format("{} ({})\n", result.title, result.scene_file);
  for (const scene::PlannedStage& stage : result.plan.stages) {
    text += fmt::format("  {:<12} {:<9} {}\n", name_of(stage.stage), stage.run ? "run" : "left out", stage.why);
  }
  for (const std::string& note : result.notes) text += "note: " + note + "\n";
  return text;
}

}  // namespace

ExitCode run_bodies(const RunArguments& arguments, const scene::BodiesScene& scene, StageTimer& timer,
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
    auto written = timer.run("write", [&] { return report::write_bodies_files(*result, out->folder()); });
    result->cost = scene::cost_of(timer, arguments.threads);
    if (written && result->output.report) {
      written = timer.run("report", [&] { return report::write_bodies_report(*result, out->folder()); });
      result->cost = scene::cost_of(timer, arguments.threads);
    }
    if (written) written = report::write_file(out->folder() / "log.txt", log_of(*result));
    if (written) written = report::write_bodies_summary(*result, out->folder());
    if (!written) {
      complain(describe(written.error()));
      return ExitCode::machine_failed;
    }
    if (auto published = interrupts.guarded([&] { return out->publish(); }); !published) {
      complain(published.error().message);
      return published.error().code;
    }
    if (!arguments.quiet) {
      std::string text;
      for (const scene::BodyResult& body : result->bodies) {
        text += fmt::format("{}: {} elements, largest displacement {:.6g} m", body.name, body.elements, body.largest);
        if (body.error) text += fmt::format(", estimated error {:.1e}", *body.error);
        text += "\n";
      }
      for (const scene::PointResult& point : result->points) {
        const bem::Vec2 u = point.displacement.empty() ? bem::Vec2{} : point.displacement.back();
        text += fmt::format("{}: displacement ({:.6g}, {:.6g}) m\n", point.name, u.x, u.y);
      }
      for (const std::string& note : result->notes) text += "note: " + note + "\n";
      say(text + fmt::format("result in {}\n", out->final_name().generic_string()));
    }
    if (result->converged) return ExitCode::done;
    complain(fmt::format("{}:1: elastic: {}", arguments.scene, result->stopped_why));
    return ExitCode::check_failed;
  }();
  interrupts.guarded([&] { out->discard(); });
  interrupts.on_interrupt({});
  return end;
}

}  // namespace cleave::cli
