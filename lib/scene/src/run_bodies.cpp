#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "cleave/bem/boundary_stress.hpp"
#include "cleave/bem/statics.hpp"
#include "cleave/core/parallel.hpp"
#include "cleave/scene/bodies.hpp"
#include "cleave/scene/run.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;

constexpr std::size_t samples = 6;  ///< of an element, for drawing

Problem problem_of(const BodiesScene& scene, std::size_t body, const std::string& what) {
  return {scene.shown, scene.bodies[body].line, fmt::format("body[{}]", body + 1), what,
          "see docs/bem.md on supports and meshes"};
}

/// Values along every loop of a mesh, closed.
template <class Value, class At>
std::vector<std::vector<Value>> along(const bem::Mesh& mesh, const At& at) {
  std::vector<std::vector<Value>> loops;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    if (mesh.elements[e].loop >= loops.size()) loops.resize(mesh.elements[e].loop + 1);
    for (std::size_t k = 0; k < samples; ++k) {
      loops[mesh.elements[e].loop].push_back(at(e, -1 + 2 * static_cast<double>(k) / samples));
    }
  }
  for (auto& loop : loops) loop.push_back(loop.front());
  return loops;
}

struct Box {
  Vec2 low{1e300, 1e300}, high{-1e300, -1e300};
  void add(Vec2 x) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y)};
  }
};

/// Stress on a grid of about 1,500 cells in the body (around its openings when it is infinite).
void add_cells(const bem::Solution& solution, std::size_t region, BodyResult& body, bool infinite, unsigned threads) {
  Box box;
  for (const auto& loop : body.outline) {
    for (const Vec2 x : loop) box.add(x);
  }
  if (infinite) {
    const Vec2 grow = 1.0 * (box.high - box.low);
    box.low -= grow;
    box.high += grow;
  }
  const Vec2 span = box.high - box.low;
  const double size = std::max(std::sqrt(span.x * span.y / 1500), std::max(span.x, span.y) / 120);
  const bem::Material& material = solution.regions()[region].material;
  for (double y = box.low.y + size / 2; y < box.high.y; y += size) {
    for (double x = box.low.x + size / 2; x < box.high.x; x += size) {
      const Vec2 at{x, y};
      if (solution.region_at(at) != region) continue;
      body.cells.push_back({at, size, {}, {}, 0});
    }
  }
  parallel_for(body.cells.size(), ThreadLimit{std::max(1U, threads)}, [&](std::size_t k) {
    StressCell& cell = body.cells[k];
    cell.stress = solution.stress(region, cell.centre);
    cell.displacement = solution.displacement(region, cell.centre);
    cell.out_of_plane = material.out_of_plane(cell.stress);
  });
}

using Problems = std::vector<Problem>;

