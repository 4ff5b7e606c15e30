#include "cleave/dbem/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "cleave/bem/problem.hpp"
#include "cleave/core/overloaded.hpp"
#include "world_impl.hpp"

namespace cleave::dbem {

std::string describe(const WorldError& error) {
  return std::visit(
      overloaded{
          [](const BadOutline& e) { return fmt::format("body '{}': outline: {}", e.body, e.reason); },
          [](const NoMass& e) {
            return fmt::format("body '{}' can move but has no mass: give a density, or mass and inertia, or fix it",
                               e.body);
          },
          [](const BadModes& e) { return fmt::format("body '{}': elastic shapes: {}", e.body, e.reason); },
          [](const BadForce& e) { return fmt::format("body '{}': force: {}", e.body, e.reason); },
          [](const BadLaw& e) { return fmt::format("joint law: {}", e.reason); },
          [](const BadTie& e) { return fmt::format("bolt '{}': {}", e.tie, e.reason); },
          [](const BadOption& e) { return fmt::format("contact option: {}", e.reason); },
          [](const BodiesOverlap& e) {
            return fmt::format("bodies '{}' and '{}' overlap at the start: {:.6g} m deep at ({:.9g}, {:.9g})", e.a, e.b,
                               e.depth, e.at.x, e.at.y);
          },
      },
      error);
}

std::string describe(const StepError& error) {
  return std::visit(overloaded{[](const StepFailed& e) {
                      return fmt::format(
                          "no step from t = {:.9g} s on: {} (shortest step tried {:.3g} s, residual {:.3g})", e.time,
                          e.reason, e.step, e.residual);
                    }},
                    error);
}

namespace {

bool good(double x) { return std::isfinite(x); }
bool good(Vec2 v) { return std::isfinite(v.x) && std::isfinite(v.y); }

std::optional<WorldError> check_law(const JointLaw& law) {
  if (!good(law.friction) || law.friction < 0)
    return BadLaw{fmt::format("friction {} is not at least 0", law.friction)};
  if (!good(law.cohesion) || law.cohesion < 0)
    return BadLaw{fmt::format("cohesion {} is not at least 0", law.cohesion)};
  if (!good(law.tension) || law.tension < 0) return BadLaw{fmt::format("tension {} is not at least 0", law.tension)};
  if (!good(law.compliance) || law.compliance < 0) {
    return BadLaw{fmt::format("compliance {} is not at least 0", law.compliance)};
  }
  for (const std::optional<double>& stiffness : {law.normal_stiffness, law.shear_stiffness}) {
    if (!stiffness) continue;
    if (!good(*stiffness) || *stiffness <= 0) return BadLaw{fmt::format("stiffness {} is not above 0", *stiffness)};
    if (law.compliance > 0) return BadLaw{"both a stiffness and a compliance"};
  }
  if (!(law.restitution >= 0 && law.restitution <= 1)) {
    return BadLaw{fmt::format("restitution {} is not between 0 and 1", law.restitution)};
  }
  if (!good(law.water_pressure.si()) || law.water_pressure < Stress{}) {
    return BadLaw{fmt::format("water pressure of {} Pa is not at least 0", law.water_pressure.si())};
  }
  if (law.water_table && !good(law.water_table->si())) return BadLaw{"the height of the water is not a number"};
  const double least = std::min(law.friction, law.residual_friction.value_or(law.friction));
  if (!(law.dilation >= 0 && law.dilation <= least)) {
    return BadLaw{fmt::format("dilation {} is not between 0 and the friction, residual or not", law.dilation)};
  }
  if (law.dilation > 0 && !(good(law.dilation_slip.si()) && law.dilation_slip > Length{})) {
    return BadLaw{fmt::format("dilation over a slip of {} m", law.dilation_slip.si())};
  }
  if (!(law.residual_cohesion >= 0 && law.residual_cohesion <= law.cohesion)) {
    return BadLaw{fmt::format("residual cohesion {} is not between 0 and the cohesion", law.residual_cohesion)};
  }
  if (law.residual_friction && !(good(*law.residual_friction) && *law.residual_friction >= 0))
    return BadLaw{"residual friction is not a number"};
  return std::nullopt;
}

std::optional<WorldError> check_options(const WorldOptions& o) {
  if (!good(o.gravity)) return BadOption{"gravity is not finite"};
  if (!good(o.step) || o.step <= 0) return BadOption{fmt::format("step {} s is not positive", o.step)};
  if (o.longest_step && !(good(*o.longest_step) && *o.longest_step > 0)) {
    return BadOption{fmt::format("longest step {} s is not above 0", *o.longest_step)};
  }
  if (!(o.sleep_speed >= 0)) return BadOption{"the speed below which bodies sleep must not be negative"};
  if (!good(o.solver.accept)) return BadOption{"the accepted residual is not a number"};
  if (!(o.displacement > 0) || !(o.rotation > 0)) return BadOption{"displacement and rotation limits must be positive"};
  if ((o.position_error && !(*o.position_error > 0)) || !(o.overlap >= 0) || !(o.overlap_elastic >= 0) ||
      !(o.overlap_at_start >= 0))
    return BadOption{"tolerances must not be negative"};
  if (!(o.step_work > 0)) return BadOption{"the work of a step must be positive"};
  if (!good(o.mass_damping) || o.mass_damping < 0) {
    return BadOption{fmt::format("damping of {} /s is no rate at which motion is lost", o.mass_damping)};
  }
  if (!(o.regularisation >= 0)) return BadOption{"regularisation must not be negative"};
  return std::nullopt;
}

/// Shortest distance of a corner to an edge it does not end.
double smallest_feature(const std::vector<Vec2>& c) {
  const std::size_t n = c.size();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t e = 0; e < n; ++e) {
      if (e == k || (e + 1) % n == k) continue;
      const Vec2 along = c[(e + 1) % n] - c[e];
      const double t = std::clamp(dot(c[k] - c[e], along) / dot(along, along), 0.0, 1.0);
      least = std::min(least, norm(c[k] - c[e] - t * along));
    }
  }
  return least;
}

