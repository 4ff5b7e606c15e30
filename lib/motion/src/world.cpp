#include "cleave/motion/world.hpp"

#include <algorithm>
#include <cmath>

#include "world_impl.hpp"

namespace cleave::motion {
namespace {

Symmetric scaled(const Symmetric& s, double by) {
  return {by * s.xx, by * s.yy, by * s.zz, by * s.xy, by * s.yz, by * s.zx};
}

std::string fault_of(const WorldOptions& o) {
  if (!geometry::is_finite(o.gravity)) return "gravity is not finite";
  if (!(o.step > 0) || !std::isfinite(o.step)) return "the step is not positive";
  if (!(o.theta >= 0.5 && o.theta <= 1)) return "theta is not between 1/2 and 1";
  if (!(o.displacement > 0) || !(o.rotation > 0)) return "the limits of a step are not positive";
  if (!(o.overlap > 0)) return "the overlap allowed is not positive";
  if (o.threads == 0) return "there is no thread";
  const GroundMotion& g = o.ground;
  if (g.mean && (!(g.peak.si() >= 0) || !std::isfinite(g.peak.si()) || !(g.end.si() >= 0)))
    return "the ground has no peak or no end";
  if (g.mean && o.quasi_static) return "the ground moves, but every step starts from rest";
  return {};
}

std::string fault_of(const Bond& bond, std::size_t bodies) {
  if (bond.body >= bodies || bond.other >= bodies || bond.body == bond.other) return "a bond has no two bodies";
  if (!(std::abs(norm(bond.normal) - 1) < 1e-9)) return "the normal of a bond is no unit vector";
  if (!(bond.cohesion >= 0) || !(bond.tension >= 0) || !(bond.friction >= 0)) return "a strength of a bond is negative";
  for (const auto* list : {&bond.shares, &bond.patch}) {
    for (const Bond::Share& s : *list) {
      if (!geometry::is_finite(s.point) || !(s.area >= 0)) return "a share of a bond has no area";
    }
  }
  return {};
}

std::string fault_of(const Tie& tie, std::size_t bodies) {
  if (tie.body >= bodies || tie.other >= bodies || tie.body == tie.other) return "a tie has no two bodies";
  if (!geometry::is_finite(tie.end) || !geometry::is_finite(tie.other_end)) return "an end of a tie is not finite";
  if (!(norm(tie.end - tie.other_end) > 0)) return "a tie has no length";
  if (!(tie.capacity.si() >= 0) || !(tie.ductility.si() >= 0)) return "a capacity or ductility of a tie is negative";
  return {};
}

std::string fault_of(const Load& load, std::size_t bodies) {
  if (load.body >= bodies || (load.other && (*load.other >= bodies || *load.other == load.body)))
    return "a load has no body, or twice the same";
  if (!geometry::is_finite(load.at) || !geometry::is_finite(load.force)) return "a load is not finite";
  if (!(norm(load.force) > 0)) return "a load has no force";
  if (!(load.opens.si() > 0) || !(load.slides.si() > 0)) return "a load ends before it begins";
  return {};
}

std::string fault_of(const StillWater& water) {
  if (!std::isfinite(water.level.si()) || !(std::abs(norm(water.up) - 1) < 1e-9)) return "still water has no surface";
  if (!(water.unit_weight.si() >= 0) || !std::isfinite(water.unit_weight.si()))
    return "the unit weight of still water is negative";
  return {};
}

std::expected<void, BadScene> add_body(const BodySpec& spec, std::size_t number, World::Impl& impl,
                                       std::vector<Cell>& cells) {
  const auto refuse = [&](std::string reason) {
    return std::unexpected(
        BadScene{"body " + std::to_string(number), std::move(reason), {static_cast<std::uint32_t>(number)}});
  };
  const auto mass = mass_properties(spec.shape);
  if (!mass) return refuse(mass.error().reason);
  const double density = spec.density.si();
  if (!(density > 0) || !std::isfinite(density)) return refuse("its density is not positive");
  if (!geometry::is_finite(spec.velocity) || !geometry::is_finite(spec.spin)) return refuse("its speed is not finite");
  Polyhedron own = spec.shape;
  for (Vec3& v : own.vertices) v -= mass->centroid;
  for (const Facet& facet : own.facets) {
    if (facet.surface >= impl.surfaces.size()) return refuse("a side names a surface that is not there");
  }
  auto parts = convex_cells(own, mass->volume);
  if (!parts) return refuse(parts.error().reason);
  Shape shape{.centroid = mass->centroid,
              .mass = density * mass->volume,
              .volume = mass->volume,
              .inertia = scaled(mass->inertia, density),
              .size = extent_of(own.vertices),
              .first_cell = static_cast<std::uint32_t>(cells.size())};
  shape.thickness = shape.size;
  for (const Vec3 v : own.vertices) shape.radius = std::max(shape.radius, norm(v));
  for (const Facet& facet : own.facets) {
    const Vec3 a = own.vertices[facet.loops[0][0]];
    const Vec3 n = cross(own.vertices[facet.loops[0][1]] - a, own.vertices[facet.loops[0][2]] - a);
    if (!(norm(n) > 0)) continue;
    double low = 0, high = 0;
    for (const Vec3 v : own.vertices) {
      low = std::min(low, dot(n, v - a) / norm(n));
      high = std::max(high, dot(n, v - a) / norm(n));
    }
    shape.thickness = std::min(shape.thickness, high - low);
  }
  for (Cell& cell : *parts) {
    cells.push_back(std::move(cell));
    impl.cell_body.push_back(static_cast<std::uint32_t>(number));
  }
  shape.last_cell = static_cast<std::uint32_t>(cells.size());
  impl.shapes.push_back(shape);
  impl.held.push_back(spec.fixed ? 1 : 0);
  impl.state.push_back({{}, {}, spec.fixed ? Vec3{} : spec.velocity, spec.fixed ? Vec3{} : shape.inertia * spec.spin});
  return {};
}

/// Bonds, ties, loads and water. What is wrong with them; empty: nothing.
std::string add_what_joins(SceneSpec& scene, World::Impl& impl) {
  const std::size_t bodies = scene.bodies.size();
  for (Bond& bond : scene.bonds) {
    if (std::string fault = fault_of(bond, bodies); !fault.empty()) return fault;
    impl.add_bond(std::move(bond));
  }
  for (const Tie& tie : scene.ties) {
    if (std::string fault = fault_of(tie, bodies); !fault.empty()) return fault;
    impl.ties.push_back({.tie = tie, .length = norm(tie.end - tie.other_end)});
  }
  impl.loads_on.resize(bodies);
  for (const Load& load : scene.loads) {
    if (std::string fault = fault_of(load, bodies); !fault.empty()) return fault;
    impl.add_load(load);
  }
  if (scene.water) {
    if (std::string fault = fault_of(*scene.water); !fault.empty()) return fault;
  }
  impl.water = scene.water;
  return {};
}

}  // namespace

std::string describe(const BadScene& error) {
  return error.which.empty() ? error.reason : error.which + ": " + error.reason;
}
std::string describe(const StepFailed& error) {
  return "after " + std::to_string(error.time) + " s no step succeeds, down to " + std::to_string(error.step) +
         " s: " + error.reason;
}
std::string_view name_of(Method method) noexcept {
  switch (method) {
    case Method::none: return "none needed";
    case Method::newton: return "newton";
    case Method::proximal: return "proximal";
    case Method::sweeps: return "sweeps";
    case Method::convex: return "convex";
    case Method::interior: return "interior";
  }
  return "";
}

void add_triangle(Vec3 a, Vec3 b, Vec3 c, std::vector<Bond::Share>& shares) {
  const double area = 0.5 * norm(cross(b - a, c - a));
  for (const Vec3 p : {a, b, c}) shares.push_back({p, area / 12});
  shares.push_back({(a + b + c) / 3, 0.75 * area});
}

std::expected<World, BadScene> World::make(SceneSpec scene, WorldOptions options) {
  auto impl = std::make_unique<Impl>();
  if (std::string fault = fault_of(options); !fault.empty()) return std::unexpected(BadScene{"", fault});
  for (const Surface& s : scene.surfaces) {
    if (!(s.friction >= 0) || !std::isfinite(s.friction)) return std::unexpected(BadScene{"", "friction is negative"});
    if (!(s.restitution >= 0 && s.restitution <= 1)) return std::unexpected(BadScene{"", "restitution is not 0 to 1"});
  }
  impl->options = options;
  impl->surfaces = scene.surfaces;
  std::vector<Cell> cells;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (auto made = add_body(scene.bodies[b], b, *impl, cells); !made) return std::unexpected(made.error());
  }
  if (std::string fault = add_what_joins(scene, *impl); !fault.empty()) return std::unexpected(BadScene{"", fault});
  const std::size_t n = scene.bodies.size();
  impl->asleep.assign(n, 0);
  impl->quiet.assign(n, 0);
  impl->implicit.assign(n, 0);
  impl->locked.assign(n, 0);
  impl->cells = std::make_shared<const std::vector<Cell>>(std::move(cells));
  std::vector<Vec3> corners;
  for (std::uint32_t c = 0; c < impl->cells->size(); ++c) {
    const Cell& cell = (*impl->cells)[c];
    impl->placed.push_back({.cell = &cell, .body = impl->cell_body[c], .number = c, .size = extent_of(cell.vertices)});
  }
  impl->place_all(impl->state, true);
  // Where nothing is free yet, as long as a step may be for any: what is let go later has limits of its own.
  const bool none_free = std::ranges::find(impl->held, std::uint8_t{0}) == impl->held.end();
  for (const Placed& p : impl->placed) {
    if (none_free || impl->held[p.body] == 0) corners.insert(corners.end(), p.vertices.begin(), p.vertices.end());
  }
  impl->extent = extent_of(corners);
  std::vector<std::uint32_t> pair;
  const std::vector<double> still(impl->shapes.size(), 0);
  if (impl->deepest_overlap(impl->near_pairs(still), pair) > options.overlap) {
    return std::unexpected(BadScene{"", "two bodies overlap at the start", pair});
  }
  World world{std::move(impl)};
  Impl& own = *world.impl_;
  own.expected = world.momentum();
  own.energy.start = own.energy.kinetic = 0;
  own.count_energy();
  own.energy.start = own.energy.kinetic + own.energy.potential;
  return world;
}

