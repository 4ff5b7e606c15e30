#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "natural_map.hpp"
#include "world_impl.hpp"

namespace cleave::dbem {

namespace {

/// Contacts of a group that may be tried for as long as it takes; linear solves a larger one is tried for.
constexpr std::size_t patient_up_to = 300, patience_of_large = 300;

/// Share of the velocities of a group that rounding and the regularisation together may hide.
constexpr double hidden = 1e-3;
/// Velocities below this are none, m/s.
constexpr double at_rest = 1e-9;

/// Largest energy that contacts may bring in with a step, over the energy of the group.
constexpr double most_energy_gain = 1e-7;

struct Creep {
  double most = 0;   // velocity the regularisation lets contacts give way with, m/s
  double speed = 0;  // largest velocity of the problem, m/s
};
Creep creep_of(const ContactProblem& problem, const std::vector<Vec2>& found, const std::vector<Vec2>& viscous) {
  Creep creep;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Vec2 change = found[k] - problem.start[k];
    creep.most = std::max({creep.most, viscous[k].x * std::abs(change.x), viscous[k].y * std::abs(change.y)});
    creep.speed = std::max({creep.speed, std::abs(problem.b[k].x), std::abs(problem.b[k].y)});
  }
  return creep;
}

/// Moves the centre of the regularisation to `found`.
void centre(ContactProblem& problem, const std::vector<Vec2>& found, const std::vector<Vec2>& viscous) {
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Vec2 change = found[k] - problem.start[k];
    problem.b[k] += -Vec2{viscous[k].x * change.x, viscous[k].y * change.y};
  }
  problem.start = found;
}

}  // namespace

/// Impulses of one group of bodies. Restitution at several contacts at once, or with friction, may ask for more energy
/// than there is (Kane 1984): then half of it is asked for, and again.
ContactSolution World::Impl::solve_island(const std::vector<Touch>& list, Island& island, const Rows& rows,
                                          const State& free, double step, std::size_t cut, Work& work) const {
  PatternSolver linear{work};
  SolverOptions how = options.solver;
  // What resists in a large group is sooner solved by shorter steps than by all that can be tried.
  const bool last = cut == options.cuts;
  if (cut > 0 && !last) how.path = 0;
  if (!last && island.touches.size() > patient_up_to) how.patience = std::min(how.patience, patience_of_large);
  for (std::size_t iterations = 0;;) {
    std::vector<Vec2> viscous;
    ContactProblem problem = problem_of(list, island, rows, state, free, step, viscous);
    ContactSolution found = solve_again(problem, how, linear);
    // The regularisation is centred on the forces found, and again, until it moves nothing.
    Creep creep;
    for (int centring = 0; found.report.status == ContactReport::Status::converged; ++centring) {
      creep = creep_of(problem, found.impulse, viscous);
      if (creep.most <= 1e-8 * creep.speed || work.over() || centring >= (creep.most <= hidden * creep.speed ? 4 : 40))
        break;
      centre(problem, found.impulse, viscous);
      ContactSolution again = solve_again(problem, how, linear);
      again.report.iterations += found.report.iterations;
      if (again.report.status == ContactReport::Status::not_converged) break;
      found = std::move(again);
    }
    // A light body between heavy ones turns the last digits of their forces into velocities: what then is left of the
    // motion is nobody's answer, however small the residual over those forces is.
    const double moved = std::max(creep.speed, step * norm(options.gravity));
    if (creep.most + found.report.missed_speed > std::max(hidden * moved, at_rest)) {
      found.report.status = ContactReport::Status::not_converged;
    }
    found.report.iterations += iterations;
    if (!island.impact || island.rebound == 0 || found.report.status != ContactReport::Status::converged) return found;
    if (until_first_bounce(list, island, rows, found, step) < 1) return found;  // the step will be shortened
    State after = free;
    for (std::size_t k = 0; k < found.impulse.size(); ++k) {
      if (found.impulse[k] != Vec2{}) add_impulse(rows, k, found.impulse[k], island.theta, step, after);
    }
    double gain = 0, size = 0;
    bool asked = false;
    for (std::size_t k = 0; k < found.impulse.size(); ++k) {
      const Vec2 first = velocity_of(rows, k, free), then = velocity_of(rows, k, after);
      gain += 0.5 * dot(found.impulse[k], first + then);
      // Of the two parts: their sum vanishes where all is given back.
      size += std::abs(dot(found.impulse[k], first)) + std::abs(dot(found.impulse[k], then));
      asked = asked || law_of(list[island.touches[k]]).restitution > 0;
    }
    // Loads work along the path of the whole step, but change the speed of the impact only until then: a body thrown
    // back is lifted against them by more than they slowed it.
    for (const std::uint32_t b : island.bodies) {
      const double mass = shapes[b].mass, inertia = shapes[b].inertia, theta = island.theta;
      const Vec2 path = theta * after.v[b] + (1 - theta) * state.v[b];
      gain += mass * dot(free.v[b] - state.v[b], 0.5 * (state.v[b] + free.v[b]) - path);
      const double turn = theta * after.spin[b] + (1 - theta) * state.spin[b];
      gain += inertia * (free.spin[b] - state.spin[b]) * (0.5 * (state.spin[b] + free.spin[b]) - turn);
    }
    if (!asked || gain <= 1e-12 * size) return found;
    island.rebound = island.rebound > 0.1 ? 0.5 * island.rebound : 0.0;
    iterations = found.report.iterations;
  }
}

