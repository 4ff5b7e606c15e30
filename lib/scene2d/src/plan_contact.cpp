#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cleave/scene/plan_steps.hpp"
#include "cleave/scene2d/contact.hpp"
#include "contact_bodies.hpp"
#include "contact_parts.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;

/// Below this estimate of the strain a run follows rigid blocks unless the scene says otherwise.
constexpr double strain_that_matters = 1e-4;

double extent(const ContactScene& scene) {
  Box2 box;
  for (const ContactBody& body : scene.bodies) {
    if (body.fixed) continue;
    for (const Vec2 p : body.corners) box.add(p);
  }
  return std::max({box.high.x - box.low.x, box.high.y - box.low.y, 0.0});
}

/// From its first corner to the farthest.
double across(const ContactBody& body) {
  double longest = 0;
  for (const Vec2 p : body.corners) longest = std::max(longest, norm(p - body.corners.front()));
  return longest;
}

/// Largest strain that weight, loads and impacts can be expected to make: stress of the overburden, of the loads, of a
/// wave of the speed at the start and of the spin, over the modulus.
std::optional<double> strain_of(const ContactScene& scene) {
  const double size = extent(scene);
  std::optional<double> most;
  for (const ContactBody& body : scene.bodies) {
    if (body.fixed || !body.young) continue;
    double stress = body.density * norm(scene.settings.gravity) * size;
    for (const ContactLoad& load : body.loads) {
      stress += load.side ? std::abs(load.pressure) + norm(load.traction) : norm(load.force) / across(body);
    }
    stress += std::sqrt(body.density * *body.young) * norm(body.velocity);
    stress += 0.125 * body.density * std::pow(body.spin * across(body), 2);
    most = std::max(most, std::optional{stress / *body.young});
  }
  return most;
}

/// What bodies that deform add to a run.
struct Deforming {
  std::size_t shapes = 0;
  double elements = 0;  ///< of one body of each shape
  double modes = 0;     ///< of all bodies
  double memory_mb = 0, seconds = 0;
};

Deforming deforming_of(const ContactScene& scene) {
  Deforming out;
  // Two nodes an element, two freedoms a node; inner motions.
  constexpr double inner = 12;
  const auto freedoms_of = [&](const ContactBody& body) { return 4 * elements_of(scene.settings, body) + inner; };
  const auto modes_of = [&](double freedoms) {
    return scene.settings.modes ? std::min(static_cast<double>(*scene.settings.modes), freedoms) : freedoms;
  };
  for (const std::size_t shape : shapes_of(scene)) {
    const double freedoms = freedoms_of(scene.bodies[shape]);
    ++out.shapes;
    out.elements += elements_of(scene.settings, scene.bodies[shape]);
    // Measured: 60, 150 and 300 elements.
    out.memory_mb += 3.8e-4 * freedoms * freedoms + 1.4e-6 * freedoms * freedoms * freedoms;
    out.seconds += 4e-8 * freedoms * freedoms * freedoms;
  }
  for (const ContactBody& body : scene.bodies) {
    if (body.fixed) continue;
    const double freedoms = freedoms_of(body), modes = modes_of(freedoms);
    out.modes += modes;
    out.memory_mb += 0.01 + 8e-6 * freedoms * modes;
  }
  return out;
}

}  // namespace