double World::Impl::kinetic_of(std::uint32_t b) const {
  const State& s = state[b];
  return 0.5 * shapes[b].mass * dot(s.v, s.v) + 0.5 * dot(s.momentum, solve(shapes[b].inertia, s.momentum));
}

void World::Impl::count_energy() {
  energy.kinetic = energy.potential = 0;
  for (std::uint32_t b = 0; b < shapes.size(); ++b) {
    if (held[b] != 0) continue;
    energy.kinetic += kinetic_of(b);
    energy.potential -= shapes[b].mass * dot(options.gravity, state[b].shift);
  }
}

std::expected<StepReport, StepFailed> World::step(double at_most) {
  Impl& own = *impl_;
  if (!(at_most > 0)) return std::unexpected(StepFailed{own.now, at_most, 0, "no time was asked for"});
  own.wake_touched();
  double step = own.longest_step(at_most);
  if (!(step > 0)) return std::unexpected(StepFailed{own.now, step, 0, "its bodies leave no length of a step"});
  Impl::Failure last;
  for (std::size_t cut = 0; cut <= own.options.cuts; ++cut) {
    Attempt attempt;
    own.pull = own.options.gravity - own.options.ground.over(own.now, own.now + step);
    // A rougher answer counts where a shorter step does no better.
    const double tolerate = (cut == 0 ? 0.1 : 1) * own.options.solver.tolerate;
    const std::vector<std::uint8_t> torn = own.torn;
    const auto failed = own.attempt(step, tolerate, attempt);
    if (!failed) {
      attempt.report.cuts = cut;
      attempt.report.step = step;
      own.now += step;
      own.last_step = step;
      return own.close(attempt);
    }
    last = *failed;
    own.torn = torn;
    if (cut < own.options.cuts) step /= 3;
  }
  own.place_all(own.state, false);
  return std::unexpected(StepFailed{own.now, step, last.residual, last.reason, last.bodies});
}