std::optional<WorldError> check_modes(const Body& body, std::size_t corners) {
  const std::size_t modes = body.modes->omega.size();
  if (body.modes->shapes.size() != 2 * corners * modes) {
    return BadModes{body.name, fmt::format("{} numbers instead of 2 x {} corners x {} modes", body.modes->shapes.size(),
                                           corners, modes)};
  }
  for (const double w : body.modes->omega) {
    if (!good(w) || w <= 0) return BadModes{body.name, fmt::format("frequency {} is not positive", w)};
  }
  if (!std::ranges::all_of(body.modes->shapes, [](double x) { return good(x); })) {
    return BadModes{body.name, "not finite"};
  }
  if (!(body.modes->damping >= 0)) return BadModes{body.name, "damping is negative"};
  const std::vector<double>& stretch = body.modes->stretch;
  if (!stretch.empty() &&
      (stretch.size() != modes || !std::ranges::all_of(stretch, [](double x) { return good(x); }))) {
    return BadModes{body.name, fmt::format("not one finite number for the stretch of each of {} modes", modes)};
  }
  return std::nullopt;
}

std::optional<WorldError> make_shape(const Body& body, Shape& shape) {
  const std::vector<Vec2>& c = body.outline;
  const std::size_t n = c.size();
  if (!good(body.origin) || !good(body.velocity) || !good(body.spin)) {
    return BadOutline{body.name, "origin, velocity and spin must be finite"};
  }
  const auto checked = bem::check_loops({bem::polygon(c)}, false);
  if (!checked) return BadOutline{body.name, bem::describe(checked.error())};
  if (!checked->turned.empty()) return BadOutline{body.name, "corners run clockwise; state them counter-clockwise"};
  const PolygonMoments moments = polygon_moments(c);
  shape.local_centroid = moments.centroid;
  double perimeter = 0;
  for (std::size_t k = 0; k < n; ++k) {
    shape.corners.push_back(c[k] - moments.centroid);
    shape.radius = std::max(shape.radius, norm(shape.corners.back()));
    perimeter += norm(c[(k + 1) % n] - c[k]);
  }
  shape.modes = body.modes ? body.modes->omega.size() : 0;
  shape.stretches = body.modes && !body.modes->stretch.empty();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2 in = shape.corners[k] - shape.corners[(k + n - 1) % n];
    const Vec2 out = shape.corners[(k + 1) % n] - shape.corners[k];
    const double turned = cross(in, out) / (norm(in) * norm(out));
    if (turned < -1e-9) shape.convex = false;
    // A corner of half a turn carries something only in a body that can bend there.
    const bool straight = std::abs(turned) <= 1e-9 && dot(in, out) > 0;
    shape.sharp.push_back(turned > 1e-9 || (straight && shape.modes > 0) ? 1 : 0);
  }
  shape.feature = smallest_feature(shape.corners);
  if (!(shape.feature > 1e-9 * perimeter)) return BadOutline{body.name, "thinner than 1e-9 of its perimeter"};
  shape.fixed = body.held.all() && shape.modes == 0;
  if (body.moves && !shape.fixed) return BadOutline{body.name, "it moves by a function of time, but is not fixed"};
  shape.timed = !body.forces.empty();
  const double density = body.density;
  shape.mass = body.mass.value_or(density * moments.area);
  shape.inertia = body.inertia.value_or(moments.area > 0 ? shape.mass * moments.polar / moments.area : 0.0);
  if (!body.held.all()) {
    if (!good(shape.mass) || shape.mass <= 0 || !good(shape.inertia) || shape.inertia <= 0) return NoMass{body.name};
    shape.inverse_x = body.held.x ? 0 : 1 / shape.mass;
    shape.inverse_y = body.held.y ? 0 : 1 / shape.mass;
    shape.inverse_spin = body.held.spin ? 0 : 1 / shape.inertia;
  }
  if (!body.properties.empty() && body.properties.size() != n) {
    return BadOutline{body.name, fmt::format("{} joint properties for {} edges", body.properties.size(), n)};
  }
  const auto is_share = [](double share) { return share >= 0 && share <= 1; };
  if (!body.shares.empty() && (body.shares.size() != n || !std::ranges::all_of(body.shares, is_share))) {
    return BadOutline{body.name, fmt::format("not one share from 0 to 1 for each of {} edges", n)};
  }
  for (const PointForce& force : body.forces) {
    if (!good(force.at) || !good(force.force)) return BadForce{body.name, "place and force must be finite"};
    const BoundaryPoint at = nearest_on(shape.corners, force.at - shape.local_centroid);
    shape.load_places.push_back({at.edge, at.share});
  }
  return body.modes ? check_modes(body, n) : std::nullopt;
}