RigidityChoice rigidity_of(const ContactScene& scene) {
  const std::optional<double> strain = strain_of(scene);
  switch (scene.settings.rigidity) {
    case Rigidity::rigid: return {false, "rigid blocks: rigid = true", strain};
    case Rigidity::elastic: return {true, "elastic blocks: rigid = false", strain};
    case Rigidity::automatic: break;
  }
  if (std::ranges::any_of(scene.bodies, &ContactBody::clamped)) {
    return {true, "elastic blocks: a body is clamped, so it moves only by deforming", strain};
  }
  const auto bare =
      std::ranges::find_if(scene.bodies, [](const ContactBody& b) { return !b.fixed && !(b.young && b.poisson); });
  if (bare != scene.bodies.end()) {
    return {false, "rigid blocks: no Young's modulus and Poisson's ratio for \"" + bare->name + "\"", strain};
  }
  if (scene.settings.in_situ) return {true, "elastic blocks: stress is locked in them", strain};
  const double most = strain.value_or(0);
  if (most < strain_that_matters) {
    return {false, fmt::format("rigid blocks: strains of about {:.1e} stay below {:.0e}", most, strain_that_matters),
            strain};
  }
  return {true, fmt::format("elastic blocks: strains of about {:.1e} reach {:.0e}", most, strain_that_matters), strain};
}

Plan make_plan(const ContactScene& scene) {
  const ContactSettings& s = scene.settings;
  const RigidityChoice rigidity = rigidity_of(scene);
  const auto moving =
      static_cast<std::size_t>(std::ranges::count_if(scene.bodies, [](const ContactBody& b) { return !b.fixed; }));
  std::string why =
      fmt::format("{} {} ({} fixed); {}", scene.bodies.size(), scene.bodies.size() == 1 ? "body" : "bodies",
                  scene.bodies.size() - moving, rigidity.why);
  if (s.to_rest) {
    why += "; to rest by relaxation: the way there means nothing";
  } else {
    why += fmt::format("; {:.6g} s in steps of {:.3g} s", s.duration, s.step);
    if (s.max_step > s.step) why += fmt::format(" and up to {:.3g} s", s.max_step);
  }
  why += fmt::format("; solver {}", dbem::name_of(s.solver));
  const Deforming deforming = rigidity.elastic ? deforming_of(scene) : Deforming{};
  why += rigidity.elastic ? fmt::format("; {:.6g} boundary elements in {} {}", deforming.elements, deforming.shapes,
                                        deforming.shapes == 1 ? "shape" : "shapes")
                          : "; no boundary elements, no vibrations";
  const bool bonded =
      std::ranges::any_of(scene.joints, [](const ContactJoint& j) { return j.cohesion > 0 || j.tension > 0; });
  if (!bonded) why += "; no bonds: no joint has cohesion or tension";
  if (std::ranges::all_of(scene.joints, [](const ContactJoint& j) { return j.friction == 0 && j.cohesion == 0; })) {
    why += "; no friction";
  }
  if (s.gravity == Vec2{}) why += "; no weight";
  if (s.ground) why += "; the ground moves";
  const auto driven = std::ranges::count_if(scene.bodies, [](const ContactBody& b) { return b.motion.has_value(); });
  if (driven > 0) why += fmt::format("; {} of the fixed move", driven);
  if (!scene.bolts.empty())
    why += fmt::format("; {} {}", scene.bolts.size(), scene.bolts.size() == 1 ? "bolt" : "bolts");
  std::string files = ", contact.state";
  if (scene.output.vtu) files += ", contact_NNNN.vtu, contact.pvd";
  if (scene.output.csv) files += scene.points.empty() ? ", history.csv" : ", history.csv, points.csv";
  if (scene.output.csv) files += ", bodies.csv";
  Plan plan = plan_of_bodies(Step::contact, why, files, scene.output.report);
  // A contact a block and side; one warm solve a step.
  const auto blocks = static_cast<double>(moving);
  const double steps = s.duration / s.step;
  plan.estimate.memory_mb = 20 + blocks * 0.005 + deforming.memory_mb + 3e-5 * blocks * static_cast<double>(s.frames);
  plan.estimate.seconds =
      deforming.seconds + (s.to_rest ? std::min(steps, 2000.0) : steps) * (blocks * 2.06e-5 + 2e-7 * deforming.modes);
  std::ranges::find(plan.steps, Step::contact, &PlannedStep::step)->seconds = plan.estimate.seconds;
  add_inputs(contact_scene_keys(), scene.given, plan);
  return plan;
}

}  // namespace cleave::scene