StepReport World::Impl::close(Attempt& done) {
  const double before = energy.kinetic + energy.potential - energy.ground - energy.loads;
  const auto broken = [](const TieRecord& t) { return t.broken; };
  const auto ties_broken = std::ranges::count_if(done.ties, broken) - std::ranges::count_if(ties, broken);
  accept(done);
  count_energy();
  energy.friction += done.friction;
  energy.lost -= done.work + done.scheme + done.friction;
  energy.projected += done.projected;
  energy.loads += done.loads;
  const double total = energy.kinetic + energy.potential;
  energy.largest_gain = std::max(energy.largest_gain, total - energy.ground - energy.loads - before - done.projected);
  const double largest = std::max({std::abs(energy.start), energy.kinetic, std::abs(energy.potential), energy.friction,
                                   std::abs(energy.lost), std::abs(energy.projected), std::abs(energy.ground),
                                   std::abs(energy.loads), energy.carried});
  const double balance =
      energy.start - energy.friction - energy.lost - energy.carried + energy.projected + energy.ground + energy.loads;
  energy.closing_error = largest > 0 ? std::abs(total - balance) / largest : 0;
  Vec3 momentum;
  StepReport& report = done.report;
  for (std::uint32_t b = 0; b < shapes.size(); ++b) {
    if (held[b] != 0) continue;
    momentum += shapes[b].mass * state[b].v;
    report.max_speed = std::max(report.max_speed, norm(state[b].v) + norm(spin(state[b], b)) * shapes[b].radius);
  }
  double weight = 0, all = 0;
  for (std::uint32_t b = 0; b < shapes.size(); ++b) {
    weight += held[b] == 0 ? shapes[b].mass : 0;
    all += held[b] == 0 ? shapes[b].mass * norm(state[b].v) : 0;
  }
  largest_momentum = std::max({largest_momentum, all, now * weight * strongest()});
  momentum_off = norm(momentum - expected);
  report.time = now;
  report.contacts = contacts.size();
  report.broken = done.broken.size() + static_cast<std::size_t>(ties_broken);
  end_loads(done.freed);
  sleep_and_wake(done);
  report.asleep = static_cast<std::size_t>(std::ranges::count(asleep, std::uint8_t{1}));
  return report;
}

