#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "body_runs.hpp"
#include "cleave/dbem/world.hpp"
#include "cleave/scene/saved_run.hpp"
#include "cleave/scene2d/contact.hpp"
#include "contact_bodies.hpp"
#include "contact_estimate.hpp"
#include "contact_parts.hpp"
#include "contact_recorder.hpp"
#include "contact_state.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;

constexpr std::size_t most_rows = 2000;  // of the history
constexpr double rest_criterion = 1e-7;  // unbalanced force over weight
constexpr std::uint64_t most_rest_steps = 20000;
constexpr double strain_too_large = 0.1;  // for bodies whose shape is that of the start

/// Whether a run has taken all the work it may; it stops there.
bool out_of_work(const ContactSettings& settings, ContactResult& result) {
  if (result.work < settings.work) return false;
  result.converged = false;
  result.stopped_why = fmt::format("the run has taken the {:.6g} x 10^9 operations of contact.work at {:.6g} s",
                                   1e-9 * settings.work, result.end_time);
  return true;
}

/// A run on its way.
struct Running {
  const ContactScene& scene;
  dbem::World& world;
  Recorder& recorder;
  ContactPlace place;
  const std::function<bool()>& stop;
  Progress& progress;
  ContactResult& result;

  /// Keeps what a later run goes on from: before rows and frames that are written only because this one ends.
  void keep() const { result.state = state_of(scene, world, recorder.tally(), place, result); }
  [[nodiscard]] bool interrupted() const {
    if (!stop || !stop()) return false;
    result.converged = false;
    result.interrupted = true;
    result.stopped_why = fmt::format("interrupted at {:.6g} s", world.time());
    return true;
  }
  void step_done(const dbem::StepReport& report) {
    recorder.step(report);
    place.last_time = report.time;
    place.last_step = report.step;
    place.last_residual = report.residual;
    place.last_iterations = report.iterations;
  }
  [[nodiscard]] dbem::StepReport last() const {
    dbem::StepReport out;
    out.time = place.last_time;
    out.step = place.last_step;
    out.residual = place.last_residual;
    out.iterations = place.last_iterations;
    return out;
  }
};

/// One step of a run in time; false: it stopped there.
bool one_step(Running& run) {
  const ContactSettings& s = run.scene.settings;
  const double left = s.duration - run.world.time();
  // The last steps end the run on time; none of them is a sliver.
  const double next = run.place.next;
  auto report = run.world.step(left < next * (1 + 1e-9) ? left : left < 2 * next ? left / 2 : left);
  if (!report) {
    run.result.converged = false;
    run.result.stopped_why = describe(report.error());
    return false;
  }
  run.step_done(*report);
  if (report->cuts == 0 && report->shortened == 0) run.place.next = std::max(next, report->step);
  return true;
}

/// Steps of given lengths until the time is over.
void follow(Running& run) {
  const ContactSettings& s = run.scene.settings;
  ContactResult& result = run.result;
  const double expected = s.duration / s.step;
  const auto every = static_cast<std::uint64_t>(std::max(1.0, std::ceil(expected / most_rows)));
  const double picture = s.duration / static_cast<double>(s.frames);
  std::size_t pictures = 1;
  const auto skip_pictures = [&] {
    while (static_cast<double>(pictures) * picture * (1 - 1e-9) <= run.world.time()) ++pictures;
  };
  skip_pictures();
  constexpr std::uint64_t pieces = 1000;
  std::uint64_t done = 0;
  run.progress.begin("contact", pieces);
  while (run.world.time() < s.duration * (1 - 1e-12)) {
    if (run.interrupted() || !one_step(run)) break;
    const double time = run.world.time();
    const bool end = time >= s.duration * (1 - 1e-12);
    if (result.steps % every == 0 || end) run.recorder.row(run.last());
    if (time >= static_cast<double>(pictures) * picture * (1 - 1e-9) || end) {
      run.recorder.frame(time);
      skip_pictures();
    }
    const auto now = static_cast<std::uint64_t>(static_cast<double>(pieces) * std::min(1.0, time / s.duration));
    if (now > done) run.progress.advance(now - done);
    done = std::max(done, now);
    if (!end && out_of_work(s, result)) break;
  }
  run.keep();
  if (!result.converged) {
    // The state at which it stopped is shown.
    run.recorder.row(run.last());
    run.recorder.frame(run.world.time());
  }
}

