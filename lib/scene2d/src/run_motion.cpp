#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "body_runs.hpp"
#include "cleave/bem/block.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;

/// A body in motion, whichever way it moves.
struct Mover {
  std::unique_ptr<bem::BlockOperator> block;
  std::unique_ptr<bem::Vibration> vibration;
  std::unique_ptr<bem::FreeMotion> free;
  bool halves = true;  // half the elements are another mesh

  [[nodiscard]] std::expected<void, bem::MotionError> advance() const {
    return vibration ? vibration->advance() : free->advance();
  }
  [[nodiscard]] Vec2 position(bem::BoundaryPlace place) const {
    if (free) return free->position(place);
    return block->centroid() + block->mesh().elements[place.element].at(place.s) + vibration->displacement_at(place);
  }
  [[nodiscard]] std::size_t follow(Vec2 at) const {
    const Vec2 own = at - block->centroid();
    return free ? free->follow(own) : vibration->follow(own);
  }
  /// Of a pinned body there are none: its pins are no part of its modes.
  [[nodiscard]] std::vector<double> frequencies(std::size_t count) const {
    if (free && free->pinned()) return {};
    return frequencies_of(free ? free->modes() : vibration->modes(), count);
  }
  [[nodiscard]] double angle() const { return free ? free->rotation() : 0; }
  [[nodiscard]] Vec2 centre() const { return free ? free->centroid() : block->centroid(); }
  [[nodiscard]] const bem::BlockOperator& now() const { return free ? free->block() : vibration->block(); }
  [[nodiscard]] std::vector<double> strained() const { return free ? free->strained() : vibration->strained(); }
  [[nodiscard]] std::size_t rebuilds() const { return free ? free->rebuilds() : vibration->rebuilds(); }
  [[nodiscard]] double steepest() const { return free ? free->steepest_seen() : vibration->steepest_seen(); }
};

/// Nodal forces of a load on the body as it is now.
std::vector<double> forces_of(const bem::BlockOperator& block, const BodySpec& spec, const BodyLoadSpec& load) {
  const bem::Mesh& mesh = block.mesh();
  if (load.sides.empty()) {
    std::vector<double> f(block.freedoms(), 0.0);
    block.add_point_force(block.place(load.at - block.centroid()), load.force, f);
    return f;
  }
  std::vector<std::array<Vec2, 3>> t(mesh.elements.size());
  const auto local = bem::local_nodes(mesh.order);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const std::size_t side = spec.region.loops[mesh.elements[e].loop][mesh.elements[e].side].condition;
    if (std::ranges::find(load.sides, side) == load.sides.end()) continue;
    for (std::size_t a = 0; a < local.size(); ++a) {
      t[e][a] = load.traction - load.pressure * mesh.elements[e].normal(local[a]);
    }
  }
  return block.forces_of(t);
}

/// How finely: the run itself (1), or those its error is estimated from: half and a quarter of the elements and modes,
/// two and four times the step.
struct Fineness {
  std::size_t coarse = 1;
  [[nodiscard]] double step(const TimeSettings& time) const { return static_cast<double>(coarse) * time.step; }
  [[nodiscard]] std::optional<std::size_t> modes(std::optional<std::size_t> given) const {
    if (!given) return given;
    return std::max(std::min<std::size_t>(*given, 6), *given / coarse);
  }
};

