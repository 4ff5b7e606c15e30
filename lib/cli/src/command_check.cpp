#include <fmt/format.h>

#include "cleave/scene/bodies.hpp"
#include "cleave/scene/contact.hpp"
#include "cleave/scene/parse.hpp"
#include "cleave/scene/plan.hpp"
#include "commands.hpp"
#include "problems.hpp"

namespace cleave::cli {

ExitCode report_problems(const std::vector<scene::Problem>& problems) {
  for (const scene::Problem& problem : problems) complain(describe(problem));
  return ExitCode::wrong_input;
}

namespace {

std::string notes_of(const std::vector<scene::Problem>& notes) {
  std::string text;
  for (const scene::Problem& note : notes) text += "note: " + describe(note) + "\n";
  return text;
}

}  // namespace

ExitCode check_scene(const std::string& path) {
  if (const auto bodies = scene::load_bodies(path)) {
    if (!*bodies) return report_problems(bodies->error());
    say(notes_of((*bodies)->notes) + fmt::format("{}: no error found\n", path));
    return ExitCode::done;
  }
  if (const auto contact = scene::load_contact(path)) {
    if (!*contact) return report_problems(contact->error());
    say(notes_of((*contact)->notes) + fmt::format("{}: no error found\n", path));
    return ExitCode::done;
  }
  const auto scene = scene::load(path);
  if (!scene) return report_problems(scene.error());
  for (const scene::Problem& note : scene->notes) say("note: " + describe(note) + "\n");
  say(fmt::format("{}: no error found\n", path));
  return ExitCode::done;
}

ExitCode plan_scene(const std::string& path) {
  const auto say_plan = [&](const auto& plane) {
    const scene::Plan plan = make_plan(plane);
    say(fmt::format("plan of {} ({})\n", path, plane.title) + describe(plan, true) +
        fmt::format("estimated size: {} bodies, up to {:.0f} MB and {:.1f} s of CPU\n", plane.bodies.size(),
                    plan.estimate.memory_mb, plan.estimate.seconds) +
        notes_of(plane.notes));
    return ExitCode::done;
  };
  if (const auto bodies = scene::load_bodies(path)) {
    return *bodies ? say_plan(**bodies) : report_problems(bodies->error());
  }
  if (const auto contact = scene::load_contact(path)) {
    return *contact ? say_plan(**contact) : report_problems(contact->error());
  }
  const auto scene = scene::load(path);
  if (!scene) return report_problems(scene.error());
  const scene::Plan plan = make_plan(*scene);
  std::string text = fmt::format("plan of {} ({})\n", path, scene->title);
  text += describe(plan, true);
  const scene::SizeEstimate& size = plan.estimate;
  text += fmt::format("estimated size: {:.0f} joints, {:.0f} to {:.2g} blocks, up to {:.0f} MB and {:.1f} s of CPU\n",
                      size.joints, size.blocks_low, size.blocks_high, size.memory_mb, size.seconds);
  for (const scene::Problem& note : scene->notes) text += "note: " + describe(note) + "\n";
  say(text);
  return ExitCode::done;
}

}  // namespace cleave::cli
