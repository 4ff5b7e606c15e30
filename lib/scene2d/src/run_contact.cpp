#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "body_runs.hpp"
#include "cleave/dbem/world.hpp"
#include "cleave/scene2d/contact.hpp"
#include "contact_bodies.hpp"
#include "contact_estimate.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;

constexpr std::size_t most_rows = 2000;  // of the history
constexpr double rest_criterion = 1e-7;  // unbalanced force over weight
constexpr std::uint64_t most_rest_steps = 20000;
constexpr double strain_too_large = 0.1;  // for bodies whose shape is that of the start

/// By how much all stress may grow together: Mohr and Coulomb on the largest and smallest principal stress, and the
/// tension cut-off.
double safety_of(const std::array<double, 3>& principal, const RockStrength& strength) {
  const double friction = strength.friction * std::numbers::pi / 180;
  const double shear = 0.5 * (principal[0] - principal[2]), pressure = -0.5 * (principal[0] + principal[2]);
  const double driving = shear - pressure * std::sin(friction);
  double out = most_safety;
  if (driving > 0) out = std::min(out, strength.cohesion * std::cos(friction) / driving);
  if (principal[0] > 0) out = std::min(out, strength.tension / principal[0]);
  return out;
}

/// Follows a run and writes down what is asked for.
class Recorder final {
 public:
  Recorder(const ContactScene& scene, const PreparedBodies& prepared, const dbem::World& world, ContactResult& result)
      : scene_{scene}, prepared_{prepared}, world_{world}, result_{result} {
    result.points = scene.points;
    for (const PointSpec& point : scene.points) local_.push_back(point.at - prepared.bodies[point.body].origin);
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      ContactBodyResult body;
      body.name = scene.bodies[b].name;
      body.fixed = scene.bodies[b].fixed || (scene.bodies[b].clamped() && prepared.elements[b] == 0);
      body.elastic = prepared.elements[b] > 0;
      const std::size_t modes = prepared.bodies[b].modes ? prepared.bodies[b].modes->omega.size() : 0;
      body.freedoms = (body.fixed || scene.bodies[b].clamped() ? 0U : 3U) + modes;
      body.start = body.centroid = world.centroid(b);
      body.outline = world.outline(b);
      result.bodies.push_back(std::move(body));
    }
    const dbem::Energy& energy = world.energy();
    gravity_ = energy.potential;
    lowest_ = energy.total() - energy.work;
    momentum_ = world.momentum();
    angular_ = world.angular_momentum();
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const ContactBody& body = scene.bodies[b];
      if (body.fixed || body.clamped()) {
        grounded_ = true;
        continue;
      }
      weight_ += world.mass(b) * scene.settings.gravity;
      loaded_ = loaded_ || !body.loads.empty();
    }
    loaded_ = loaded_ || scene.settings.ground.has_value();
    for (std::size_t m = 0; m < shares_.size(); ++m) shares_[m] = 0;
  }

  [[nodiscard]] bool something_hit() const { return hit_; }

  void step(const dbem::StepReport& report) {
    ++result_.steps;
    hit_ = hit_ || report.impact;
    result_.cut_steps += report.cuts;
    result_.end_time = report.time;
    result_.residual = std::max(result_.residual, report.residual);
    result_.largest_penetration = std::max(result_.largest_penetration, report.max_penetration);
    result_.iterations += report.iterations;
    result_.work += report.work;
    for (std::size_t m = 0; m < shares_.size(); ++m) {
      shares_[m] += report.solved_by[m];
      solves_[m] += report.solves_by[m];
    }
    const dbem::Energy& energy = world_.energy();
    const double own = energy.total() - energy.work;
    result_.energy_gain = std::max(result_.energy_gain, own - lowest_);
    lowest_ = std::min(lowest_, own);
    if (scene_.settings.to_rest || loaded_) return;
    // Momentum comes from weight and from what does not move, and from nowhere else.
    Vec2 from_ground;
    for (const dbem::Contact& contact : world_.contacts()) {
      const bool first = result_.bodies[contact.vertex_body].fixed, second = result_.bodies[contact.edge_body].fixed;
      if (first == second) continue;
      from_ground += (second ? 1.0 : -1.0) * force_of(contact);
    }
    expected_ += report.step * (weight_ + from_ground);
    scale_ = std::max(scale_, norm(report.step * weight_) + norm(world_.momentum()));
    const bool clamped = std::ranges::any_of(scene_.bodies, &ContactBody::clamped);
    if (!clamped && scale_ > 0) {
      result_.drift_momentum =
          std::max(result_.drift_momentum, norm(world_.momentum() - momentum_ - expected_) / scale_);
    }
    if (!grounded_ && scene_.settings.gravity == Vec2{}) {
      const double now = world_.angular_momentum();
      const double size = std::max(std::abs(angular_), std::abs(now));
      if (size > 0) result_.drift_angular = std::max(result_.drift_angular, std::abs(now - angular_) / size);
    }
  }

  void row(const dbem::StepReport& report) {
    const dbem::Energy& energy = world_.energy();
    ContactHistory row;
    row.time = report.time;
    row.step = report.step;
    row.kinetic = energy.kinetic;
    row.elastic = energy.elastic;
    row.gravity = energy.potential - gravity_;
    row.work = energy.work;
    row.friction = energy.friction;
    row.lost = energy.lost;
    row.residual = report.residual;
    // Those of sleeping bodies carry on, though no step solves them.
    for (const dbem::Contact& contact : world_.contacts()) {
      ++row.contacts;
      row.sticking += contact.state == dbem::ContactState::stick ? 1U : 0U;
      row.slipping += contact.state == dbem::ContactState::slip ? 1U : 0U;
    }
    row.iterations = report.iterations;
    row.points = displacements();
    result_.history.push_back(std::move(row));
  }

  void frame(double time) {
    ContactFrame frame;
    frame.time = time;
    frame.corners.resize(result_.bodies.size());
    frame.stress.resize(result_.bodies.size());
    for (std::size_t b = 0; b < result_.bodies.size(); ++b) {
      ContactBodyResult& body = result_.bodies[b];
      body.centroid = body.start + world_.displacement(b);
      body.rotation = world_.rotation(b);
      frame.places.push_back({body.centroid, body.rotation});
      if (body.fixed) continue;
      const auto corners = world_.outline(b);
      for (std::size_t k = 0; k < corners.size(); ++k) {
        body.largest = std::max(body.largest, norm(corners[k] - body.outline[k]));
      }
      result_.largest_displacement = std::max(result_.largest_displacement, body.largest);
      if (body.elastic) frame.corners[b] = corners;
      if (body.elastic && (scene_.output.vtu || scene_.output.csv)) frame.stress[b] = stress_of(b);
    }
    for (const dbem::Contact& contact : world_.contacts()) {
      if (contact.state == dbem::ContactState::open) continue;
      frame.contacts.push_back(
          {contact.point, force_of(contact), contact.vertex_body, contact.edge_body,
           contact.state == dbem::ContactState::slip ? ContactMarkState::slip : ContactMarkState::stick});
    }
    frame.points = displacements();
    result_.frames.push_back(std::move(frame));
  }

  void finish() {
    for (ContactBodyResult& body : result_.bodies) body.force = {};
    for (const dbem::Contact& contact : world_.contacts()) {
      result_.bodies[contact.vertex_body].force += force_of(contact);
      result_.bodies[contact.edge_body].force -= force_of(contact);
    }
    for (std::size_t m = 0; m < shares_.size(); ++m) {
      if (shares_[m] > 0) {
        result_.solvers.push_back({std::string{dbem::name_of(static_cast<dbem::Method>(m))}, shares_[m], solves_[m]});
      }
    }
  }

 private:
  [[nodiscard]] static Vec2 force_of(const dbem::Contact& contact) {
    return contact.normal_force * contact.normal + contact.tangential_force * turned_left(contact.normal);
  }
  [[nodiscard]] std::vector<Vec2> displacements() const {
    std::vector<Vec2> out;
    for (std::size_t p = 0; p < local_.size(); ++p) {
      out.push_back(world_.position(scene_.points[p].body, local_[p]) - scene_.points[p].at);
    }
    return out;
  }

  /// At the corners of an elastic body.
  [[nodiscard]] std::vector<NodeStress> stress_of(std::size_t body) const {
    const PreparedBodies::OwnStress own = *prepared_.stress[body];
    const PreparedBodies::StressOfModes& shape = prepared_.shapes[own.shape];
    const std::vector<double> amplitudes = world_.modal_amplitudes(body);
    std::vector<NodeStress> out(amplitudes.empty() ? 0 : shape.values.size() / amplitudes.size());
    for (std::size_t v = 0; v < out.size(); ++v) {
      bem::Sym2 sum;
      for (std::size_t m = 0; m < amplitudes.size(); ++m)
        sum += amplitudes[m] * shape.values[v * amplitudes.size() + m];
      NodeStress& node = out[v];
      const bem::Sym2 locked = prepared_.locked[body];
      node.stress = in_world(sum, own.angle + world_.rotation(body)) + in_world(locked, world_.rotation(body));
      node.out_of_plane = shape.poisson * (sum.xx + sum.yy + locked.xx + locked.yy);
      node.von_mises = von_mises(node.stress, node.out_of_plane);
      if (scene_.settings.strength) {
        node.safety = safety_of(principal(node.stress, node.out_of_plane), *scene_.settings.strength);
      }
    }
    return out;
  }

  const ContactScene& scene_;
  const PreparedBodies& prepared_;
  const dbem::World& world_;
  ContactResult& result_;
  std::vector<Vec2> local_;
  dbem::PerMethod<std::uint64_t> shares_{};
  dbem::PerMethod<std::uint64_t> solves_{};
  double gravity_ = 0, lowest_ = 0, angular_ = 0, scale_ = 0;
  Vec2 momentum_, expected_, weight_;
  bool grounded_ = false, loaded_ = false, hit_ = false;
};

