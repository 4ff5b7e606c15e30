#include <fmt/format.h>

#include <expected>
#include <vector>

#include "cleave/core/overloaded.hpp"
#include "cleave/load/load.hpp"
#include "cleave/realize/run.hpp"
#include "commands.hpp"
#include "memory_limit.hpp"
#include "problems.hpp"

namespace cleave::cli {

ExitCode report_problems(const std::vector<scene::Problem>& problems) {
  for (const scene::Problem& problem : problems) print_error(describe(problem));
  return ExitCode::wrong_input;
}

namespace {

std::string notes_of(const auto& scene) {
  std::string text;
  for (const scene::Problem& note : scene.notes) text += "note: " + describe(note) + "\n";
  return text;
}

std::string size_of(const scene::Scene&, const scene::SizeEstimate& size) {
  return fmt::format("{:.0f} joints, {:.0f} to {:.2g} blocks", size.joints, size.blocks_low, size.blocks_high);
}
std::string size_of(const auto& scene2d, const scene::SizeEstimate&) {
  return fmt::format("{} bodies", scene2d.bodies.size());
}

}  // namespace

ExitCode check_scene(const std::string& path) {
  const auto scene = scene::load(path);
  if (!scene) return report_problems(scene.error());
  if (const auto* blocks = std::get_if<scene::Scene>(&*scene)) {
    // As of a run that is not told what it may take.
    const auto refused = refusals(*blocks, {.memory_mb = machine_memory_mb()});
    if (!refused.empty()) return report_problems(refused);
  }
  const std::string notes = std::visit([](const auto& loaded) { return notes_of(loaded); }, *scene);
  print(notes + fmt::format("{}: no error found\n", path));
  return ExitCode::done;
}

ExitCode plan_scene(const std::string& path) {
  const auto scene = scene::load(path);
  if (!scene) return report_problems(scene.error());
  using Planned = std::expected<scene::Plan, std::vector<scene::Problem>>;
  const Planned plan = std::visit(overloaded{[](const scene::Scene& blocks) { return make_costed_plan(blocks); },
                                             [](const auto& scene2d) -> Planned { return make_plan(scene2d); }},
                                  *scene);
  if (!plan) return report_problems(plan.error());
  if (const auto* blocks = std::get_if<scene::Scene>(&*scene)) {
    // What no run could do; a scene that is too large for this machine has a plan.
    const auto refused = refusals(*blocks, {.memory_mb = machine_memory_mb()}, scene::TooLarge::passed_over);
    if (!refused.empty()) return report_problems(refused);
  }
  print(std::visit(
      [&](const auto& loaded) {
        const scene::SizeEstimate& size = plan->estimate;
        return fmt::format(
                   "plan of {} ({})\n{}estimated size: {}, about {:.0f} MB and {:.2g} s of CPU{}{}\n", path,
                   loaded.title, describe(*plan, true), size_of(loaded, size), size.memory_mb, size.seconds,
                   size.together.si() > 0.1
                       ? fmt::format(", and about {:.2g} s more for blocks judged together", size.together.si()) +
                             (size.most_together > 0
                                  ? fmt::format(" (none where over {:.0f} are near free faces)", size.most_together)
                                  : "")
                       : "",
                   plan->runs(scene::Step::contact) && size.blocks_high > 0 ? "; motion is not in it" : "") +
               notes_of(loaded);
      },
      *scene));
  return ExitCode::done;
}

}  // namespace cleave::cli
