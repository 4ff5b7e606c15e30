#include "run_bodies.hpp"

#include <fmt/format.h>

#include "cleave/report/bodies.hpp"
#include "say.hpp"
#include "scene2d_run.hpp"

namespace cleave::cli {
namespace {

std::string figures_of(const scene::BodiesResult& result) {
  std::string text;
  for (const scene::BodyResult& body : result.bodies) {
    text += say(body.error ? "{name}: {elements} elements, largest displacement {max_displacement_m:.6g} m, estimated "
                             "error {estimated_error:.1e}\n"
                           : "{name}: {elements} elements, largest displacement {max_displacement_m:.6g} m\n",
                group([&](auto& v) { scene::body_fields(result.steps)(v, body); }));
  }
  for (const scene::PointResult& point : result.points) {
    const bem::Vec2 u = point.displacement.empty() ? bem::Vec2{} : point.displacement.back();
    text += fmt::format("{}: displacement ({:.6g}, {:.6g}) m\n", point.name, u.x, u.y);
  }
  return text;
}

}  // namespace

ExitCode run_bodies(const RunArguments& arguments, const scene::BodiesScene& scene, StageTimer& timer,
                    Progress& progress, InterruptWatch& interrupts) {
  using Result = scene::BodiesResult;
  return run_scene2d<Result>(arguments, timer, progress, interrupts,
                             {.run = [&] { return scene::run(scene, arguments.threads, timer, progress); },
                              .files = {.write = report::write_bodies_files,
                                        .page = report::write_bodies_report,
                                        .summary = report::write_bodies_summary,
                                        .log = {},
                                        .figures = figures_of},
                              .complaint = [](const Result& result) { return "elastic: " + result.stopped_why; }});
}

}  // namespace cleave::cli