std::optional<Problem> solve_static(const BodiesScene& scene, unsigned threads, BodiesResult& result) {
  // Bonded bodies are one problem; others stand alone, each with a dense system of its own.
  std::vector<std::vector<std::size_t>> groups;
  std::vector<std::size_t> glued;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].bonded) {
      glued.push_back(b);
    } else {
      groups.push_back({b});
    }
  }
  // The infinite body comes first in its group.
  std::ranges::stable_sort(glued, [&](std::size_t a, std::size_t b) {
    return (scene.bodies[a].extent != bem::Extent::bounded) > (scene.bodies[b].extent != bem::Extent::bounded);
  });
  if (!glued.empty()) groups.push_back(glued);
  result.bodies.resize(scene.bodies.size());
  result.points.resize(scene.points.size());
  for (std::size_t p = 0; p < scene.points.size(); ++p)
    result.points[p] = {scene.points[p].name, scene.points[p].at, {Vec2{}}};
  for (const auto& group : groups) {
    bem::Problem problem;
    const BodySpec& first = scene.bodies[group.front()];
    problem.extent = first.extent;
    problem.surface = first.surface;
    problem.in_situ = first.in_situ;
    problem.load.gravity = scene.gravity;
    for (std::size_t k = 0; k < group.size(); ++k) {
      problem.regions.push_back(scene.bodies[group[k]].region);
      for (const BodyLoadSpec& load : scene.bodies[group[k]].loads) {
        if (load.sides.empty()) problem.forces.push_back({k, load.at, load.force});
      }
    }
    bem::Options options = scene.options;
    options.threads = threads;
    std::optional<bem::Solution> solution;
    double error = 0;
    const std::string names = group.size() == 1 ? first.name : "bonded bodies";
    const bool refine = scene.tolerance.has_value();
    // Each result has an estimate: the same on half as many elements (a mesh pair), or as many doublings as asked.
    bem::Options coarse = options;
    if (!refine && coarse.mesh.element <= 0) {
      Box box;
      for (const bem::Region& region : problem.regions) {
        for (const bem::Loop& loop : region.loops) {
          for (std::size_t s = 0; s < loop.size(); ++s) box.add(loop[s].start), box.add(bem::point_on(loop, s, 0.5).x);
        }
      }
      coarse.mesh.element = std::max(box.high.x - box.low.x, box.high.y - box.low.y) / 8;
    }
    auto refined =
        bem::solve_to(problem, refine ? options : coarse, refine ? *scene.tolerance : 1e-300, refine ? 6 : 2);
    if (!refined) return problem_of(scene, group.front(), describe(refined.error()));
    error = refined->error;
    if (refine && !refined->reached) {
      result.converged = false;
      result.stopped_why = fmt::format("{}: the displacement still changes by {:.1e} (asked: {:.1e}) after {} meshes",
                                       names, error, *scene.tolerance, refined->meshes);
    }
    for (const bem::MeshError& mesh : refined->series) {
      result.trials.push_back({names, mesh.elements, mesh.seconds, mesh.error});
    }
    solution = std::move(refined->solution);
    const bem::Diagnostics& d = solution->diagnostics();
    result.residual = std::max(result.residual, d.residual);
    for (std::size_t k = 0; k < group.size(); ++k) {
      const bool infinite = k == 0 && first.extent != bem::Extent::bounded;
      BodyResult& body = result.bodies[group[k]];
      const auto& part = solution->regions()[k];
      body.name = scene.bodies[group[k]].name;
      body.method = "direct collocation";
      body.elements = part.mesh.elements.size();
      body.unknowns = d.unknowns;
      body.condition = d.condition;
      body.residual = d.residual;
      body.imbalance = d.imbalance;
      body.error = error;
      body.outline = along<Vec2>(part.mesh, [&](std::size_t e, double s) { return solution->boundary(k, e, s).x; });
      body.frames = {along<Vec2>(part.mesh, [&](std::size_t e, double s) {
        const bem::BoundaryPoint p = solution->boundary(k, e, s);
        return p.x + p.displacement;
      })};
      body.boundary_stress =
          along<bem::Sym2>(part.mesh, [&](std::size_t e, double s) { return solution->boundary(k, e, s).stress; });
      for (const Vec2 u : part.displacement) body.largest = std::max(body.largest, norm(u));
      // Mean motion of the outline: translation and rotation of the body.
      const bem::AreaMoments area = bem::area_moments(part.loops);
      const Vec2 rest = area.centroid;
      Vec2 mean;
      double turn = 0, weight = 0;
      for (std::size_t n = 0; n < part.displacement.size(); ++n) mean += part.displacement[n];
      mean = mean / static_cast<double>(part.displacement.size());
      for (std::size_t n = 0; n < part.displacement.size(); ++n) {
        const Vec2 r = solution->node(k, n) - rest;
        turn += cross(r, part.displacement[n] - mean);
        weight += dot(r, r);
      }
      body.rotation = weight > 0 ? turn / weight : 0;
      body.centroid =
          infinite ? rest : rest + (solution->region_at(rest) == k ? solution->displacement(k, rest) : mean);
      if (scene.stress && (scene.output.report || scene.output.vtu)) add_cells(*solution, k, body, infinite, threads);
      result.largest_displacement = std::max(result.largest_displacement, body.largest);
    }
    for (std::size_t p = 0; p < scene.points.size(); ++p) {
      const auto k = std::ranges::find(group, scene.points[p].body);
      if (k == group.end()) continue;
      result.points[p].displacement[0] =
          solution->displacement(static_cast<std::size_t>(k - group.begin()), scene.points[p].at);
    }
  }
  result.times = {0};
  return std::nullopt;
}

