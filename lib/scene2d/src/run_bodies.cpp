#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include "body_runs.hpp"
#include "cleave/bem/statics.hpp"
#include "cleave/core/parallel.hpp"
#include "cleave/scene/plan_steps.hpp"
#include "cleave/scene2d/bodies.hpp"

namespace cleave::scene {

Problem problem_of(const BodiesScene& scene, std::size_t body, const std::string& what) {
  return {scene.shown, scene.bodies[body].line, fmt::format("body[{}]", body + 1), what,
          "see docs/bem.md on supports and meshes"};
}

namespace {

using bem::Vec2;

/// Stress on a grid of about 1,500 cells in the body (around its openings when it is infinite).
void add_cells(const bem::Solution& solution, std::size_t region, BodyResult& body, bool infinite, unsigned threads) {
  Box2 box;
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
    cell.stress = solution.stress(region, cell.centre).value();  // region_at has found it there
    cell.displacement = solution.displacement(region, cell.centre).value();
    cell.out_of_plane = material.out_of_plane(cell.stress);
  });
}

/// Natural frequencies of bodies that stand alone, on the mesh of the answer.
std::optional<Problem> add_frequencies(const BodiesScene& scene, unsigned threads, BodiesResult& result) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodySpec& spec = scene.bodies[b];
    if (spec.bonded || spec.extent != bem::Extent::bounded || !spec.pins.empty()) {
      result.notes.push_back(fmt::format("{}: no natural frequencies of bonded, pinned or infinite bodies", spec.name));
      continue;
    }
    bem::BlockOptions options;
    options.mesh = scene.options.mesh;
    options.threads = threads;
    if (options.mesh.order == bem::Order::constant) options.mesh.order = bem::Order::quadratic;
    if (!options.mesh.element) {
      Box2 box;
      for (const Vec2 x : result.bodies[b].outline.front()) box.add(x);
      options.mesh.element = std::max(box.high.x - box.low.x, box.high.y - box.low.y) / 16;
    }
    auto made = bem::BlockOperator::make(spec.region.loops, spec.region.material, options);
    if (!made) return problem_of(scene, b, describe(made.error()));
    const NodeSupports supports = supports_of(*made, spec);
    result.bodies[b].modes_hz =
        frequencies_of(bem::supported_modes(*made, supports.held, supports.springs), scene.frequencies);
  }
  return std::nullopt;
}

constexpr std::string_view under_forces =
    "what moves lies within three elements of a point force, where no mesh settles: make elements smaller";

/// The same on half and a quarter of the elements, or as many doublings as a tolerance asks for.
std::expected<bem::Refined, bem::SolveError> solve_series(const bem::Problem& problem, bem::Options options,
                                                          std::optional<double> tolerance) {
  for (bool again = true;; again = false) {
    auto refined = bem::solve_to(problem, options, tolerance.value_or(1e-300), tolerance ? 6 : 3);
    const auto* free = refined ? nullptr : std::get_if<bem::FreeMotions>(&refined.error());
    // Constant elements that one of them cannot hold: it begins with two.
    if (!again || free == nullptr || !free->finer_holds) return refined;
    options.mesh.subdivide *= 2;
  }
}

/// The longest straight side, in elements.
std::size_t most_elements_of_a_side(const bem::Solution& solution) {
  std::size_t most = 0;
  for (const auto& part : solution.regions()) {
    std::size_t in_a_row = 0;
    for (std::size_t e = 0; e < part.mesh.elements.size(); ++e) {
      const bem::Element& element = part.mesh.elements[e];
      if (element.curved) return std::numeric_limits<std::size_t>::max();
      const bool goes_on =
          e > 0 && part.mesh.elements[e - 1].side == element.side && part.mesh.elements[e - 1].loop == element.loop;
      in_a_row = goes_on ? in_a_row + 1 : 1;
      most = std::max(most, in_a_row);
    }
  }
  return most;
}

