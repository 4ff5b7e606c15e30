#include <algorithm>
#include <cmath>

#include "cleave/core/cost.hpp"
#include "engines.hpp"
#include "shapes.hpp"

#include <chrono>

namespace cleave::study::engines {

using motion::shapes::box;
using motion::shapes::moved;

MassOf mass_of(const Body& body) {
  const motion::MassProperties m = motion::mass_properties(body.shape).value();
  const motion::Symmetric& j = m.inertia;
  const double d = body.density;
  return {.mass = d * m.volume,
          .inertia = {.xx = d * j.xx, .yy = d * j.yy, .zz = d * j.zz, .xy = d * j.xy, .yz = d * j.yz, .zx = d * j.zx}};
}

Outcome follow(const std::vector<double>& times, double step, const std::function<bool()>& advance,
               const std::function<std::vector<Pose>()>& poses) {
  Outcome out;
  long taken = 0;
  for (const double time : times) {
    const long wanted = std::lround(time / step);
    const auto start = std::chrono::steady_clock::now();
    const double cpu = cpu_seconds();
    bool good = true;
    for (; good && taken < wanted; ++taken) good = advance();
    out.cpu_s += cpu_seconds() - cpu;
    out.wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!good) {
      out.stopped = "gave up";
      return out;
    }
    out.frames.push_back(poses());
  }
  return out;
}

namespace {

/// `scene`: residuals that scenes accept and tolerate. `free`: no bound on what a body turns or moves in a step.
motion::WorldOptions options_of(const Scene& scene, const Setting& setting) {
  motion::WorldOptions out{.gravity = scene.gravity, .step = setting.step, .sleep = false};
  if (setting.way.contains("scene")) {
    out.solver.accept = 1e-5;
    out.solver.tolerate = 1e-3;
  }
  if (setting.way.contains("implicit")) out.theta = 1;
  if (setting.way.contains("free")) out.rotation = out.displacement = 10;
  return out;
}

class Cleave final : public Engine {
 public:
  [[nodiscard]] std::string name() const override { return "cleave"; }
  [[nodiscard]] bool present() const override { return true; }
  [[nodiscard]] Outcome run(const Scene& scene, const Setting& setting, const std::vector<double>& times) override {
    motion::SceneSpec spec{.bodies = {}, .surfaces = {}};
    const auto surface = [&](motion::Polyhedron shape, double friction) {
      for (motion::Facet& f : shape.facets) f.surface = static_cast<std::uint32_t>(spec.surfaces.size());
      spec.surfaces.push_back({friction, scene.restitution});
      return shape;
    };
    for (const Body& b : scene.bodies) {
      spec.bodies.push_back({.shape = surface(moved(b.shape, b.at, b.turn), b.friction),
                             .density = kilograms_per_cubic_metre(b.density),
                             .velocity = b.velocity,
                             .spin = b.spin});
    }
    for (const Floor& f : scene.floors) {
      spec.bodies.push_back(
          {.shape = surface(moved(box({-100, -100, -1}, {100, 100, 0}), {}, f.turn), f.friction), .fixed = true});
    }
    const std::size_t count = scene.bodies.size();
    auto world = motion::World::make(std::move(spec), options_of(scene, setting));
    if (!world) return {.frames = {}, .stopped = describe(world.error())};
    std::string why;
    double until = 0;
    Outcome out = follow(
        times, setting.step,
        [&] {
          until += setting.step;
          while (world->time() < until - 1e-9 * setting.step) {
            if (const auto report = world->step(until - world->time()); !report) {
              why = describe(report.error());
              return false;
            }
          }
          return true;
        },
        [&] {
          std::vector<Pose> poses;
          for (std::size_t b = 0; b < count; ++b) {
            const Body& body = scene.bodies[b];
            poses.push_back({.at = body.at + world->displacement(b),
                             .turn = world->turn(b) * body.turn,
                             .velocity = world->velocity(b),
                             .spin = world->spin(b)});
          }
          return poses;
        });
    std::ranges::replace(why, ',', ';');
    if (!out.stopped.empty()) out.stopped = why;
    Vec3 on_floors;
    for (const motion::Contact& c : world->contacts()) {
      if (c.other >= count) on_floors += c.force;
      if (c.body >= count) on_floors -= c.force;
    }
    const double g = norm(scene.gravity);
    if (g > 0) out.reaction = -dot(on_floors, scene.gravity) / g;
    return out;
  }
};

}  // namespace

Engine& cleave_engine() {
  static Cleave engine;
  return engine;
}

}  // namespace cleave::study::engines