/// A body in motion, whichever way it moves.
struct Mover {
  std::unique_ptr<bem::BlockOperator> block;
  std::unique_ptr<bem::Vibration> vibration;
  std::unique_ptr<bem::FreeMotion> free;
};

std::vector<double> forces_of(const bem::BlockOperator& block, const BodyLoadSpec& load) {
  if (load.sides.empty()) {
    std::vector<double> f(block.freedoms(), 0.0);
    block.add_point_force(block.place(load.at - block.centroid()), load.force, f);
    return f;
  }
  // Sides are numbered through the loops; make_mesh keeps loop and side of each element.
  return {};
}

std::optional<Problem> set_up(const BodiesScene& scene, std::size_t b, unsigned threads, Mover& mover) {
  const BodySpec& spec = scene.bodies[b];
  const TimeSettings& time = *scene.time;
  bem::BlockOptions options;
  options.mesh = scene.options.mesh;
  options.threads = threads;
  options.mesh.order =
      scene.options.mesh.order == bem::Order::constant ? bem::Order::quadratic : scene.options.mesh.order;
  if (options.mesh.element <= 0) {
    Box box;
    for (const bem::Side& side : spec.region.loops.front()) box.add(side.start);
    // Two elements on the shorter side are enough for the lowest vibrations.
    options.mesh.element = std::max(box.high.x - box.low.x, box.high.y - box.low.y) / 4;
  }
  auto made = bem::BlockOperator::make(spec.region.loops, spec.region.material, options);
  if (!made) return problem_of(scene, b, describe(made.error()));
  mover.block = std::make_unique<bem::BlockOperator>(*std::move(made));
  const bem::BlockOperator& block = *mover.block;
  std::vector<bem::TimedLoad> loads;
  const bem::Mesh& mesh = block.mesh();
  const auto side_number = [&](const bem::Element& e) { return spec.region.loops[e.loop][e.side].condition; };
  for (const BodyLoadSpec& load : spec.loads) {
    std::vector<double> f;
    if (load.sides.empty()) {
      f = forces_of(block, load);
    } else {
      std::vector<std::array<Vec2, 3>> t(mesh.elements.size());
      const auto local = bem::local_nodes(mesh.order);
      for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
        if (std::ranges::find(load.sides, side_number(mesh.elements[e])) == load.sides.end()) continue;
        for (std::size_t a = 0; a < local.size(); ++a) {
          t[e][a] = load.traction - load.pressure * mesh.elements[e].normal(local[a]);
        }
      }
      f = block.forces_of(t);
    }
    loads.push_back({std::move(f), load.time, load.follows});
  }
  if (!spec.held) {
    bem::FreeMotion::Setup setup{.scheme = time.scheme,
                                 .step = time.step,
                                 .modes = time.modes,
                                 .gravity = scene.gravity,
                                 .damping = time.damping,
                                 .loads = std::move(loads),
                                 .pins = {},
                                 .velocity = spec.velocity,
                                 .spin = spec.spin};
    for (const Vec2 pin : spec.pins) {
      const bem::BoundaryPlace place = block.place(pin - block.centroid());
      const Vec2 on = block.centroid() + mesh.elements[place.element].at(place.s);
      if (norm(on - pin) > 1e-3 * std::sqrt(block.area())) {
        return problem_of(scene, b, fmt::format("the pin at ({:.6g}, {:.6g}) is not on the boundary", pin.x, pin.y));
      }
      setup.pins.push_back({place, on});
    }
    mover.free = std::make_unique<bem::FreeMotion>(block, std::move(setup));
    return std::nullopt;
  }
  std::vector<bem::HeldFreedom> held;
  std::vector<bem::NodeSpring> springs;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    for (const bem::Use& use : mesh.nodes[n].uses) {
      const bem::Element& e = mesh.elements[use.element];
      const bem::Condition& c = spec.region.conditions[side_number(e)];
      const Vec2 normal = e.normal(bem::local_nodes(mesh.order)[use.local]);
      const auto axes = c.axes == bem::Axes::normal
                            ? std::array{bem::rotated(normal, c.turn), bem::rotated(bem::turned_left(normal), c.turn)}
                            : std::array{bem::rotated({1, 0}, c.turn), bem::rotated({0, 1}, c.turn)};
      for (std::size_t k = 0; k < 2; ++k) {
        if (c.component[k].given == bem::Given::displacement) held.push_back({n, axes[k]});
        if (c.component[k].given == bem::Given::spring) {
          // Lumped by the node's share of the element.
          const double share = mesh.order == bem::Order::quadratic ? (use.local == 1 ? 2.0 / 3 : 1.0 / 6) : 0.5;
          springs.push_back({n, axes[k], c.component[k].stiffness * share * 2 * norm(e.c1)});
        }
      }
    }
  }
  if (!(scene.gravity == Vec2{})) {
    loads.push_back({block.forces_of_acceleration(scene.gravity), [](double) { return 1.0; }, false});
  }
  mover.vibration = std::make_unique<bem::Vibration>(block, bem::supported_modes(block, held, springs), time.scheme,
                                                     time.step, time.damping, std::move(loads));
  if (!(spec.velocity == Vec2{}) || spec.spin != 0) {
    std::vector<double> v(block.freedoms(), 0.0);
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      const Vec2 w = spec.velocity + spec.spin * bem::turned_left(mesh.nodes[n].x);
      v[2 * n] = w.x;
      v[2 * n + 1] = w.y;
    }
    mover.vibration->set_velocity(v);
  }
  return std::nullopt;
}

