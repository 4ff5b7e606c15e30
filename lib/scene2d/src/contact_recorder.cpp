#include "contact_recorder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "body_runs.hpp"
#include "contact_parts.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;

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

Vec2 force_of(const dbem::Contact& contact) {
  return contact.normal_force * contact.normal + contact.tangential_force * turned_left(contact.normal);
}

}  // namespace

Recorder::Recorder(const ContactScene& scene, const PreparedBodies& prepared, const dbem::World& world,
                   ContactResult& result)
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
    body.size = size_of(body.outline);
    result.bodies.push_back(std::move(body));
  }
  carriers_ = carriers_of(scene, result.bodies);
  const dbem::Energy& energy = world.energy();
  gravity_ = energy.potential;
  tally_.lowest = energy.total() - energy.work;
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
  loaded_ = loaded_ || scene.settings.ground.has_value() || !scene.bolts.empty();
  tally_.largest.assign(world.ties().size(), 0.0);
  tally_.broken_at.resize(world.ties().size());
  for (const dbem::Tie& tie : ties_of(scene)) capacities_.push_back(tie.capacity.si());
}

void Recorder::step(const dbem::StepReport& report) {
  ++result_.steps;
  tally_.hit = tally_.hit || report.impact || report.slip_turned;
  result_.cut_steps += report.cuts;
  result_.end_time = report.time;
  result_.residual = std::max(result_.residual, report.residual);
  result_.largest_penetration = std::max(result_.largest_penetration, report.max_penetration);
  result_.iterations += report.iterations;
  result_.work += report.work;
  for (std::size_t m = 0; m < tally_.shares.size(); ++m) {
    tally_.shares[m] += report.solved_by[m];
    tally_.solves[m] += report.solves_by[m];
  }
  const std::vector<dbem::TieState> ties = world_.ties();
  for (std::size_t k = 0; k < ties.size(); ++k) {
    tally_.largest[k] = std::max(tally_.largest[k], ties[k].force.si());
    if (!ties[k].broken || tally_.broken_at[k]) continue;
    tally_.broken_at[k] = report.time;
    // It carried that on its way there, within the step.
    tally_.largest[k] = std::max(tally_.largest[k], capacities_[k]);
  }
  bodies_moved(report.time);
  const dbem::Energy& energy = world_.energy();
  const double own = energy.total() - energy.work;
  result_.energy_gain = std::max(result_.energy_gain, own - tally_.lowest);
  tally_.lowest = std::min(tally_.lowest, own);
  if (scene_.settings.to_rest || loaded_) return;
  // Momentum comes from weight and from what does not move, and from nowhere else.
  Vec2 from_ground;
  for (const dbem::Contact& contact : world_.contacts()) {
    const bool first = result_.bodies[contact.vertex_body].fixed, second = result_.bodies[contact.edge_body].fixed;
    if (first == second) continue;
    from_ground += (second ? 1.0 : -1.0) * force_of(contact);
  }
  tally_.expected += report.step * (weight_ + from_ground);
  tally_.scale = std::max(tally_.scale, norm(report.step * weight_) + norm(world_.momentum()));
  const bool clamped = std::ranges::any_of(scene_.bodies, &ContactBody::clamped);
  if (!clamped && tally_.scale > 0) {
    result_.drift_momentum =
        std::max(result_.drift_momentum, norm(world_.momentum() - momentum_ - tally_.expected) / tally_.scale);
  }
  if (!grounded_ && scene_.settings.gravity == Vec2{}) {
    const double now = world_.angular_momentum();
    const double size = std::max(std::abs(angular_), std::abs(now));
    if (size > 0) result_.drift_angular = std::max(result_.drift_angular, std::abs(now - angular_) / size);
  }
}

Recorder::Places Recorder::places() const {
  Places out;
  for (std::size_t b = 0; b < result_.bodies.size(); ++b) {
    out.now.push_back({result_.bodies[b].start + world_.displacement(b), world_.rotation(b)});
  }
  out.own = out.now;
  for (std::uint32_t b = 0; b < out.own.size(); ++b) {
    out.own[b].centroid -= carried_by(carriers_[b], b, out.now, result_.bodies);
  }
  return out;
}

void Recorder::bodies_moved(double time) {
  touching_.assign(result_.bodies.size(), 0);
  for (const dbem::Contact& contact : world_.contacts()) {
    if (contact.state != dbem::ContactState::open) touching_[contact.vertex_body] = touching_[contact.edge_body] = 1;
  }
  const Places places = this->places();
  for (std::size_t b = 0; b < result_.bodies.size(); ++b) {
    ContactBodyResult& body = result_.bodies[b];
    if (body.fixed || world_.asleep(b)) continue;
    note_step(body, Time::from_si(time), places.own[b], touching_[b] != 0);
    if (body.elastic) {
      const std::vector<Vec2> corners = world_.outline(b);
      for (std::size_t k = 0; k < corners.size(); ++k) {
        body.largest = std::max(body.largest, norm(corners[k] - body.outline[k]));
      }
    } else {
      for (const Vec2 p : body.outline) {
        const Vec2 arm = p - body.start;
        body.largest =
            std::max(body.largest, norm(world_.displacement(b) + rotated(arm, places.now[b].rotation) - arm));
      }
    }
    result_.largest_displacement = std::max(result_.largest_displacement, body.largest);
  }
  if (!scene_.settings.to_rest) tally_.trail.note(time, result_.bodies, places.own);
}