std::optional<WorldError> find_overlap(World::Impl& w) {
  std::vector<Box2> boxes = w.boxes;
  const std::vector<std::uint8_t> lazy(w.size(), 0);
  for (const auto [a, b] : overlapping_pairs(boxes, lazy)) {
    const double size = std::min(w.shapes[a].feature, w.shapes[b].feature);
    if (w.shapes[a].fixed && w.shapes[b].fixed) continue;  // parts of one support may share space
    const Overlap found =
        overlap(w.placed(w.corners, w.boxes, a), w.placed(w.corners, w.boxes, b), w.options.overlap_at_start * size);
    if (found.depth > 0) return BodiesOverlap{w.bodies[a].name, w.bodies[b].name, found.depth, w.anchor + found.at};
  }
  return std::nullopt;
}

}  // namespace

World::World(std::unique_ptr<Impl> impl) : impl_{std::move(impl)} {}
World::World(const World& other) : impl_{std::make_unique<Impl>(*other.impl_)} {}
World::World(World&& other) noexcept = default;
World& World::operator=(const World& other) {
  if (this != &other) impl_ = std::make_unique<Impl>(*other.impl_);
  return *this;
}
World& World::operator=(World&& other) noexcept = default;
World::~World() = default;

std::expected<World, WorldError> World::make(std::vector<Body> bodies, Laws laws, WorldOptions options,
                                             std::vector<Tie> ties) {
  if (auto bad = check_law(laws.otherwise)) return std::unexpected(*std::move(bad));
  for (const PairLaw& pair : laws.pairs) {
    if (auto bad = check_law(pair.law)) return std::unexpected(*std::move(bad));
  }
  if (auto bad = check_options(options)) return std::unexpected(*std::move(bad));
  auto impl = std::make_unique<Impl>();
  Impl& w = *impl;
  w.bodies = std::move(bodies);
  w.laws = std::move(laws);
  w.options = std::move(options);
  w.first_corner = w.first_mode = {0};
  for (std::size_t b = 0; b < w.bodies.size(); ++b) {
    Body& body = w.bodies[b];
    if (body.name.empty()) body.name = fmt::format("{}", b + 1);
    Shape shape;
    if (auto bad = make_shape(body, shape)) return std::unexpected(*std::move(bad));
    w.shapes.push_back(std::move(shape));
    w.first_corner.push_back(w.first_corner.back() + body.outline.size());
    w.first_mode.push_back(w.first_mode.back() + w.shapes.back().modes);
  }
  w.place_at_start();
  if (auto bad = find_overlap(w)) return std::unexpected(*std::move(bad));
  w.look(w.next_step);
  w.seen_step = w.next_step;
  w.make_bonds();
  w.make_mated();
  w.make_water();
  w.ties = std::move(ties);
  if (auto bad = w.make_ties()) return std::unexpected(*std::move(bad));
  w.energy.kinetic = w.kinetic_of(w.state);
  w.energy.potential = w.potential_of(w.state);
  w.energy.elastic = w.elastic_of(w.state, w.memory);
  w.start_energy = w.energy.total();
  for (std::size_t b = 0; b < w.size(); ++b) {  // what the first step's change of velocity is compared with
    double torque = 0;
    const Vec2 force = w.force_on(w.state, b, 0, torque, nullptr);
    w.last_change.push_back({w.shapes[b].inverse_x * force.x, w.shapes[b].inverse_y * force.y});
  }
  return World{std::move(impl)};
}