std::optional<World::Impl::Failure> World::Impl::attempt(double step, std::size_t cut, Work& work, Attempt& out) {
  std::vector<Touch> list = touches;
  std::vector<Touch> moved;
  std::vector<Rows> rows;
  std::vector<ContactSolution> solutions;
  std::vector<Clash> clashes;
  std::vector<double> theta;
  std::vector<std::uint8_t> implicit(size());
  hint.resize(size());
  for (std::size_t b = 0; b < size(); ++b) implicit[b] = hint[b] > 0 ? 1 : 0;
  torn_now.assign(sections.size(), 0);
  for (;;) {
    out.islands = islands_of(list);
    mark_impacts(list, out.islands, step, implicit, rows);
    theta.assign(size(), options.quasi_static ? 1.0 : 0.5);
    for (const Island& island : out.islands) {
      for (const std::uint32_t b : island.bodies) theta[b] = island.theta;
    }
    // Where impulses act: on the geometry at the share 1 - theta of the step. With arms about the centroids there,
    // angular momentum is kept exactly.
    State mid = state;
    for (std::size_t b = 0; b < size(); ++b) {
      if (asleep[b] == 0 && theta[b] < 1) predict(state, (1 - theta[b]) * step, b, mid);
    }
    moved = list;
    std::vector<Vec2> mid_corners = corners;
    for (std::size_t b = 0; b < size(); ++b) {
      if (asleep[b] == 0 && theta[b] < 1 && !(shapes[b].fixed && state.v[b] == Vec2{} && state.spin[b] == 0)) {
        place(mid, b, mid_corners);
      }
    }
    for (const Island& island : out.islands) {
      if (island.theta >= 1) continue;
      for (const std::uint32_t k : island.touches) {
        const double gap = moved[k].gap;
        renew_touch(moved[k], corners_of(mid_corners, moved[k].i), corners_of(mid_corners, moved[k].j));
        moved[k].gap = gap;
      }
    }
    State free = state;
    free_motion(state, theta, step, free);
    solutions.clear();
    out.state = free;
    out.report.residual = 0;
    out.report.iterations = out.report.stick = out.report.slip = out.report.opened = 0;
    out.report.solved_by.fill(0);
    out.report.solves_by.fill(0);
    out.report.impact = false;
    for (std::size_t s = 0; s < out.islands.size(); ++s) {
      Island& island = out.islands[s];
      if (island.theta < 1) rows[s] = rows_of(moved, island, mid);
      solutions.push_back(solve_island(moved, island, rows[s], free, step, cut, work));
      const ContactReport& report = solutions.back().report;
      if (report.status == ContactReport::Status::not_converged) {
        return Failure{report.residual,
                       work.over() ? "the contact law was not met with the work that a try may take"
                                   : "the contact law was not met",
                       0};
      }
      if (const double share = until_first_bounce(moved, island, rows[s], solutions.back(), step); share < 1) {
        return Failure{0, "", share};
      }
      out.report.residual = std::max(out.report.residual, report.residual);
      out.report.iterations += report.iterations;
      out.report.stick += report.stick;
      out.report.slip += report.slip;
      out.report.opened += report.opened;
      ++out.report.solved_by[static_cast<std::size_t>(report.method)];
      out.report.solves_by[static_cast<std::size_t>(report.method)] += report.iterations;
      out.report.impact = out.report.impact || island.impact;
      for (std::size_t k = 0; k < island.touches.size(); ++k) {
        const Vec2 p = solutions.back().impulse[k];
        if (p != Vec2{}) add_impulse(rows[s], k, p, island.theta, step, out.state);
      }
      const double gain = energy_brought_in(moved, island, rows[s], solutions.back(), out.state);
      if (gain > most_energy_gain) return Failure{gain, "its contacts bring in energy", 0};
    }
    if (tear_sections(list, out, solutions, step)) continue;
    // The mean rule lets a contact that opens and shuts again within a step, or slip that turns round, bring in energy
    // of the order of (g step)^2: such groups are done again by the implicit rule, which cannot.
    bool gained = false;
    for (std::size_t s = 0; s < out.islands.size(); ++s) {
      const Island& island = out.islands[s];
      if (island.theta >= 1) continue;
      double gain = 0, size = 0;
      for (std::size_t k = 0; k < island.touches.size(); ++k) {
        const Vec2 p = solutions[s].impulse[k];
        if (p != Vec2{}) gain += 0.5 * dot(p, velocity_of(rows[s], k, state) + velocity_of(rows[s], k, out.state));
      }
      for (const std::uint32_t b : island.bodies) {
        size += shapes[b].mass * (dot(state.v[b], state.v[b]) + shapes[b].feature * norm(options.gravity));
      }
      if (gain <= 1e-13 * size || law_of(list[island.touches[0]]).compliance > 0) continue;
      for (const std::uint32_t b : island.bodies) {
        implicit[b] = 1;
        hint[b] = 8;  // what rattles will rattle for a while
      }
      gained = true;
    }
    if (gained) {
      ++out.report.retries;
      continue;
    }
    // Positions.
    double largest_turn = 0;
    double largest_move = 0;
    bool finite = true;
    for (std::size_t b = 0; b < size(); ++b) {
      if (asleep[b] != 0) continue;
      const double th = theta[b];
      const Vec2 dx = step * (th * out.state.v[b] + (1 - th) * state.v[b]);
      const double turn = step * (th * out.state.spin[b] + (1 - th) * state.spin[b]);
      out.state.x[b] = state.x[b] + dx;
      out.state.angle[b] = state.angle[b] + turn;
      for (std::size_t m = first_mode[b]; m < first_mode[b + 1]; ++m) {
        out.state.e[m] = state.e[m] + step * (th * out.state.de[m] + (1 - th) * state.de[m]);
        finite = finite && std::isfinite(out.state.e[m]) && std::isfinite(out.state.de[m]);
      }
      largest_turn = std::max(largest_turn, std::abs(turn));
      const double move = norm(dx) + std::abs(turn) * shapes[b].radius;
      finite = finite && std::isfinite(move);
      largest_move = std::max(largest_move, move);
    }
    out.report.max_displacement = largest_move;
    if (!finite) return Failure{1, "the motion is not finite", 0};
    const double over = std::max(largest_turn / options.rotation, largest_move / (options.displacement * height));
    if (over > 1) return Failure{0, "the displacement in a step is too large", 0.9 / over};
    if (options.position_error > 0 && !out.report.impact) {
      double error = 0;
      for (std::size_t b = 0; b < size(); ++b) {
        if (asleep[b] == 0) {
          const Vec2 change = (out.state.v[b] - state.v[b]) / step - last_change[b];
          error = std::max(error, step * step * norm(change) / 12);
        }
      }
      if (error > options.position_error && step > options.step * 1e-3) {
        return Failure{0, "the error of position in a step is too large",
                       std::clamp(0.9 * std::sqrt(options.position_error / error), 0.2, 0.9)};
      }
    }
    place_all(out.state, out.corners, out.boxes);
    const double plan = std::max(next_step, step);
    find(out.state, out.corners, out.boxes, plan, out.touches, out.limit);
    // What sleeps does not move: what runs into it wakes it, and the step is redone.
    if (wake(out.touches, contact_depth)) return Failure{0, "", 1};
    clashes = clashes_of(out);
    if (out.report.retries < 8 && add_missed(out, clashes, list)) {
      ++out.report.retries;
      continue;
    }
    break;
  }

  for (std::size_t s = 0; s < out.islands.size(); ++s) {
    const Island& island = out.islands[s];
    for (std::size_t k = 0; k < island.touches.size(); ++k) {
      const Touch& t = list[island.touches[k]];
      const Vec2 p = solutions[s].impulse[k];
      const Vec2 now = velocity_of(rows[s], k, out.state);
      const Vec2 old = velocity_of(rows[s], k, state);
      const JointLaw& law = law_of(t);
      const Bond* bond = bond_of(t);
      out.friction -= law.compliance > 0 ? 0.0 : p.y * 0.5 * (now.y + old.y);
      const double mu = bond == nullptr && law.residual_friction >= 0 ? law.residual_friction : law.friction;
      const double bound = mu * p.x / step + (bond != nullptr ? bond->cohesion : 0.0);
      ContactState contact_state = ContactState::stick;
      if (p == Vec2{}) {
        contact_state = ContactState::open;
      } else if (std::abs(p.y) / step >= bound * (1 - 1e-9)) {
        contact_state = ContactState::slip;
      }
      const double feature = std::min(shapes[t.i].feature, shapes[t.j].feature);
      if (bond != nullptr) {
        const bool torn = p.x / step <= -bond->tension && now.x * step > 1e-9 * feature;
        const bool sheared = contact_state == ContactState::slip && std::abs(now.y) * step > 1e-9 * feature;
        if (torn || sheared) {
          const auto at = std::ranges::lower_bound(bond_keys, BondKey{t.i, t.vertex, t.j, 0});
          out.broken.push_back(at->bond);
        }
      }
      if (p != Vec2{}) out.memory.push_back({key_of(t), p / step, law.compliance, t.point, t.normal});
      const Touch& at = moved[island.touches[k]];
      out.contacts.push_back({t.i, t.vertex, t.j, t.edge, anchor + at.point, at.normal, t.gap, p.x / step, p.y / step,
                              now.y, contact_state, bond != nullptr});
      // Bodies whose velocity is given do work through their contacts.
      for (const std::size_t which : {2 * k, 2 * k + 1}) {
        const Side& side = rows[s].sides[which];
        const Shape& shape = shapes[side.body];
        const Vec2 impulse = p.x * side.n + p.y * side.t;
        const Vec2 v = out.state.v[side.body];
        if (shape.inverse_x == 0) out.work -= impulse.x * v.x;
        if (shape.inverse_y == 0) out.work -= impulse.y * v.y;
        if (shape.inverse_spin == 0) {
          out.work -= (p.x * side.turn_n + p.y * side.turn_t) * out.state.spin[side.body];
        }
      }
    }
  }
  for (std::uint32_t b = 0; b < bonds.size(); ++b) {
    if (!bonds[b].broken && torn_now[bonds[b].section] != 0) out.broken.push_back(b);
  }
  // Work of the loads other than gravity, and what is left over at each body.
  double most_change = 0, most_pull = 0;
  for (std::size_t b = 0; b < size(); ++b) {
    if (idle(b)) continue;
    double torque = 0;
    std::vector<double> modal;
    const Vec2 force = force_on(state, b, step, torque, shapes[b].timed ? &modal : nullptr);
    const Vec2 other = force - shapes[b].mass * options.gravity;
    out.work += dot(other, out.state.x[b] - state.x[b]) + torque * (out.state.angle[b] - state.angle[b]);
    for (std::size_t m = 0; m < modal.size(); ++m) {
      out.work += modal[m] * (out.state.e[first_mode[b] + m] - state.e[first_mode[b] + m]);
    }
    if (shapes[b].mass > 0) most_pull = std::max(most_pull, norm(force) / shapes[b].mass);
    Vec2 dv = out.state.v[b] - state.v[b];
    double change = norm(dv) + std::abs(out.state.spin[b] - state.spin[b]) * shapes[b].radius;
    if (shapes[b].modes > 0) change = std::max(change, speed_bound(out.state, b));
    most_change = std::max(most_change, change / step);
    out.report.max_speed = std::max(out.report.max_speed, speed_bound(out.state, b));
  }
  out.report.unbalanced = most_pull > 0 ? most_change / most_pull : most_change;

  bool parted = false;
  for (int pass = 0; pass < 3; ++pass) {
    double deepest = 0;
    for (const Touch& t : out.touches) {
      if (law_of(t).compliance > 0) continue;
      deepest = std::max(deepest, -t.gap / std::min(shapes[t.i].feature, shapes[t.j].feature));
    }
    if (deepest <= contact_depth) break;
    if (!project(out, work)) break;
    parted = true;
    double limit_again = 0;
    find(out.state, out.corners, out.boxes, std::max(next_step, step), out.touches, limit_again);
    out.limit = std::min(out.limit, limit_again);
  }
  if (parted) clashes = clashes_of(out);
  for (const Clash& clash : clashes) {
    if (clash.depth > clash.allowed + shortened_by_springs(out, clash.pair)) {
      return Failure{out.report.residual,
                     fmt::format("bodies '{}' and '{}' run into one another", bodies[clash.pair.a].name,
                                 bodies[clash.pair.b].name),
                     0, true};
    }
  }
  return std::nullopt;
}