/// Groups whose bodies have all been at rest for ten steps sleep.
void World::Impl::sleep_and_wake(const Attempt& done) {
  if (options.quasi_static) return;
  constexpr std::uint8_t steps = 10;
  for (std::uint32_t b = 0; b < shapes.size(); ++b) {
    const double speed = norm(state[b].v) + norm(spin(state[b], b)) * shapes[b].radius;
    quiet[b] = moves(b) && speed < options.sleep_speed ? static_cast<std::uint8_t>(std::min(quiet[b] + 1, 250)) : 0;
  }
  // What a tie held does not rest as before once that is gone.
  for (const std::uint32_t b : done.freed) asleep[b] = quiet[b] = 0;
  if (!options.sleep || options.ground.moves_at(now)) return;
  for (const Island& island : islands_of(touches)) {
    if (!std::ranges::all_of(island.bodies, [&](std::uint32_t b) { return quiet[b] >= steps; })) continue;
    for (const std::uint32_t b : island.bodies) {
      // What is left of its motion is lost, and counted.
      const Vec3 momentum = shapes[b].mass * state[b].v;
      const double kinetic = kinetic_of(b);
      energy.lost += kinetic;
      energy.kinetic -= kinetic;
      expected -= momentum;
      state[b].v = state[b].momentum = {};
      asleep[b] = 1;
    }
  }
}

/// Wakes what moving bodies may touch in the next step, and all that hangs together with it.
void World::Impl::wake_touched() {
  if (std::ranges::count(asleep, std::uint8_t{1}) == 0) return;
  const double step = options.step;
  for (;;) {
    std::vector<double> travel(shapes.size(), 0);
    for (std::uint32_t b = 0; b < shapes.size(); ++b) {
      travel[b] = 1e-6 * shapes[b].size;
      if (moves(b)) {
        travel[b] += step * (norm(state[b].v) + step * hurry_of(b) + norm(spin(state[b], b)) * shapes[b].radius);
      }
    }
    bool any = wake_tied();
    for (const auto& [i, j] : near_pairs(travel)) {
      for (const std::uint32_t b : {placed[i].body, placed[j].body}) {
        if (asleep[b] == 0) continue;
        asleep[b] = quiet[b] = 0;
        any = true;
      }
    }
    if (!any) return;
  }
}