/// What spins clear of all others has the strain of that spin from the start, and does not ring.
void World::Impl::stretch_at_start() {
  for (std::size_t b = 0; b < size(); ++b) {
    if (!shapes[b].stretches || state.spin[b] == 0 || options.quasi_static) continue;
    const auto stretch_by = [&](double square) {
      for (std::size_t m = 0; m < shapes[b].modes; ++m) {
        const double omega = bodies[b].modes->omega[m];
        state.e[first_mode[b] + m] = square * bodies[b].modes->stretch[m] / (omega * omega);
      }
      place_all(state, corners, boxes);
    };
    stretch_by(state.spin[b] * state.spin[b]);
    bool clear = true;
    for (std::size_t other = 0; other < size() && clear; ++other) {
      clear = other == b || !overlap_boxes(boxes[b], boxes[other]);
    }
    if (!clear) stretch_by(0);
  }
}

void World::Impl::place_at_start() {
  const std::size_t n = size();
  // Positions are kept relative to the first body: differences of origins are exact or nearly so.
  if (n > 0) anchor = bodies[0].origin + bodies[0].outline[0];
  for (std::size_t b = 0; b < n; ++b) {
    const Vec2 at = (bodies[b].origin - anchor) + shapes[b].local_centroid;
    // Either origin or outline may carry the large numbers: take them off before they meet the small ones.
    const Vec2 other = bodies[b].origin + (shapes[b].local_centroid - anchor);
    state.x.push_back(norm(bodies[b].origin) > norm(shapes[b].local_centroid) ? at : other);
    state.v.push_back(bodies[b].moves ? bodies[b].moves(0) : bodies[b].velocity);
    state.spin.push_back(bodies[b].spin);
  }
  state.angle.assign(n, 0);
  state.e.assign(first_mode.back(), 0);
  state.de.assign(first_mode.back(), 0);
  start_x = state.x;
  asleep.assign(n, 0);
  calm.assign(n, 0);
  sleep_group.assign(n, 0);
  next_step = options.step;
  place_all(state, corners, boxes);
  stretch_at_start();
  if (n > 0) {
    Box2 all = boxes[0];
    for (const Box2& box : boxes) {
      all.add(box.low);
      all.add(box.high);
    }
    height = std::max(all.high.y - all.low.y, all.high.x - all.low.x);
  }
}

double World::time() const noexcept { return impl_->time; }
std::size_t World::size() const noexcept { return impl_->size(); }
const Body& World::body(std::size_t body) const { return impl_->bodies[body]; }
Vec2 World::centroid(std::size_t body) const { return impl_->anchor + impl_->state.x[body]; }
Vec2 World::displacement(std::size_t body) const { return impl_->state.x[body] - impl_->start_x[body]; }
double World::rotation(std::size_t body) const { return impl_->state.angle[body]; }
Vec2 World::velocity(std::size_t body) const { return impl_->state.v[body]; }
double World::spin(std::size_t body) const { return impl_->state.spin[body]; }
double World::mass(std::size_t body) const { return impl_->shapes[body].mass; }
double World::inertia(std::size_t body) const { return impl_->shapes[body].inertia; }
bool World::asleep(std::size_t body) const { return impl_->asleep[body] != 0; }
const std::vector<Contact>& World::contacts() const noexcept { return impl_->contacts; }
const Energy& World::energy() const noexcept { return impl_->energy; }
std::vector<TieState> World::ties() const {
  std::vector<TieState> out;
  for (const Bar& bar : impl_->bars) {
    out.push_back(
        {ForcePerLength::from_si(bar.force), Length::from_si(bar.plastic), bar.installed, bar.yielding, bar.broken});
  }
  return out;
}
const WorldOptions& World::options() const noexcept { return impl_->options; }

std::vector<double> World::modal_amplitudes(std::size_t body) const {
  const auto& e = impl_->state.e;
  return {e.begin() + static_cast<std::ptrdiff_t>(impl_->first_mode[body]),
          e.begin() + static_cast<std::ptrdiff_t>(impl_->first_mode[body + 1])};
}