void Recorder::row(const dbem::StepReport& report) {
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
  row.bolts = energy.yielded;
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

void Recorder::frame(double time) {
  ContactFrame frame;
  frame.time = time;
  frame.corners.resize(result_.bodies.size());
  frame.stress.resize(result_.bodies.size());
  for (std::size_t b = 0; b < result_.bodies.size(); ++b) {
    ContactBodyResult& body = result_.bodies[b];
    body.centroid = body.start + world_.displacement(b);
    body.rotation = world_.rotation(b);
    frame.places.push_back({body.centroid, body.rotation});
    if (body.fixed || !body.elastic) continue;
    frame.corners[b] = world_.outline(b);
    if (scene_.output.vtu || scene_.output.csv) frame.stress[b] = stress_of(b);
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

void Recorder::finish() {
  const Places places = this->places();
  for (std::size_t b = 0; b < result_.bodies.size(); ++b) {
    result_.bodies[b].force = {};
    result_.bodies[b].carried = places.now[b].centroid - places.own[b].centroid;
  }
  for (const dbem::Contact& contact : world_.contacts()) {
    result_.bodies[contact.vertex_body].force += force_of(contact);
    result_.bodies[contact.edge_body].force -= force_of(contact);
  }
  for (std::size_t b = 0; b < result_.bodies.size(); ++b) {
    ContactBodyResult& body = result_.bodies[b];
    if (body.fixed || world_.asleep(b) || scene_.settings.to_rest) continue;
    // Against the support that it moves past the fastest.
    double along = carriers_[b].empty() ? norm(world_.velocity(b)) : 0;
    for (const std::uint32_t support : carriers_[b]) {
      along = std::max(along, norm(world_.velocity(b) - world_.velocity(support)));
    }
    const double speed = along + std::abs(world_.spin(b)) * body.size.si() / 2;
    body.goes_on = tally_.trail.goes_on(b, body.size.si(), speed, result_.end_time);
  }
  finish_bolts();
  for (std::size_t m = 0; m < tally_.shares.size(); ++m) {
    if (tally_.shares[m] > 0) {
      result_.solvers.push_back(
          {std::string{dbem::name_of(static_cast<dbem::Method>(m))}, tally_.shares[m], tally_.solves[m]});
    }
  }
}

void Recorder::finish_bolts() {
  const std::vector<dbem::TieState> ties = world_.ties();
  std::size_t at = 0;
  for (const ContactBolt& bolt : scene_.bolts) {
    const auto of_one = [&](double per_metre) { return Force::from_si(per_metre * bolt.spacing.si()); };
    for (const BoltBar& bar : bars_of(scene_.bodies, bolt)) {
      const dbem::TieState& tie = ties[at];
      ContactBoltResult out;
      out.name = bolt.name;
      out.first = scene_.bodies[bar.first].name;
      out.second = scene_.bodies[bar.second].name;
      out.state = tie.broken           ? BoltState::broken
                  : !tie.installed     ? BoltState::absent
                  : tie.yielding       ? BoltState::yields
                  : tie.force.si() > 0 ? BoltState::holds
                                       : BoltState::slack;
      out.force = of_one(tie.force.si());
      out.largest = of_one(tally_.largest[at]);
      out.capacity = of_one(bar.capacity.si());
      out.lengthened = tie.plastic;
      if (tally_.broken_at[at]) out.broken_at = Time::from_si(*tally_.broken_at[at]);
      result_.bolts.push_back(std::move(out));
      ++at;
    }
  }
}

std::vector<Vec2> Recorder::displacements() const {
  std::vector<Vec2> out;
  for (std::size_t p = 0; p < local_.size(); ++p) {
    out.push_back(world_.position(scene_.points[p].body, local_[p]) - scene_.points[p].at);
  }
  return out;
}

std::vector<NodeStress> Recorder::stress_of(std::size_t body) const {
  const PreparedBodies::OwnStress own = *prepared_.stress[body];
  const PreparedBodies::StressOfModes& shape = prepared_.shapes[own.shape];
  const std::vector<double> amplitudes = world_.modal_amplitudes(body);
  std::vector<NodeStress> out(amplitudes.empty() ? 0 : shape.values.size() / amplitudes.size());
  for (std::size_t v = 0; v < out.size(); ++v) {
    bem::Sym2 sum;
    for (std::size_t m = 0; m < amplitudes.size(); ++m) sum += amplitudes[m] * shape.values[v * amplitudes.size() + m];
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

}  // namespace cleave::scene