void World::Impl::accept(Attempt&& done) {
  const double step = done.report.step;
  last_change.resize(size());
  for (std::size_t b = 0; b < size(); ++b) last_change[b] = (done.state.v[b] - state.v[b]) / step;
  time += step;
  for (std::uint8_t& h : hint) h = h > 0 ? static_cast<std::uint8_t>(h - 1) : h;
  state = std::move(done.state);
  corners = std::move(done.corners);
  boxes = std::move(done.boxes);
  touches = std::move(done.touches);
  limit = done.limit;
  seen_step = std::max(next_step, step);
  for (const std::uint32_t bond : done.broken) bonds[bond].broken = true;
  // Bonds whose corner has left are broken too.
  if (options.quasi_static) {
    for (std::size_t b = 0; b < size(); ++b) {
      if (shapes[b].fixed) continue;
      const Shape& shape = shapes[b];
      if (shape.inverse_x > 0) state.v[b].x = 0;
      if (shape.inverse_y > 0) state.v[b].y = 0;
      if (shape.inverse_spin > 0) state.spin[b] = 0;
    }
    std::ranges::fill(state.de, 0.0);
  }
  const auto sleeping = [&](std::uint32_t i, std::uint32_t j) { return asleep[i] != 0 || asleep[j] != 0; };
  for (const Memory& old : memory) {
    if (sleeping(old.key.i, old.key.j)) done.memory.push_back(old);
  }
  for (const Contact& old : contacts) {
    if (sleeping(old.vertex_body, old.edge_body)) done.contacts.push_back(old);
  }
  std::ranges::sort(done.memory, {}, &Memory::key);
  std::ranges::sort(done.contacts, {},
                    [](const Contact& c) { return TouchKey{c.vertex_body, c.vertex, c.edge_body, c.edge}; });
  memory = std::move(done.memory);
  contacts = std::move(done.contacts);
  energy.friction += done.friction;
  energy.work += done.work;
  energy.projected += done.projected;
  fall_asleep();
  energy.kinetic = kinetic_of(state);
  energy.potential = potential_of(state);
  energy.elastic = elastic_of(state, memory);
  energy.lost = start_energy + energy.work + energy.projected - energy.friction - energy.total();
}