std::vector<Vec2> World::outline(std::size_t body) const {
  std::vector<Vec2> out;
  for (const Vec2 c : impl_->corners_of(impl_->corners, body)) out.push_back(impl_->anchor + c);
  return out;
}

Vec2 World::position(std::size_t body, Vec2 local) const {
  const Impl& w = *impl_;
  const Shape& shape = w.shapes[body];
  const Vec2 p = local - shape.local_centroid;
  Vec2 more{};
  if (shape.modes > 0) {
    const BoundaryPoint near = nearest_on(shape.corners, p);
    const std::size_t edge = near.edge;
    const double share = near.share;
    const std::vector<double>& table = w.bodies[body].modes->shapes;
    for (std::size_t m = 0; m < shape.modes; ++m) {
      const double e = w.state.e[w.first_mode[body] + m];
      const auto row = [&](std::size_t corner, std::size_t component) {
        return table[(2 * corner + component) * shape.modes + m];
      };
      const std::size_t to = (edge + 1) % shape.corners.size();
      more +=
          e * Vec2{(1 - share) * row(edge, 0) + share * row(to, 0), (1 - share) * row(edge, 1) + share * row(to, 1)};
    }
  }
  return w.anchor + w.state.x[body] + rotated(p + more, w.state.angle[body]);
}

Vec2 World::momentum() const {
  Vec2 sum{};
  for (std::size_t b = 0; b < size(); ++b) {
    if (!impl_->shapes[b].fixed) sum += impl_->shapes[b].mass * impl_->state.v[b];
  }
  return sum;
}

double World::angular_momentum() const {
  double sum = 0;
  for (std::size_t b = 0; b < size(); ++b) {
    if (impl_->shapes[b].fixed) continue;
    sum += impl_->shapes[b].inertia * impl_->state.spin[b] +
           impl_->shapes[b].mass * cross(impl_->anchor + impl_->state.x[b], impl_->state.v[b]);
  }
  return sum;
}

std::expected<void, WorldError> World::set_velocity(std::size_t body, Vec2 velocity, double spin) {
  Impl& w = *impl_;
  if (body >= w.size()) return std::unexpected(BadOption{fmt::format("there is no body {}", body)});
  if (!good(velocity) || !good(spin)) return std::unexpected(BadOption{"velocity and spin must be finite"});
  w.state.v[body] = velocity;
  w.state.spin[body] = spin;
  std::ranges::fill(w.asleep, std::uint8_t{0});
  std::ranges::fill(w.calm, std::uint16_t{0});
  w.fat.clear();
  w.look(w.next_step);
  const double before = w.energy.kinetic;
  w.energy.kinetic = w.kinetic_of(w.state);
  w.start_energy += w.energy.kinetic - before;
  return {};
}

std::expected<void, WorldError> World::set_step(double step) {
  Impl& w = *impl_;
  if (!good(step) || step <= 0) return std::unexpected(BadOption{fmt::format("step {} s is not positive", step)});
  w.options.step = w.next_step = step;
  w.look(step);
  w.seen_step = step;
  return {};
}

std::vector<ContactProblem> World::problems(double step) const {
  const Impl& w = *impl_;
  if (!good(step) || step <= 0) return {};
  std::vector<ContactCandidate> list = w.touches;
  if (w.seen_step < step) {
    Impl again = w;
    again.look(step);
    list = std::move(again.touches);
  }
  for (const ContactCandidate& bar : w.bars_at(w.state)) list.push_back(bar);
  std::vector<Island> islands = w.islands_of(list);
  std::vector<Rows> rows;
  w.mark_impacts(list, islands, step, std::vector<std::uint8_t>(w.size()), rows);
  std::vector<double> theta(w.size(), 0.5);
  for (const Island& island : islands) {
    for (const std::uint32_t b : island.bodies) theta[b] = island.theta;
  }
  State free = w.state;
  w.free_motion(w.state, theta, step, free);
  std::vector<ContactProblem> problems;
  for (std::size_t k = 0; k < islands.size(); ++k) {
    std::vector<Vec2> viscous;
    problems.push_back(w.problem_of(list, islands[k], rows[k], w.state, free, step, viscous));
    problems.back().start.clear();
    problems.back().yielding.clear();
  }
  return problems;
}

std::expected<Relaxed, StepError> relax(World& world, const RelaxOptions& options) {
  Relaxed done;
  for (done.steps = 0; done.steps < options.most; ++done.steps) {
    const auto report = world.step(options.step);
    if (!report) return std::unexpected(report.error());
    done.unbalanced = report->unbalanced;
    if (report->unbalanced <= options.criterion) {
      done.at_rest = true;
      break;
    }
  }
  return done;
}

}  // namespace cleave::dbem