ErrorEstimate estimate_of(const bem::Refined& refined, const bem::Problem& problem) {
  const std::size_t changes = refined.series.size();
  if (changes == 0) return {std::nullopt, "there is memory for one mesh only"};
  const double last = refined.series[changes - 1].error;
  const double first = changes < 2 ? std::numeric_limits<double>::infinity() : refined.series[changes - 2].error;
  if (!std::isfinite(last) || (changes > 1 && !std::isfinite(first))) return {std::nullopt, std::string{under_forces}};
  if (changes < 2) return {last, ""};
  constexpr std::size_t few = 8;  // elements on a side: an order does not show yet
  const bool slow = !problem.forces.empty() || most_elements_of_a_side(refined.solution) < few;
  return estimate_from(first, last, slow ? Course::at_rest_coarse : Course::at_rest);
}

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
    result.points[p] = {scene.points[p].name, scene.points[p].at, {Vec2{}}, {}};
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
    bem::Options coarse = options;
    if (!refine && coarse.mesh.element) {
      *coarse.mesh.element *= 2;
    } else if (!refine) {
      Box2 box;
      for (const bem::Region& region : problem.regions) {
        for (const bem::Loop& loop : region.loops) {
          for (std::size_t s = 0; s < loop.size(); ++s) box.add(loop[s].start), box.add(bem::point_on(loop, s, 0.5).x);
        }
      }
      coarse.mesh.element = std::max(box.high.x - box.low.x, box.high.y - box.low.y) / 4;
    }
    auto refined = solve_series(problem, refine ? options : coarse, scene.tolerance);
    if (!refined) return problem_of(scene, group.front(), describe(refined.error()));
    error = refined->error;
    const ErrorEstimate estimate = estimate_of(*refined, problem);
    if (!estimate.error)
      result.notes.push_back(fmt::format("{}: no estimate of the error: {}", names, estimate.why_not));
    if (refine && !refined->reached) {
      result.converged = false;
      result.stopped_why =
          std::isfinite(error)
              ? fmt::format("{}: the displacement still changes by {:.1e} (asked: {:.1e}) after {} meshes", names,
                            error, *scene.tolerance, refined->meshes)
              : fmt::format("{}: {} meshes cannot be compared (asked: {:.1e}): {}", names, refined->meshes,
                            *scene.tolerance, under_forces);
    }
    for (const bem::MeshError& mesh : refined->series) {
      if (std::isfinite(mesh.error)) result.trials.push_back({names, mesh.elements, mesh.seconds, mesh.error});
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
      body.error = estimate.error;
      body.no_estimate = estimate.why_not;
      body.outline = along<Vec2>(part.mesh, [&](std::size_t e, double s) { return solution->boundary(k, e, s).x; });
      body.frames = {along<Vec2>(part.mesh, [&](std::size_t e, double s) {
        const bem::BoundaryPoint p = solution->boundary(k, e, s);
        return p.x + p.displacement;
      })};
      body.boundary_stress =
          along<bem::Sym2>(part.mesh, [&](std::size_t e, double s) { return solution->boundary(k, e, s).stress; });
      for (const auto& loop : body.boundary_stress) {
        auto& across = body.boundary_out_of_plane.emplace_back();
        for (const bem::Sym2 s : loop) across.push_back(pascals(part.material.out_of_plane(s)));
      }
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
      body.centroid = infinite ? rest : rest + solution->displacement(k, rest).value_or(mean);
      if (scene.stress && (scene.output.report || scene.output.vtu)) add_cells(*solution, k, body, infinite, threads);
      result.largest_displacement = std::max(result.largest_displacement, body.largest);
    }
    for (std::size_t p = 0; p < scene.points.size(); ++p) {
      const auto k = std::ranges::find(group, scene.points[p].body);
      if (k == group.end()) continue;
      const auto region = static_cast<std::size_t>(k - group.begin());
      // The scene was refused when a point lies in no body.
      constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
      const Vec2 at = scene.points[p].at;
      result.points[p].displacement[0] = solution->displacement(region, at).value_or(Vec2{unknown, unknown});
      if (!scene.points[p].stress) continue;
      result.points[p].stress = {solution->stress(region, at).value_or(bem::Sym2{unknown, unknown, unknown})};
    }
  }
  result.times = {0};
  return scene.frequencies > 0 ? add_frequencies(scene, threads, result) : std::nullopt;
}

}  // namespace

Plan make_plan(const BodiesScene& scene) {
  const bool moving = scene.time.has_value();
  std::string why = fmt::format("{} {}", scene.bodies.size(), scene.bodies.size() == 1 ? "body" : "bodies");
  if (moving) {
    why += fmt::format(", {:.6g} s in steps of {:.3g} s ({})", scene.time->end, scene.time->step,
                       bem::name_of(scene.time->scheme));
    if (std::ranges::none_of(scene.points, &PointSpec::stress)) why += "; no stress inside: no point asks for it";
    if (!scene.time->estimate) why += "; no estimate of the error: switched off";
    if (!scene.time->rebuild) why += "; no rebuilding: switched off";
    if (!scene.stress || (!scene.output.report && !scene.output.vtu))
      why += "; no stress on the boundary: nothing asks for it";
  } else {
    why += ", static: no mass, no inner points, no cells, no time steps";
    if (!scene.stress || (!scene.output.report && !scene.output.vtu)) why += "; no stress inside: nothing asks for it";
    if (scene.gravity == Vec2{}) why += "; no weight";
  }
  Plan plan = plan_of_bodies(Step::elastic, why, scene.output.vtu ? ", bodies.vtu" : "", scene.output.report);
  double unknowns = 0;
  for (const BodySpec& body : scene.bodies) {
    const bem::Mesh mesh = bem::make_mesh(body.region.loops, scene.options.mesh);
    unknowns += 2 * static_cast<double>(mesh.nodes.size());
    plan.estimate.memory_mb += 16e-6 * std::pow(2 * static_cast<double>(mesh.nodes.size()), 2);
    plan.estimate.seconds += 2e-9 * std::pow(2 * static_cast<double>(mesh.nodes.size()), 3);
  }
  plan.estimate.memory_mb += 20;
  // The estimate of the error runs it once more with twice the step.
  const double runs = moving && scene.time->estimate ? 1.5 : 1;
  if (moving) plan.estimate.seconds += runs * 4e-9 * unknowns * scene.time->end / scene.time->step;
  std::ranges::find(plan.steps, Step::elastic, &PlannedStep::step)->seconds = plan.estimate.seconds;
  add_inputs(elastic_scene_keys(), scene.given, plan);
  return plan;
}

std::expected<BodiesResult, std::vector<Problem>> run(const BodiesScene& scene, unsigned threads, StageTimer& timer,
                                                      Progress& progress) {
  BodiesResult result;
  static_cast<ResultHead&>(result) = head_of(scene, make_plan(scene));
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