std::optional<Problem> set_up(const BodiesScene& scene, std::size_t b, unsigned threads, Fineness fineness,
                              Mover& mover) {
  const BodySpec& spec = scene.bodies[b];
  const TimeSettings& time = *scene.time;
  std::vector<bem::Loop> loops = spec.region.loops;
  bem::BlockOptions options;
  options.mesh = scene.options.mesh;
  options.threads = threads;
  options.mesh.order =
      scene.options.mesh.order == bem::Order::constant ? bem::Order::quadratic : scene.options.mesh.order;
  if (!options.mesh.element) {
    Box2 box;
    for (const bem::Side& side : spec.region.loops.front()) box.add(side.start);
    // Two elements on the shorter side are enough for the lowest vibrations.
    options.mesh.element = std::max(box.high.x - box.low.x, box.high.y - box.low.y) / 4;
  }
  if (fineness.coarse > 1) {
    *options.mesh.element *= static_cast<double>(fineness.coarse);
    options.mesh.arc_degrees = std::min(45.0, options.mesh.arc_degrees * static_cast<double>(fineness.coarse));
    for (bem::Loop& loop : loops) {
      for (bem::Side& side : loop) {
        if (side.elements) side.elements = (*side.elements + fineness.coarse - 1) / fineness.coarse;
      }
    }
  }
  auto made = bem::BlockOperator::make(loops, spec.region.material, options);
  if (!made) return problem_of(scene, b, describe(made.error()));
  mover.block = std::make_unique<bem::BlockOperator>(*std::move(made));
  const bem::BlockOperator& block = *mover.block;
  std::vector<bem::TimedLoad> loads;
  const bem::Mesh& mesh = block.mesh();
  for (const BodyLoadSpec& load : spec.loads) {
    bem::TimedLoad timed{forces_of(block, spec, load), load.time, load.follows, {}};
    if (load.follows && !load.sides.empty()) {
      timed.again = [&spec, load](const bem::BlockOperator& now) { return forces_of(now, spec, load); };
    }
    loads.push_back(std::move(timed));
  }
  std::optional<bem::Rebuilding> rebuilding;
  if (time.rebuild) rebuilding = {*time.rebuild, options};
  if (!spec.held) {
    bem::FreeMotion::Setup setup{.scheme = time.scheme,
                                 .step = fineness.step(time),
                                 .modes = fineness.modes(time.modes),
                                 .gravity = scene.gravity,
                                 .damping = time.damping,
                                 .loads = std::move(loads),
                                 .pins = {},
                                 .velocity = spec.velocity,
                                 .spin = spec.spin,
                                 .rebuilding = rebuilding};
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
  const auto [held, springs] = supports_of(block, spec);
  if (!(scene.gravity == Vec2{})) {
    loads.push_back({block.forces_of_acceleration(scene.gravity), [](double) { return 1.0; }, false, {}});
  }
  mover.vibration = std::make_unique<bem::Vibration>(block, bem::supported_modes(block, held, springs), time.scheme,
                                                     fineness.step(time), time.damping, std::move(loads));
  if (rebuilding) mover.vibration->rebuild_by(*rebuilding, held, springs);
  if (!(spec.velocity == Vec2{}) || spec.spin != 0) {
    std::vector<double> v(block.freedoms(), 0.0);
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      const Vec2 w = spec.velocity + spec.spin * turned_left(mesh.nodes[n].x);
      v[2 * n] = w.x;
      v[2 * n + 1] = w.y;
    }
    mover.vibration->set_velocity(v);
  }
  return std::nullopt;
}

/// Waves as short as a body is thick are those of its static extension where it is longer than its inner motions
/// follow: runs of any fineness then agree on what is wrong.
bool is_too_long(const bem::BlockOperator& block) {
  double extent = 0;
  for (const bem::Node& node : block.mesh().nodes) extent = std::max(extent, 2 * norm(node.x));
  return extent * extent > 2 * static_cast<double>(block.bubbles().degree) * block.area();
}

/// What runs of other fineness do not tell of.
std::string untold(const Mover& mover) {
  if (is_too_long(*mover.block))
    return "the body is longer than its inner motions follow: waves as short as it is thick may be wrong";
  if (!mover.halves) return "its mesh cannot be halved, so runs of all finenesses agree: make elements smaller";
  return "";
}

/// Where the nodes of the run's meshes are in a coarser run, at each `every`th step of the run itself: [record][body]
/// [node]. Empty when that run fails.
using Track = std::vector<std::vector<std::vector<Vec2>>>;
Track coarse_track(const BodiesScene& scene, unsigned threads, std::vector<Mover>& fine, Fineness fineness,
                   std::uint64_t steps, std::uint64_t every) {
  std::vector<Mover> movers(scene.bodies.size());
  std::vector<std::vector<bem::BoundaryPlace>> places(movers.size());
  for (std::size_t b = 0; b < movers.size(); ++b) {
    if (set_up(scene, b, threads, fineness, movers[b])) return {};
    if (movers[b].block->mesh().elements.size() >= fine[b].block->mesh().elements.size()) fine[b].halves = false;
    for (const bem::Node& node : fine[b].block->mesh().nodes) places[b].push_back(movers[b].block->place(node.x));
  }
  Track track;
  for (std::uint64_t step = fineness.coarse; step <= steps; step += fineness.coarse) {
    for (const Mover& m : movers) {
      if (!m.advance()) return {};
    }
    if (step % every != 0) continue;
    auto& record = track.emplace_back(movers.size());
    for (std::size_t b = 0; b < movers.size(); ++b) {
      for (const bem::BoundaryPlace place : places[b]) record[b].push_back(movers[b].position(place));
    }
  }
  return track;
}

}  // namespace