/// Implicit steps, each from rest, until nothing gains speed.
void relax(Running& run) {
  const ContactSettings& s = run.scene.settings;
  ContactResult& result = run.result;
  run.progress.begin("contact");
  std::uint64_t next_picture = 1;
  while (next_picture <= result.steps) next_picture += 1 + next_picture / 4;
  double& unbalanced = run.place.unbalanced;
  while (unbalanced > rest_criterion && result.steps < most_rest_steps && run.world.time() < s.duration) {
    if (run.interrupted()) break;
    auto report = run.world.step();
    if (!report) {
      result.converged = false;
      result.stopped_why = describe(report.error());
      break;
    }
    run.step_done(*report);
    run.recorder.row(*report);
    unbalanced = report->unbalanced;
    if (result.steps == next_picture) {
      run.recorder.frame(run.world.time());
      next_picture += 1 + next_picture / 4;
    }
    run.progress.advance();
    if (unbalanced > rest_criterion && out_of_work(s, result)) break;
  }
  run.keep();
  run.recorder.frame(run.world.time());
  if (!result.converged || unbalanced <= rest_criterion) return;
  result.converged = false;
  result.stopped_why = fmt::format(
      "the bodies did not come to rest in {} steps: the largest unbalanced force is {:.2g} of the weight (asked: "
      "{:.0e}); there may be no equilibrium",
      result.steps, unbalanced, rest_criterion);
}

/// The start, or where an earlier run came to.
std::optional<Problem> begin(Running& run, const std::optional<SavedRun>& from) {
  if (!from) {
    run.recorder.row({});
    run.recorder.frame(0);
    return std::nullopt;
  }
  if (auto problem = go_on_from(*from, run.scene, run.world, run.recorder, run.place, run.result)) return problem;
  const double duration = run.scene.settings.duration;
  if (run.world.time() <= duration * (1 + 1e-12)) return std::nullopt;
  return too_far(*from, run.scene.shown, "contact.duration", duration, run.world.time());
}

/// Share of the energy of a swing that steps take in each of its periods. The force of a spring is that at the end of
/// the step, so that the mean rule leaves 1 / (1 + (w h)^2 / 2) of it in a step.
double taken_in_a_period(double period, double step) {
  const double turned = 2 * std::numbers::pi * step / period;
  return -std::expm1(-period / step * std::log1p(0.5 * turned * turned));
}
/// Of a joint that is pressed: while it closes the implicit rule counts, which leaves 1 / (1 + (w h)^2).
double taken_on_a_joint(double period, double step) {
  const double turned = 2 * std::numbers::pi * step / period, square = turned * turned;
  return -std::expm1(-0.5 * period / step * (std::log1p(0.5 * square) + std::log1p(square)));
}

/// Joints with stiffness: what shaking does to a body on its springs is too small by what the steps take.
void note_of_springs(const ContactScene& scene, const dbem::World& world, ContactResult& result) {
  constexpr double worth_saying = 0.01, steps_for_that = 3000;
  const auto swings = scene.settings.to_rest ? std::nullopt : world.spring_swings();
  if (!swings) return;
  const double step = std::max(scene.settings.step, scene.settings.max_step);
  const double shortest = swings->shortest.si(), longest = swings->longest.si();
  const double fast = taken_on_a_joint(shortest, step), slow = taken_on_a_joint(longest, step);
  if (fast <= worth_saying) return;
  result.notes.push_back(fmt::format(
      "bodies swing on joints with stiffness with periods of {:.2g} to {:.2g} s, and steps of {:.2g} s take {:.2g} to "
      "{:.2g} % of the energy of such a swing in each period: shaking near these periods moves them too little, and "
      "what it would lift may stand; with step = {:.1g} it is some 1 % of the slowest",
      shortest, longest, step, 100 * slow, 100 * fast, longest / steps_for_that));
}

/// What a run made of nothing.
void note_of_energy(const ContactScene& scene, const dbem::World& world, ContactResult& result) {
  constexpr double worth_saying = 1e-3, rounding = 1e-9;
  double most = 0, weight_by_size = 0;
  for (std::size_t b = 0; b < result.bodies.size(); ++b) {
    if (!result.bodies[b].fixed) weight_by_size += world.mass(b) * result.bodies[b].size.si();
  }
  weight_by_size *= norm(scene.settings.gravity);
  for (const ContactHistory& row : result.history) most = std::max(most, row.kinetic + row.elastic);
  // Where all is at rest, gaps of rounding size come and go.
  if (!(result.energy_gain > worth_saying * most + rounding * weight_by_size)) return;
  result.notes.push_back(
      fmt::format("the contacts brought in {:.2g} J/m that nothing had put in, where {:.2g} J/m at the most moved or "
                  "was stored: do "
                  "not rely on the verdict; use a shorter step",
                  result.energy_gain, most));
}

/// Steps that do not follow what swings on a bolt take away from what a sudden load does to it.
void note_of_swing(const ContactScene& scene, const dbem::World& world, ContactResult& result) {
  constexpr double steps_a_swing = 250;  // 1 % of the largest force
  const std::optional<BoltSwing> swing = scene.settings.to_rest ? std::nullopt : fastest_swing(scene, world);
  const double step = std::max(scene.settings.step, scene.settings.max_step);
  if (!swing || step * steps_a_swing <= swing->period) return;
  result.notes.push_back(fmt::format(
      "what bolt \"{}\" holds swings on it with a period of {:.2g} s: steps of {:.2g} s damp that, and a load "
      "that comes at once pulls with up to twice what it does at rest: {:.2g} % less here; use step = {:.1g} to see "
      "whether it breaks",
      swing->bolt, swing->period, step, 50 * (1 - std::sqrt(std::sqrt(1 - taken_in_a_period(swing->period, step)))),
      swing->period / 500));
}