/// Whether a run has taken all the work it may; it stops there.
bool out_of_work(const ContactSettings& settings, ContactResult& result) {
  if (result.work < settings.work) return false;
  result.converged = false;
  result.stopped_why = fmt::format("the run has taken the {:.6g} x 10^9 operations of contact.work at {:.6g} s",
                                   1e-9 * settings.work, result.end_time);
  return true;
}

/// Steps of given lengths until the time is over.
void follow(const ContactScene& scene, dbem::World& world, Recorder& recorder, ContactResult& result,
            Progress& progress) {
  const ContactSettings& s = scene.settings;
  const double expected = s.duration / s.step;
  const auto every = static_cast<std::uint64_t>(std::max(1.0, std::ceil(expected / most_rows)));
  const double picture = s.duration / static_cast<double>(s.frames);
  std::size_t pictures = 1;
  constexpr std::uint64_t pieces = 1000;
  std::uint64_t done = 0;
  progress.begin("contact", pieces);
  dbem::StepReport last;
  double next = s.step;
  while (world.time() < s.duration * (1 - 1e-12)) {
    const double left = s.duration - world.time();
    // The last steps end the run on time; none of them is a sliver.
    auto report = world.step(left < next * (1 + 1e-9) ? left : left < 2 * next ? left / 2 : left);
    if (!report) {
      result.converged = false;
      result.stopped_why = describe(report.error());
      break;
    }
    recorder.step(*report);
    if (report->cuts == 0 && report->shortened == 0) next = std::max(next, report->step);
    last = *report;
    const bool end = world.time() >= s.duration * (1 - 1e-12);
    if (result.steps % every == 0 || end) recorder.row(*report);
    if (world.time() >= static_cast<double>(pictures) * picture * (1 - 1e-9) || end) {
      recorder.frame(world.time());
      while (static_cast<double>(pictures) * picture * (1 - 1e-9) <= world.time()) ++pictures;
    }
    const auto now = static_cast<std::uint64_t>(static_cast<double>(pieces) * std::min(1.0, world.time() / s.duration));
    if (now > done) progress.advance(now - done);
    done = std::max(done, now);
    if (!end && out_of_work(s, result)) break;
  }
  if (!result.converged) {
    // The state at which it stopped is kept.
    recorder.row(last);
    recorder.frame(world.time());
  }
}