std::optional<Problem> run_motion(const BodiesScene& scene, unsigned threads, BodiesResult& result,
                                  Progress& progress) {
  const TimeSettings& time = *scene.time;
  std::vector<Mover> movers(scene.bodies.size());
  result.bodies.resize(scene.bodies.size());
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (auto wrong = set_up(scene, b, threads, movers[b])) return wrong;
    const bem::BlockOperator& block = *movers[b].block;
    BodyResult& body = result.bodies[b];
    body.name = scene.bodies[b].name;
    body.method = movers[b].free ? "floating frame, symmetric Galerkin modes" : "symmetric Galerkin modes";
    body.elements = block.mesh().elements.size();
    body.unknowns = block.freedoms();
    body.outline = along<Vec2>(
        block.mesh(), [&](std::size_t e, double s) { return block.centroid() + block.mesh().elements[e].at(s); });
  }
  std::vector<bem::BoundaryPlace> places;
  for (const PointSpec& point : scene.points) {
    const bem::BlockOperator& block = *movers[point.body].block;
    const bem::BoundaryPlace place = block.place(point.at - block.centroid());
    const Vec2 on = block.centroid() + block.mesh().elements[place.element].at(place.s);
    if (norm(on - point.at) > 1e-3 * std::sqrt(block.area())) {
      result.notes.push_back(
          fmt::format("point \"{}\" was moved to the boundary, ({:.6g}, {:.6g}): moving bodies are followed there",
                      point.name, on.x, on.y));
    }
    places.push_back(place);
    result.points.push_back({point.name, on, {}});
  }
  const auto steps = static_cast<std::uint64_t>(std::llround(time.end / time.step));
  const std::uint64_t every = std::max<std::uint64_t>(1, steps / time.frames);
  // Stress costs a product with a dense matrix a frame: only for a picture that shows it.
  const bool stressed = scene.stress && (scene.output.report || scene.output.vtu);
  const auto record_stress = [&](const Mover& m, BodyResult& body, const std::vector<double>& u, double angle) {
    const auto tractions = bem::tractions_of(*m.block, u);
    const auto at = [&](std::size_t e, double s) {
      const bem::Sym2 own = bem::boundary_stress(*m.block, {e, s}, u, tractions);
      const double c = std::cos(angle), d = std::sin(angle);
      return bem::Sym2{c * c * own.xx - 2 * c * d * own.xy + d * d * own.yy,
                       c * d * (own.xx - own.yy) + (c * c - d * d) * own.xy,
                       d * d * own.xx + 2 * c * d * own.xy + c * c * own.yy};
    };
    body.stress_frames.push_back(along<bem::Sym2>(m.block->mesh(), at));
    body.mises_frames.push_back(along<double>(m.block->mesh(), [&](std::size_t e, double s) {
      const bem::Sym2 v = at(e, s);
      const double z = m.block->material().out_of_plane(v);
      return std::sqrt(0.5 * (std::pow(v.xx - v.yy, 2) + std::pow(v.yy - z, 2) + std::pow(z - v.xx, 2)) +
                       3 * v.xy * v.xy);
    }));
  };
  const auto record = [&](std::uint64_t step) {
    result.times.push_back(static_cast<double>(step) * time.step);
    std::array<double, 3> energy{};
    for (std::size_t b = 0; b < movers.size(); ++b) {
      const Mover& m = movers[b];
      const bem::Mesh& mesh = m.block->mesh();
      BodyResult& body = result.bodies[b];
      if (m.free) {
        body.frames.push_back(along<Vec2>(mesh, [&](std::size_t e, double s) { return m.free->position({e, s}); }));
        body.centroid = m.free->centroid();
        body.rotation = m.free->rotation();
        if (stressed) record_stress(m, body, m.free->deformation(), body.rotation);
        const bem::Energy now = m.free->energy();
        energy[0] += now.kinetic;
        energy[1] += now.elastic;
        energy[2] += now.gravity;
      } else {
        const auto u = m.vibration->displacement();
        body.frames.push_back(along<Vec2>(mesh, [&](std::size_t e, double s) {
          return m.block->centroid() + mesh.elements[e].at(s) + m.block->displacement_at({e, s}, u);
        }));
        if (stressed) record_stress(m, body, u, 0);
        Vec2 mean;
        double turn = 0, weight = 0;
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
          const Vec2 v{u[2 * n], u[2 * n + 1]};
          mean += v / static_cast<double>(mesh.nodes.size());
          turn += cross(mesh.nodes[n].x, v);
          weight += dot(mesh.nodes[n].x, mesh.nodes[n].x);
        }
        body.centroid = m.block->centroid() + mean;
        body.rotation = turn / weight;
        energy[0] += m.vibration->kinetic_energy();
        energy[1] += m.vibration->elastic_energy();
      }
      for (std::size_t l = 0; l < body.outline.size(); ++l) {
        for (std::size_t k = 0; k < body.outline[l].size(); ++k) {
          body.largest = std::max(body.largest, norm(body.frames.back()[l][k] - body.outline[l][k]));
        }
      }
      result.largest_displacement = std::max(result.largest_displacement, body.largest);
    }
    for (std::size_t p = 0; p < places.size(); ++p) {
      const Mover& m = movers[scene.points[p].body];
      result.points[p].displacement.push_back(m.free ? m.free->position(places[p]) - result.points[p].at
                                                     : m.vibration->displacement_at(places[p]));
    }
    result.energy.push_back(energy);
  };
  record(0);
  progress.begin("elastic", steps);
  for (std::uint64_t step = 1; step <= steps; ++step) {
    for (std::size_t b = 0; b < movers.size(); ++b) {
      if (movers[b].vibration) {
        movers[b].vibration->advance();
        continue;
      }
      if (auto done = movers[b].free->advance(); !done) {
        result.converged = false;
        result.stopped_why = fmt::format("{}: {}", scene.bodies[b].name, describe(done.error()));
        result.steps = step;
        record(step - 1);
        return std::nullopt;
      }
    }
    result.steps = step;
    if (step % every == 0 || step == steps) record(step);
    progress.advance();
  }
  for (std::size_t b = 0; b < movers.size(); ++b) {
    if (movers[b].free && movers[b].free->relative_deformation() > 1e-2) {
      result.notes.push_back(
          fmt::format("{} is deformed by more than a hundredth of its size: the linear operator is at its limit",
                      scene.bodies[b].name));
    }
  }
  return std::nullopt;
}

}  // namespace