World::World(std::unique_ptr<Impl> impl) : impl_{std::move(impl)} {}
World::World(const World& other) : impl_{std::make_unique<Impl>(*other.impl_)} {}
World::World(World&& other) noexcept = default;
World& World::operator=(const World& other) {
  if (this != &other) impl_ = std::make_unique<Impl>(*other.impl_);
  return *this;
}
World& World::operator=(World&& other) noexcept = default;
World::~World() = default;

double World::time() const noexcept { return impl_->now; }
std::size_t World::size() const noexcept { return impl_->shapes.size(); }
bool World::fixed(std::size_t body) const { return impl_->held[body] != 0; }
Vec3 World::centroid(std::size_t body) const { return impl_->shapes[body].centroid + impl_->state[body].shift; }
Vec3 World::displacement(std::size_t body) const { return impl_->state[body].shift; }
Turn World::turn(std::size_t body) const { return impl_->state[body].turn; }
Vec3 World::velocity(std::size_t body) const { return impl_->state[body].v; }
Vec3 World::spin(std::size_t body) const { return impl_->spin(impl_->state[body], static_cast<std::uint32_t>(body)); }
double World::mass(std::size_t body) const { return impl_->shapes[body].mass; }
double World::volume(std::size_t body) const { return impl_->shapes[body].volume; }
bool World::asleep(std::size_t body) const { return impl_->asleep[body] != 0; }
bool World::may_be_locked(std::size_t body) const { return impl_->locked[body] != 0; }
Vec3 World::position(std::size_t body, Vec3 at_start) const {
  return centroid(body) + impl_->state[body].turn * (at_start - impl_->shapes[body].centroid);
}
void World::set_fixed(std::size_t body, bool fixed) {
  Impl& own = *impl_;
  if ((own.held[body] != 0) == fixed) return;
  // What it had of momentum and energy leaves the books with it; its motion is a row of them.
  const double carried = fixed ? own.kinetic_of(static_cast<std::uint32_t>(body)) : 0;
  own.energy.carried += carried;
  own.expected -= own.shapes[body].mass * own.state[body].v;
  own.state[body].v = own.state[body].momentum = {};
  own.held[body] = fixed ? 1 : 0;
  std::ranges::fill(own.asleep, std::uint8_t{0});
  std::ranges::fill(own.quiet, std::uint8_t{0});
  const double before = own.energy.kinetic + own.energy.potential;
  own.count_energy();
  own.energy.start += own.energy.kinetic + own.energy.potential - before + carried;
}
const std::vector<Contact>& World::contacts() const noexcept { return impl_->contacts; }
TieState World::tie(std::size_t number) const {
  const TieRecord& tie = impl_->ties[number];
  return {newtons(tie.force), metres(tie.lengthened), tie.broken};
}
void World::cut(std::size_t tie) {
  TieRecord& own = impl_->ties[tie];
  own.broken = true;
  own.force = 0;
  std::ranges::fill(impl_->asleep, std::uint8_t{0});
  std::ranges::fill(impl_->quiet, std::uint8_t{0});
}
const Energy& World::energy() const noexcept { return impl_->energy; }
Vec3 World::momentum() const {
  Vec3 sum;
  for (std::size_t b = 0; b < size(); ++b) sum += mass(b) * velocity(b);
  return sum;
}
Vec3 World::angular_momentum() const {
  Vec3 sum;
  for (std::size_t b = 0; b < size(); ++b) {
    sum += mass(b) * cross(centroid(b), velocity(b)) + impl_->state[b].turn * impl_->state[b].momentum;
  }
  return sum;
}
double World::momentum_error() const noexcept {
  return impl_->largest_momentum > 0 ? impl_->momentum_off / impl_->largest_momentum : 0;
}
const WorldOptions& World::options() const noexcept { return impl_->options; }

}  // namespace cleave::motion