/// Implicit steps, each from rest, until nothing gains speed.
void relax(const ContactScene& scene, dbem::World& world, Recorder& recorder, ContactResult& result,
           Progress& progress) {
  const ContactSettings& s = scene.settings;
  progress.begin("contact");
  double unbalanced = 1;
  std::uint64_t next_picture = 1;
  while (result.steps < most_rest_steps && world.time() < s.duration) {
    auto report = world.step();
    if (!report) {
      result.converged = false;
      result.stopped_why = describe(report.error());
      recorder.frame(world.time());
      return;
    }
    recorder.step(*report);
    recorder.row(*report);
    unbalanced = report->unbalanced;
    if (result.steps == next_picture) {
      recorder.frame(world.time());
      next_picture += 1 + next_picture / 4;
    }
    progress.advance();
    if (unbalanced <= rest_criterion) {
      recorder.frame(world.time());
      return;
    }
    if (out_of_work(s, result)) {
      recorder.frame(world.time());
      return;
    }
  }
  recorder.frame(world.time());
  result.converged = false;
  result.stopped_why = fmt::format(
      "the bodies did not come to rest in {} steps: the largest unbalanced force is {:.2g} of the weight (asked: "
      "{:.0e}); there may be no equilibrium",
      result.steps, unbalanced, rest_criterion);
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
                                                       Progress& progress) {
  ContactResult result;
  static_cast<ResultHead&>(result) = head_of(scene, make_plan(scene));
  const RigidityChoice rigidity = rigidity_of(scene);
  result.elastic = rigidity.elastic;
  result.to_rest = scene.settings.to_rest;
  for (const Problem& note : scene.notes) result.notes.push_back(describe(note));
  if (rigidity.elastic && rigidity.strain > strain_too_large) {
    result.notes.push_back(
        fmt::format("strains may reach {:.1g}, but elastic bodies are computed for small ones: is young in Pa and "
                    "density in kg/m3?",
                    rigidity.strain));
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
    options.overlap = 2e-5;  // the scene's own check is stricter
    options.quasi_static = s.to_rest;
    options.adaptive = s.to_rest || s.max_step > s.step;
    options.solver.method = s.solver;
    auto world = dbem::World::make(prepared->bodies, laws_of(scene), options);
    if (!world) {
      return std::vector{Problem{scene.shown, 1, "contact", describe(world.error()), "change the bodies it names"}};
    }
    if (result.elastic) {
      result.notes.push_back(fmt::format("{} elastic {} of {} bodies: those alike share one", prepared->operators,
                                         prepared->operators == 1 ? "operator" : "operators", scene.bodies.size()));
    }
    Recorder recorder{scene, *prepared, *world, result};
    dbem::StepReport start;
    recorder.row(start);
    recorder.frame(0);
    if (s.to_rest) {
      relax(scene, *world, recorder, result, progress);
    } else {
      follow(scene, *world, recorder, result, progress);
    }
    recorder.finish();
    const auto with = [&](double longer) -> std::optional<dbem::World> {
      dbem::WorldOptions long_steps = options;
      for (double* bound : {&long_steps.step, &long_steps.displacement, &long_steps.rotation}) *bound *= longer;
      if (long_steps.longest_step) *long_steps.longest_step *= longer;
      auto other = dbem::World::make(prepared->bodies, laws_of(scene), long_steps);
      return other ? std::optional{*std::move(other)} : std::nullopt;
    };
    estimate_steps(scene, with, *world, recorder.something_hit(), result);
    return std::nullopt;
  });
  progress.end();
  if (wrong) return std::unexpected(*std::move(wrong));
  result.cost = cost_of(timer, threads);
  return result;
}

}  // namespace cleave::scene
