#include "run_contact.hpp"

#include <fmt/format.h>

#include "cleave/report/contact.hpp"
#include "say.hpp"
#include "scene2d_run.hpp"

namespace cleave::cli {
namespace {

std::string figures_of(const scene::ContactResult& result) {
  const std::string end = !result.to_rest    ? fmt::format("to {:.6g} s", result.end_time)
                          : result.converged ? "to rest"
                                             : "without rest";
  const auto figures = group([&](auto& v) { scene::scene2d_fields(v, result); });
  const scene::ContactVerdict verdict = scene::verdict_of(result);
  std::string text = say("{steps} steps ", figures) + end +
                     say(", largest displacement {max_displacement_m:.6g} m, residual {residual:.1e}\n"
                         "verdict: {verdict}",
                         figures);
  if (verdict.since) {
    text += say(", first \"{moved_first}\", seen at {moved_since_s:.3g} s; in all ", figures) + counts_of(verdict);
  }
  text += '\n';
  text += result.error ? fmt::format("estimated error of the steps {:.1e}\n", *result.error)
                       : fmt::format("no estimate of the error of the steps: {}\n", result.no_estimate);
  for (std::size_t p = 0; p < result.points.size() && !result.history.empty(); ++p) {
    const bem::Vec2 u = result.history.back().points[p];
    text += fmt::format("{}: displacement ({:.6g}, {:.6g}) m\n", result.points[p].name, u.x, u.y);
  }
  return text;
}

}  // namespace

ExitCode run_contact(const RunArguments& arguments, const scene::ContactScene& scene, StageTimer& timer,
                     Progress& progress, InterruptWatch& interrupts) {
  using Result = scene::ContactResult;
  return run_scene2d<Result>(
      arguments, timer, progress, interrupts,
      {.run = [&] { return scene::run(scene, arguments.threads, timer, progress); },
       .files = {.write = report::write_contact_files,
                 .page = report::write_contact_report,
                 .summary = report::write_contact_summary,
                 .log = {},
                 .figures = figures_of},
       .complaint =
           [&](const Result& result) {
             return "contact: " + result.stopped_why + "; the state reached is in the result" +
                    (scene.settings.solver == dbem::Method::cascade ? "" : "; try solver = \"cascade\"");
           }});
}

}  // namespace cleave::cli