Plan make_plan(const BodiesScene& scene) {
  Plan plan;
  const bool moving = scene.time.has_value();
  std::string why = fmt::format("{} {}", scene.bodies.size(), scene.bodies.size() == 1 ? "body" : "bodies");
  if (moving) {
    why += fmt::format(", {:.6g} s in steps of {:.3g} s ({})", scene.time->end, scene.time->step,
                       bem::name_of(scene.time->scheme));
    why += "; no stress inside: moving bodies are followed by their modes";
    if (!scene.stress || (!scene.output.report && !scene.output.vtu))
      why += "; no stress on the boundary: nothing asks for it";
  } else {
    why += ", static: no mass, no inner points, no cells, no time steps";
    if (!scene.stress || (!scene.output.report && !scene.output.vtu)) why += "; no stress inside: nothing asks for it";
    if (scene.gravity == Vec2{}) why += "; no weight";
  }
  for (const Stage stage : all_stages) {
    const auto add = [&](bool run, std::string reason) { plan.stages.push_back({stage, run, std::move(reason)}); };
    switch (stage) {
      case Stage::read: add(true, "the scene"); break;
      case Stage::draw:
      case Stage::cut:
      case Stage::audit:
      case Stage::stability: add(false, "no [domain]: a scene of bodies"); break;
      case Stage::support: add(false, "no [support]"); break;
      case Stage::monte_carlo: add(false, "no [monte_carlo]: one run"); break;
      case Stage::elastic: add(true, why); break;
      case Stage::contact: add(false, "no contacts between bodies"); break;
      case Stage::write:
        add(true, scene.output.vtu ? "summary.json, log.txt, bodies.vtu" : "summary.json, log.txt");
        break;
      case Stage::report:
        add(scene.output.report, scene.output.report ? "report.html" : "output.report = false");
        break;
    }
  }
  double unknowns = 0;
  for (const BodySpec& body : scene.bodies) {
    const bem::Mesh mesh = bem::make_mesh(body.region.loops, scene.options.mesh);
    unknowns += 2 * static_cast<double>(mesh.nodes.size());
    plan.estimate.memory_mb += 16e-6 * std::pow(2 * static_cast<double>(mesh.nodes.size()), 2);
    plan.estimate.seconds += 2e-9 * std::pow(2 * static_cast<double>(mesh.nodes.size()), 3);
  }
  plan.estimate.memory_mb += 20;
  plan.estimate.blocks_low = plan.estimate.blocks_high = 0;
  if (moving) plan.estimate.seconds += 4e-9 * unknowns * scene.time->end / scene.time->step;
  return plan;
}

std::expected<BodiesResult, std::vector<Problem>> run(const BodiesScene& scene, unsigned threads, StageTimer& timer,
                                                      Progress& progress) {
  BodiesResult result;
  result.title = scene.title;
  result.seed = scene.seed;
  result.scene_file = scene.file_name;
  result.scene_sha256 = scene.sha256;
  result.plan = make_plan(scene);
  result.output = scene.output;
  for (const Problem& note : scene.notes) result.notes.push_back(describe(note));
  progress.begin("elastic");
  const auto wrong = timer.run("elastic", [&] {
    return scene.time ? run_motion(scene, threads, result, progress) : solve_static(scene, threads, result);
  });
  progress.end();
  if (wrong) return std::unexpected(std::vector{*wrong});
  result.cost = cost_of(timer, threads);
  return result;
}

}  // namespace cleave::scene