std::expected<StepReport, StepError> World::step(double at_most) {
  Impl& w = *impl_;
  if (!(at_most > 0)) {
    return std::unexpected(StepFailed{w.time, at_most, 0, fmt::format("a step of {} s was asked for", at_most)});
  }
  while (w.wake(w.touches, std::numeric_limits<double>::infinity())) {
    w.find(w.state, w.corners, w.boxes, w.next_step, w.touches, w.limit);
    w.seen_step = w.next_step;
  }
  StepReport report;
  double step = std::min(w.next_step, at_most);
  bool all_idle = true;
  for (std::size_t b = 0; b < w.size() && all_idle; ++b) all_idle = w.still(b);
  if (all_idle) {
    w.time += step;
    report.time = w.time;
    report.step = step;
    report.asleep = w.size();
    report.contacts = w.contacts.size();
    return report;
  }
  if (step > w.limit) {
    step = std::max(w.limit, 1e-6 * step);
    ++report.shortened;
  }
  std::size_t cuts = 0;
  double shortest = step;
  const double most_work = w.options.try_work * std::max(1.0, 0.01 * static_cast<double>(w.size()));
  for (int tries = 0;; ++tries) {
    Attempt trial;
    Work work{most_work};
    const std::optional<Impl::Failure> failed = w.attempt(step, cuts, work, trial);
    report.work += work.spent();
    if (!failed) {
      trial.report.step = step;
      trial.report.time = w.time + step;
      trial.report.cuts = cuts;
      trial.report.shortened = report.shortened;
      trial.report.work = report.work;
      trial.report.contacts = trial.contacts.size();
      trial.report.islands = trial.islands.size();
      trial.report.broken = trial.broken.size();
      report = trial.report;
      // Calm steps grow, cut ones are felt the next time too.
      if (w.options.adaptive) {
        const double share = report.max_displacement / (w.options.displacement * w.height);
        const double longest = std::max(w.options.longest_step, w.options.step);
        if (report.cuts > 0 || report.shortened > 0) w.next_step = step;
        w.calm_steps = share < 1.0 / 3 && report.cuts == 0 ? w.calm_steps + 1 : 0;
        if (w.calm_steps >= 5 && w.next_step < longest) {
          w.next_step = std::min(longest, 1.5 * w.next_step);
          w.calm_steps = 0;
        }
      }
      w.accept(std::move(trial));
      report.asleep = static_cast<std::size_t>(std::ranges::count(w.asleep, std::uint8_t{1}));
      return report;
    }
    shortest = step;
    if (failed->factor >= 1) {  // something woke
      w.find(w.state, w.corners, w.boxes, w.next_step, w.touches, w.limit);
      continue;
    }
    if (failed->factor > 0 && tries < 60) {
      step *= failed->factor;
      ++report.shortened;
      continue;
    }
    if (cuts == w.options.cuts || failed->factor > 0) {
      w.torn_now.clear();
      return std::unexpected(StepFailed{w.time, shortest, failed->residual, failed->reason});
    }
    step /= 3;
    ++cuts;
    double limit = 0;
    if (failed->clash) w.find(w.state, w.corners, w.boxes, step, w.touches, limit);
  }
}

}  // namespace cleave::dbem