std::optional<Problem> run_motion(const BodiesScene& scene, unsigned threads, BodiesResult& result,
                                  Progress& progress) {
  const TimeSettings& time = *scene.time;
  std::vector<Mover> movers(scene.bodies.size());
  result.bodies.resize(scene.bodies.size());
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (auto wrong = set_up(scene, b, threads, {}, movers[b])) return wrong;
    const bem::BlockOperator& block = *movers[b].block;
    BodyResult& body = result.bodies[b];
    body.name = scene.bodies[b].name;
    body.method = movers[b].free ? "floating frame, symmetric Galerkin modes" : "symmetric Galerkin modes";
    body.elements = block.mesh().elements.size();
    body.unknowns = block.freedoms();
    body.modes_hz = movers[b].frequencies(scene.frequencies > 0 ? scene.frequencies : 6);
    body.outline = along<Vec2>(
        block.mesh(), [&](std::size_t e, double s) { return block.centroid() + block.mesh().elements[e].at(s); });
  }
  /// Points on the boundary are places of it; others are followed inside.
  struct Followed {
    std::optional<std::size_t> inner;
    bem::BoundaryPlace place;
  };
  std::vector<Followed> followed;
  for (const PointSpec& point : scene.points) {
    const Mover& m = movers[point.body];
    const bem::BlockOperator& block = *m.block;
    const bem::BoundaryPlace place = block.place(point.at - block.centroid());
    const Vec2 on = block.centroid() + block.mesh().elements[place.element].at(place.s);
    const bool inside = norm(on - point.at) > 1e-3 * std::sqrt(block.area());
    followed.push_back({inside ? std::optional{m.follow(point.at)} : std::nullopt, place});
    result.points.push_back({point.name, inside ? point.at : on, {}, {}});
  }
  const auto steps = static_cast<std::uint64_t>(std::llround(time.end / time.step));
  const std::uint64_t every = std::max<std::uint64_t>(1, steps / time.frames);
  // Steps that all three runs share.
  const std::uint64_t shared = 4 * std::max<std::uint64_t>(1, steps / 480);
  Track half, quarter;
  std::string none;
  if (!time.estimate) {
    none = "switched off";
  } else if (steps < 8) {
    none = "fewer than eight steps";
  } else {
    half = coarse_track(scene, threads, movers, {2}, steps, shared);
    quarter = coarse_track(scene, threads, movers, {4}, steps, shared);
    if (half.empty() || quarter.empty()) {
      none = half.empty() ? "a run half as fine fails" : "a run a quarter as fine fails";
      result.notes.push_back("the error could not be estimated: " + none);
    }
  }
  std::vector<double> first(movers.size(), 0.0), last = first, moved = first;
  const auto compare = [&](std::uint64_t step) {
    const std::uint64_t at = step / shared;
    if (!none.empty() || step == 0 || step % shared != 0 || at > std::min(half.size(), quarter.size())) return;
    for (std::size_t b = 0; b < movers.size(); ++b) {
      const bem::Mesh& mesh = movers[b].block->mesh();
      for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
        const bem::Use use = mesh.nodes[n].uses.front();
        const Vec2 x = movers[b].position({use.element, bem::local_nodes(mesh.order)[use.local]});
        last[b] = std::max(last[b], norm(x - half[at - 1][b][n]));
        first[b] = std::max(first[b], norm(half[at - 1][b][n] - quarter[at - 1][b][n]));
        moved[b] = std::max(moved[b], norm(x - movers[b].block->centroid() - mesh.nodes[n].x));
      }
    }
  };
  // Stress costs a product with a dense matrix a frame: only for a picture that shows it.
  const bool stressed = scene.stress && (scene.output.report || scene.output.vtu);
  const auto record_stress = [&](const Mover& m, BodyResult& body) {
    const auto u = m.strained();
    const auto tractions = bem::tractions_of(m.now(), u);
    const auto at = [&](std::size_t e, double s) {
      return in_world(bem::boundary_stress(m.now(), {e, s}, u, tractions), m.angle());
    };
    body.stress_frames.push_back(along<bem::Sym2>(m.now().mesh(), at));
    body.mises_frames.push_back(along<double>(m.now().mesh(), [&](std::size_t e, double s) {
      const bem::Sym2 v = at(e, s);
      return von_mises(v, m.block->material().out_of_plane(v));
    }));
  };
  const auto record = [&](std::uint64_t step) {
    result.times.push_back(static_cast<double>(step) * time.step);
    std::array<double, 3> energy{};
    for (std::size_t b = 0; b < movers.size(); ++b) {
      const Mover& m = movers[b];
      const bem::Mesh& mesh = m.block->mesh();
      BodyResult& body = result.bodies[b];
      body.frames.push_back(along<Vec2>(mesh, [&](std::size_t e, double s) { return m.position({e, s}); }));
      if (stressed) record_stress(m, body);
      if (m.free) {
        body.centroid = m.free->centroid();
        body.rotation = m.free->rotation();
        const bem::Energy now = m.free->energy();
        energy[0] += now.kinetic;
        energy[1] += now.elastic;
        energy[2] += now.gravity;
      } else {
        const auto u = m.vibration->displacement();
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
    for (std::size_t p = 0; p < followed.size(); ++p) {
      const Mover& m = movers[scene.points[p].body];
      PointResult& out = result.points[p];
      if (followed[p].inner) {
        const bem::InnerState state =
            m.free ? m.free->inner(*followed[p].inner) : m.vibration->inner(*followed[p].inner);
        const Vec2 own = out.at - m.block->centroid() + state.displacement;
        out.displacement.push_back(m.centre() + rotated(own, m.angle()) - out.at);
        if (scene.points[p].stress) out.stress.push_back(in_world(state.stress, m.angle()));
        continue;
      }
      out.displacement.push_back(m.position(followed[p].place) - out.at);
      if (scene.points[p].stress) {
        const auto u = m.strained();
        out.stress.push_back(
            in_world(bem::boundary_stress(m.now(), followed[p].place, u, bem::tractions_of(m.now(), u)), m.angle()));
      }
    }
    result.energy.push_back(energy);
  };
  const auto count_rebuilds = [&] {
    for (std::size_t b = 0; b < movers.size(); ++b) {
      result.bodies[b].rebuilds = movers[b].rebuilds();
      result.bodies[b].strain_since_build = movers[b].steepest();
    }
  };
  record(0);
  progress.begin("elastic", steps);
  for (std::uint64_t step = 1; step <= steps; ++step) {
    for (std::size_t b = 0; b < movers.size(); ++b) {
      if (auto done = movers[b].advance(); !done) {
        result.converged = false;
        result.stopped_why = fmt::format("{}: {}", scene.bodies[b].name, describe(done.error()));
        result.steps = step;
        record(step - 1);
        count_rebuilds();
        return std::nullopt;
      }
    }
    result.steps = step;
    if (step % every == 0 || step == steps) record(step);
    compare(step);
    progress.advance();
  }
  count_rebuilds();
  for (std::size_t b = 0; b < movers.size(); ++b) {
    BodyResult& body = result.bodies[b];
    body.no_estimate = none.empty() ? untold(movers[b]) : none;
    if (body.no_estimate.empty() && moved[b] > 0) {
      const ErrorEstimate estimate = estimate_from(first[b] / moved[b], last[b] / moved[b], Course::moving);
      body.error = estimate.error;
      body.no_estimate = estimate.why_not;
    }
    if (!time.rebuild && movers[b].free && movers[b].free->relative_deformation() > 1e-2) {
      result.notes.push_back(
          fmt::format("{} is deformed by more than a hundredth of its size: the linear operator is at its limit",
                      scene.bodies[b].name));
    }
  }
  return std::nullopt;
}

}  // namespace cleave::scene
