#include "run_contact.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "cleave/report/contact.hpp"
#include "saved_runs.hpp"
#include "say.hpp"
#include "scene2d_run.hpp"

namespace cleave::cli {
namespace {

/// "  2 bolts act, 1 broke: "anchor"".
std::string bolts_of(const scene::ContactResult& result) {
  std::size_t broke = 0;
  std::string names;
  for (const scene::ContactBoltResult& bolt : result.bolts) {
    if (bolt.state != scene::BoltState::broken) continue;
    if (broke < 3) names += (broke == 0 ? ": \"" : ", \"") + bolt.name + "\"";
    ++broke;
  }
  if (broke > 3) names += ", ...";
  return fmt::format("  bolts at {} {}, {} broke{}\n", result.bolts.size(),
                     result.bolts.size() == 1 ? "joint" : "joints", broke, names);
}

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
  if (!result.bolts.empty()) text += bolts_of(result);
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
  auto from = find_state(
      arguments.resume, arguments.out,
      {.file = scene::contact_state_name, .section = "contact", .sha256 = scene.sha256, .title = scene.title});
  if (!from) return report_problems(from.error());
  interrupts.ask_first(std::string{stops_after_this_step});
  const scene::ContactRun how{.from = *std::move(from), .stop = [&] { return interrupts.asked(); }};
  return run_scene2d<Result>(
      arguments, timer, progress, interrupts,
      {.run = [&] { return scene::run(scene, arguments.threads, timer, progress, how); },
       .files = {.write = report::write_contact_files,
                 .page = report::write_contact_report,
                 .summary = report::write_contact_summary,
                 .log = {},
                 .figures = figures_of},
       .complaint =
           [&](const Result& result) {
             return "contact: " + result.stopped_why + "; the state reached is in the result" +
                    (scene.settings.solver == dbem::Method::cascade ? "" : "; try solver = \"cascade\"");
           },
       .stopped = [&](const Result& result) -> std::optional<ExitCode> {
         if (!result.interrupted) return std::nullopt;
         say_interrupted(result.stopped_why, arguments.out);
         return ExitCode::interrupted;
       }});
}

}  // namespace cleave::cli
