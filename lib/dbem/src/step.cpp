#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "centring.hpp"
#include "natural_map.hpp"
#include "trial.hpp"

namespace cleave::dbem {

namespace {

/// Contacts of a group that may be tried for as long as it takes; linear solves a larger one is tried for.
constexpr std::size_t patient_up_to = 300, max_linear_solves_large = 300;

/// Share of the velocities of a group that rounding and the regularisation together may hide.
constexpr double hidden = 1e-3;
/// Share of what is left of a step's work that its first try may take, and each later one but the last.
constexpr double share_of_first_try = 0.4, share_of_a_try = 0.15;

/// Times a step is ended where slip does, and steps in a row that are: the next one takes all that is left as it comes.
constexpr std::size_t most_slip_ends = 4;

/// Velocities below this are none, m/s.
constexpr double at_rest = 1e-9;

/// Solves again about the forces found until the regularisation moves nothing.
Creep settle(Centring& centring, const ContactProblem& problem, ContactSolution& found, const SolverOptions& how,
             PatternSolver& linear) {
  Creep creep = centring.creep_at(found.impulse);
  for (int rounds = 0;; ++rounds) {
    const bool fair = creep.most <= hidden * creep.speed;
    if (creep.most <= 1e-8 * creep.speed || linear.work().over() || rounds >= (fair ? 4 : 40)) return creep;
    const auto solve_now = [&] {
      // What is an answer already is not worth all that can be tried.
      ContactSolution again = fair ? solve_near(problem, how, linear) : solve_again(problem, how, linear);
      again.report.iterations += found.report.iterations;
      return again;
    };
    const bool extrapolated = centring.onwards(found.impulse);
    ContactSolution again = solve_now();
    const auto failed = [&] { return again.report.status == ContactReport::Status::not_converged; };
    if (extrapolated && (failed() || centring.creep_at(again.impulse).most > creep.most)) {
      centring.plain(found.impulse);
      again = solve_now();
    }
    if (failed()) return creep;
    found = std::move(again);
    creep = centring.creep_at(found.impulse);
  }
}

}  // namespace

bool ContactSolve::gives_back_too_much(const std::vector<ContactCandidate>& list, const Island& island,
                                       const Rows& rows, const State& free, double step,
                                       const ContactSolution& found) const {
  const auto springy = [&](std::uint32_t k) { return law_of(list[k]).restitution > 0; };
  if (std::ranges::none_of(island.touches, springy)) return false;
  State after = free;
  for (std::size_t k = 0; k < found.impulse.size(); ++k) {
    if (found.impulse[k] != Vec2{}) add_impulse(rows, k, found.impulse[k], island.theta, step, after);
  }
  double gain = 0, size = 0;
  for (std::size_t k = 0; k < found.impulse.size(); ++k) {
    if (list[island.touches[k]].tie != no_tie) continue;
    const Vec2 first = velocity_of(rows, k, free), then = velocity_of(rows, k, after);
    gain += 0.5 * dot(found.impulse[k], first + then);
    // Of the two parts: their sum vanishes where all is given back.
    size += std::abs(dot(found.impulse[k], first)) + std::abs(dot(found.impulse[k], then));
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
  return gain > 1e-12 * size;
}

/// Impulses of one group of bodies. Restitution at several contacts at once, or with friction, may ask for more energy
/// than there is (Kane 1984): then half of it is asked for, and again.
ContactSolution ContactSolve::solve_island(const std::vector<ContactCandidate>& list, Island& island, const Rows& rows,
                                           const State& free, double step, std::size_t cut,
                                           const std::vector<Vec2>& known, Work& work) const {
  PatternSolver linear{work};
  SolverOptions how = options.solver;
  // What resists in a large group is sooner solved by shorter steps than by all that can be tried.
  const bool last = cut == options.cuts;
  if (cut > 0 && !last) how.path = 0;
  if (!last && island.touches.size() > patient_up_to)
    how.max_linear_solves = std::min(how.max_linear_solves.value_or(max_linear_solves_large), max_linear_solves_large);
  for (std::size_t iterations = 0;;) {
    std::vector<Vec2> viscous;
    ContactProblem problem = problem_of(list, island, rows, state, free, step, viscous);
    Centring centring{problem, viscous};
    if (!known.empty()) centring.plain(known);
    ContactSolution found = solve_again(problem, how, linear);
    // The regularisation is centred on the forces found, and again, until it moves nothing.
    Creep creep;
    if (found.report.status == ContactReport::Status::converged) creep = settle(centring, problem, found, how, linear);
    // A light body between heavy ones turns the last digits of their forces into velocities: what then is left of the
    // motion is nobody's answer, however small the residual over those forces is.
    const double moved = std::max(creep.speed, step * norm(options.gravity));
    if (creep.most + found.report.missed_speed > std::max(hidden * moved, at_rest)) {
      found.report.status = ContactReport::Status::not_converged;
    }
    found.report.iterations += iterations;
    if (!island.impact || island.rebound == 0 || found.report.status != ContactReport::Status::converged) return found;
    if (until_first_bounce(list, island, rows, found, step) < 1) return found;  // the step will be shortened
    if (!gives_back_too_much(list, island, rows, free, step, found)) return found;
    island.rebound = island.rebound > 0.1 ? 0.5 * island.rebound : 0.0;
    iterations = found.report.iterations;
  }
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
  choices = std::move(done.choices);
  limit = done.limit;
  seen_step = std::max(next_step, step);
  weaken(done);
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
  for (const CachedContact& old : memory) {
    if (sleeping(old.key.i, old.key.j)) done.memory.push_back(old);
  }
  for (const Contact& old : contacts) {
    if (sleeping(old.vertex_body, old.edge_body)) done.contacts.push_back(old);
  }
  std::ranges::sort(done.memory, {}, &CachedContact::key);
  std::ranges::sort(done.contacts, {},
                    [](const Contact& c) { return ContactKey{c.vertex_body, c.vertex, c.edge_body, c.edge}; });
  memory = std::move(done.memory);
  settle_choices();
  contacts = std::move(done.contacts);
  energy.friction += done.friction;
  energy.work += done.work;
  energy.projected += done.projected;
  energy.yielded += done.yielded;
  bars = std::move(done.bars);
  fall_asleep();
  energy.kinetic = kinetic_of(state);
  energy.potential = potential_of(state);
  energy.elastic = elastic_of(state, memory);
  energy.lost = start_energy + energy.work + energy.projected - energy.friction - energy.yielded - energy.total();
}

void World::Impl::choose_next_step(const StepReport& report) {
  if (!options.adaptive) return;
  const double share = report.max_displacement / (options.displacement * height);
  const double longest = std::max(options.longest_step.value_or(0), options.step);
  if (report.cuts > 0 || report.shortened > 0) next_step = report.step;
  calm_steps = share < 1.0 / 3 && report.cuts == 0 ? calm_steps + 1 : 0;
  if (calm_steps >= 5 && next_step < longest) {
    next_step = std::min(longest, 1.5 * next_step);
    calm_steps = 0;
  }
}

std::expected<StepReport, StepError> World::Impl::try_steps(double step, std::size_t shortened) {
  // What a step may take is shared out: a try that resists leaves enough for shorter ones.
  double left = options.step_work * std::max(1.0, 0.01 * static_cast<double>(size()));
  double spent = 0;
  SlipEnds ends;
  std::size_t cut = 0, slip_ends = 0;
  for (int tries = 0;; ++tries) {
    Attempt trial;
    const double share = cut == options.cuts ? 1.0 : cut == 0 ? share_of_first_try : share_of_a_try;
    Work work{share * left};
    ends.followed = slip_ends_in_a_row < most_slip_ends && slip_ends < most_slip_ends && spent < left;
    const std::optional<Failure> failed = Trial{*this, step, cut, work, ends, trial}.run();
    spent += work.spent();
    left -= work.spent();
    if (!failed) {
      StepReport& report = trial.report;
      report.step = step;
      report.time = time + step;
      report.cuts = cut;
      report.shortened = shortened;
      report.slip_ends = slip_ends;
      report.work = spent;
      report.contacts = trial.contacts.size();
      report.islands = trial.islands.size();
      report.broken = trial.broken.size();
      StepReport done = report;
      slip_ends_in_a_row = slip_ends > 0 ? slip_ends_in_a_row + 1 : 0;
      choose_next_step(done);  // calm steps grow, cut ones are felt the next time too
      accept(std::move(trial));
      done.asleep = static_cast<std::size_t>(std::ranges::count(asleep, std::uint8_t{1}));
      return done;
    }
    if (failed->slip_ends) {
      if (slip_ends++ == 0) ends.within = step;
      step *= *failed->redo;
      continue;
    }
    if (failed->redo == 1 && left > 0) {  // something woke
      look(next_step);
      continue;
    }
    if (failed->redo && tries < 60 && left > 0) {
      step *= *failed->redo;
      ++shortened;
      continue;
    }
    if (cut == options.cuts || failed->redo || left <= 0) {
      torn_now.clear();
      lost_now.clear();
      return std::unexpected(StepFailed{time, step, failed->residual, failed->reason});
    }
    step /= 3;
    ++cut;
    if (failed->clash) {
      const double kept = limit;
      look(step);
      limit = kept;
    }
  }
}

std::expected<StepReport, StepError> World::step(double at_most) {
  Impl& w = *impl_;
  if (!(at_most > 0)) {
    return std::unexpected(StepFailed{w.time, at_most, 0, fmt::format("a step of {} s was asked for", at_most)});
  }
  w.install_ties();
  at_most = std::min(at_most, w.until_next_tie());
  constexpr double any_gap = std::numeric_limits<double>::infinity();
  while (w.wake(w.touches, any_gap) || (!w.ties.empty() && w.wake(w.bars_at(w.state), any_gap))) {
    w.look(w.next_step);
    w.seen_step = w.next_step;
  }
  const double step = std::min(w.next_step, at_most);
  bool all_idle = true;
  for (std::size_t b = 0; b < w.size() && all_idle; ++b) all_idle = w.still(b);
  if (all_idle) {
    w.time += step;
    StepReport report;
    report.time = w.time;
    report.step = step;
    report.asleep = w.size();
    report.contacts = w.contacts.size();
    return report;
  }
  const bool shorter = step > w.limit;
  return w.try_steps(shorter ? std::max(w.limit, 1e-6 * step) : step, shorter ? 1 : 0);
}

}  // namespace cleave::dbem