/// What the end of a run shows that its verdict does not say.
void note_the_end(ContactResult& result) {
  if (std::string moving = note_of_going_on(result); !moving.empty()) result.notes.push_back(std::move(moving));
  for (const ContactBoltResult& bolt : result.bolts) {
    if (bolt.state != BoltState::broken || !bolt.broken_at) continue;
    result.notes.push_back(fmt::format("bolt \"{}\" broke between \"{}\" and \"{}\" at {:.3g} s: it held {:.4g} kN",
                                       bolt.name, bolt.first, bolt.second, bolt.broken_at->si(),
                                       bolt.capacity.si() / 1000));
  }
}

}  // namespace

std::vector<Vec2> corners_at(const ContactResult& result, std::size_t frame, std::size_t body) {
  const ContactFrame& now = result.frames[frame];
  if (!now.corners[body].empty()) return now.corners[body];
  std::vector<Vec2> out = result.bodies[body].outline;
  for (Vec2& p : out) {
    p = now.places[body].centroid + rotated(p - result.bodies[body].start, now.places[body].rotation);
  }
  return out;
}

std::expected<ContactResult, std::vector<Problem>> run(const ContactScene& scene, unsigned threads, StageTimer& timer,
                                                       Progress& progress, const ContactRun& how) {
  ContactResult result;
  static_cast<ResultHead&>(result) = head_of(scene, make_plan(scene));
  const RigidityChoice rigidity = rigidity_of(scene);
  result.elastic = rigidity.elastic;
  result.to_rest = scene.settings.to_rest;
  if (rigidity.elastic && rigidity.strain && *rigidity.strain > strain_too_large) {
    result.notes.push_back(
        fmt::format("strains may reach {:.1g}, but elastic bodies are computed for small ones: is young in Pa and "
                    "density in kg/m3?",
                    *rigidity.strain));
  }
  progress.begin("contact");
  auto wrong = timer.run("contact", [&]() -> std::optional<std::vector<Problem>> {
    auto prepared = prepare_bodies(scene, result.elastic, threads);
    if (!prepared) return prepared.error();
    const ContactSettings& s = scene.settings;
    dbem::WorldOptions options;
    options.gravity = s.gravity;
    if (s.ground) {
      options.ground = [&ground = *s.ground](double t) { return ground.at(t); };
      options.ground_mean = [&ground = *s.ground](double from, double to) { return ground.mean(from, to); };
    }
    options.mass_damping = s.mass_damping.si();
    options.step = s.step;
    options.longest_step = s.max_step;
    options.displacement = s.largest_move;
    options.overlap_at_start = 2e-5;                     // the scene's own check is stricter
    options.overlap_elastic = options.overlap_at_start;  // bodies that bend are parted as if rigid
    options.quasi_static = s.to_rest;
    options.adaptive = s.to_rest || s.max_step > s.step;
    options.solver.method = s.solver;
    auto world = dbem::World::make(prepared->bodies, laws_of(scene), options, ties_of(scene));
    if (!world) {
      return std::vector{Problem{scene.shown, 1, "contact", describe(world.error()), "change the bodies it names"}};
    }
    result.operators = prepared->operators;
    note_of_swing(scene, *world, result);
    note_of_springs(scene, *world, result);
    Recorder recorder{scene, *prepared, *world, result};
    Running running{.scene = scene,
                    .world = *world,
                    .recorder = recorder,
                    .place = {.step = s.step, .next = s.step},
                    .stop = how.stop,
                    .progress = progress,
                    .result = result};
    if (auto problem = begin(running, how.from)) return std::vector{*std::move(problem)};
    if (s.to_rest) {
      relax(running);
    } else {
      follow(running);
    }
    recorder.finish();
    note_the_end(result);
    note_of_energy(scene, *world, result);
    const auto with = [&](double longer) -> std::optional<dbem::World> {
      dbem::WorldOptions long_steps = options;
      for (double* bound : {&long_steps.step, &long_steps.displacement, &long_steps.rotation}) *bound *= longer;
      if (long_steps.longest_step) *long_steps.longest_step *= longer;
      auto other = dbem::World::make(prepared->bodies, laws_of(scene), long_steps, ties_of(scene));
      return other ? std::optional{*std::move(other)} : std::nullopt;
    };
    if (!estimate_steps(scene, with, *world, recorder.something_hit(), how.stop, result)) (void)running.interrupted();
    return std::nullopt;
  });
  progress.end();
  if (wrong) return std::unexpected(*std::move(wrong));
  result.cost = cost_of(timer, threads);
  return result;
}

}  // namespace cleave::scene
