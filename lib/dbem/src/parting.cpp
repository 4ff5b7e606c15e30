#include <algorithm>
#include <cmath>

#include "tries.hpp"
#include "world_impl.hpp"

namespace cleave::dbem {

namespace {

/// Compliance of contacts that part bodies, over their own. Where there is no room to part (a body wedged between
/// others) a penetration stays, and the harder the contacts the longer it takes to find that out.
constexpr double parting_softness = 1e-4;

/// Sweeps that leave at most half of the deepest penetration; empty when they do not.
std::vector<Vec2> swept_apart(const ContactProblem& problem, Work& work, int sweeps) {
  const std::vector<Vec2> nowhere(problem.contacts());
  std::vector<Vec2> found = nowhere;
  sweep(problem, work, 0, nowhere, sweeps, found);
  std::vector<Vec2> gaps = problem.b;
  problem.w.add_product(found, gaps);
  double before = 0, after = 0;
  for (std::size_t k = 0; k < gaps.size(); ++k) {
    before = std::min(before, problem.b[k].x);
    after = std::min(after, gaps[k].x);
  }
  if (!(after > 0.5 * before)) found.clear();
  return found;
}

/// Groups of more contacts than this are parted by sweeps where those do.
constexpr std::size_t dear = 600;
/// Penetrations, over the smaller feature, that such a group keeps where sweeps do not part them: a tenth of what fails
/// a step.
constexpr double harmless = 1e-7;

/// Impulses that part bodies, empty when none were found: a convex programme. Newton nearly always gets home and leaves
/// a millionth of a penetration, the interior-point solver does where it stagnates. In very large groups both are dear
/// and a few sweeps part nearly as well; where those do not (a body wedged between others), only what is `deep` is
/// worth more.
std::vector<Vec2> least_move(const ContactProblem& problem, Work& work, bool deep, SolverOptions how,
                             std::size_t& solves) {
  if (problem.contacts() > dear) {
    std::vector<Vec2> found = swept_apart(problem, work, 100);
    if (!found.empty() || !deep) return found;
  }
  how.accept = std::max(how.accept, 1e-6);
  how.target = 1e-2 * how.accept;
  how.newton_iterations = 30;
  for (const Method method : {Method::newton, Method::interior}) {
    how.method = method;
    PatternSolver linear{work};
    ContactSolution found = solve_again(problem, how, linear);
    solves += found.report.iterations;
    if (found.report.status != ContactReport::Status::not_converged) return std::move(found.impulse);
  }
  return {};
}

}  // namespace

std::vector<Clash> World::Impl::clashes_of(Attempt& out) {
  std::vector<std::uint8_t> lazy(size());
  for (std::size_t b = 0; b < size(); ++b) lazy[b] = idle(b) ? 1 : 0;
  const auto solid = [&](std::uint32_t b) {
    return Solid{corners_of(out.corners, b), out.boxes[b], shapes[b].convex && shapes[b].modes == 0};
  };
  std::vector<Clash> found;
  out.report.max_penetration = 0;
  for (const BodyPair pair : sweep.pairs(out.boxes, lazy)) {
    const double feature = std::min(shapes[pair.a].feature, shapes[pair.b].feature);
    const double rounding = contact_depth * feature;
    const double depth = clash_depth(solid(pair.a), solid(pair.b), rounding);
    out.report.max_penetration = std::max(out.report.max_penetration, depth);
    if (depth > rounding) found.push_back({pair, depth, std::max(options.overlap * feature, 2 * rounding)});
  }
  return found;
}

/// How far springs in the joints of two bodies let them overlap.
double World::Impl::shortened_by_springs(const Attempt& out, BodyPair pair) const {
  double most = 0;
  for (const Memory& m : out.memory) {
    const bool between = (m.key.i == pair.a && m.key.j == pair.b) || (m.key.i == pair.b && m.key.j == pair.a);
    if (between) most = std::max(most, 2 * m.compliance * std::abs(m.force.x));
  }
  return most;
}

/// Corners that went into a body in a step that ended in an overlap: finds the edges they came through. True when one
/// was added to the list.
bool World::Impl::add_missed(const Attempt& out, const std::vector<Clash>& clashes, std::vector<Touch>& list) const {
  bool added = false;
  const auto enter = [&](std::uint32_t i, std::uint32_t j, double rounding) {
    for (std::size_t v = 0; v < corner_count(i); ++v) {
      if (shapes[i].sharp[v] == 0) continue;
      const std::size_t edge = first_crossing(corners_of(corners, j), corners_of(out.corners, j),
                                              corners[first_corner[i] + v], out.corners[first_corner[i] + v], rounding);
      if (edge == static_cast<std::size_t>(-1)) continue;
      Touch missed{.i = i,
                   .vertex = static_cast<std::uint32_t>(v),
                   .j = j,
                   .edge = static_cast<std::uint32_t>(edge),
                   .gap = 0,
                   .ratio = 0,
                   .normal = {},
                   .point = {}};
      const TouchKey key = key_of(missed);
      if (std::ranges::any_of(list, [&](const Touch& other) { return key_of(other) == key; })) continue;
      renew_touch(missed, corners_of(corners, i), corners_of(corners, j));
      list.push_back(missed);
      added = true;
    }
  };
  for (const Clash& clash : clashes) {
    if (clash.depth <= clash.allowed) continue;
    const double rounding = 2 * contact_depth * std::min(shapes[clash.pair.a].feature, shapes[clash.pair.b].feature);
    enter(clash.pair.a, clash.pair.b, rounding);
    enter(clash.pair.b, clash.pair.a, rounding);
  }
  return added;
}

/// Takes up to `wanted` of kinetic energy from a group, all velocities by one factor: what touches still touches, what
/// slides slides the same way. Returns what was taken; nothing where a support moves.
double World::Impl::slow_down(const Island& island, const Rows& rows, double wanted, State& at) const {
  for (const Side& side : rows.sides) {
    const Shape& shape = shapes[side.body];
    const bool held = shape.inverse_x * shape.inverse_y * shape.inverse_spin == 0;
    if (held && (at.v[side.body] != Vec2{} || at.spin[side.body] != 0)) return 0;
  }
  double kinetic = 0;
  for (const std::uint32_t b : island.bodies) {
    kinetic += 0.5 * shapes[b].mass * dot(at.v[b], at.v[b]) + 0.5 * shapes[b].inertia * at.spin[b] * at.spin[b];
  }
  if (kinetic <= 0) return 0;
  const double taken = std::min(wanted, kinetic);
  const double factor = std::sqrt(1 - taken / kinetic);
  for (const std::uint32_t b : island.bodies) {
    at.v[b] = factor * at.v[b];
    at.spin[b] *= factor;
  }
  return taken;
}

/// Parts penetrating bodies: the least move in the norm of the masses that leaves no gap negative. Positions only.
bool World::Impl::project(Attempt& out, Work& work) const {
  std::vector<Island> islands = islands_of(out.touches);
  bool moved = false;
  for (Island& island : islands) {
    double deepest = 0;  // over the smaller feature
    std::erase_if(island.touches, [&](std::uint32_t k) {
      const auto held = [&](std::uint32_t b) { return shapes[b].inverse_x + shapes[b].inverse_y <= 0; };
      return held(out.touches[k].i) && held(out.touches[k].j);
    });
    for (const std::uint32_t k : island.touches) {
      const Touch& t = out.touches[k];
      if (law_of(t).compliance > 0) continue;
      deepest = std::max(deepest, -t.gap / std::min(shapes[t.i].feature, shapes[t.j].feature));
    }
    if (deepest <= contact_depth) continue;
    const Rows rows = rows_of(out.touches, island, out.state);
    ContactProblem problem;
    const std::size_t m = island.touches.size();
    problem.w = delassus(rows, 1, 1, true);
    problem.mu.assign(m, 0.0);
    problem.cohesion.assign(m, 0.0);
    problem.tension.assign(m, 0.0);
    for (std::size_t k = 0; k < m; ++k) {
      bem::Mat2& d = problem.w.values[problem.w.diagonal[k]];
      d.xx *= 1 + parting_softness;
      d.yy *= 1 + parting_softness;
      const Touch& t = out.touches[island.touches[k]];
      problem.b.push_back({law_of(t).compliance > 0 ? std::max(t.gap, 0.0) : t.gap, 0});
    }
    problem.rigid = rigid_form(rows, island, true);
    const std::vector<Vec2> impulse = least_move(problem, work, deepest > harmless, options.solver, out.report.parting);
    if (impulse.empty()) continue;  // left for the next step
    State shift;
    shift.v.assign(size(), {});
    shift.spin.assign(size(), 0);
    for (std::size_t k = 0; k < m; ++k) {
      for (const std::size_t which : {2 * k, 2 * k + 1}) {
        const Side& s = rows.sides[which];
        const Shape& shape = shapes[s.body];
        const double p = impulse[k].x;
        shift.v[s.body] += p * Vec2{shape.inverse_x * s.n.x, shape.inverse_y * s.n.y};
        shift.spin[s.body] += p * shape.inverse_spin * s.turn_n;
      }
    }
    bool free = true;  // no support takes part
    for (const Side& s : rows.sides) free = free && !(shapes[s.body].inverse_x * shapes[s.body].inverse_y == 0);
    double mass = 0, turned = 0, lifted = 0;
    Vec2 centre{};
    for (const std::uint32_t b : island.bodies) {
      lifted -= shapes[b].mass * dot(options.gravity, shift.v[b]);
      out.state.x[b] += shift.v[b];
      out.state.angle[b] += shift.spin[b];
      turned += shapes[b].mass * cross(shift.v[b], out.state.v[b]);
      mass += shapes[b].mass;
      centre += shapes[b].mass * out.state.x[b];
    }
    if (free) {
      // Moving bodies that slide past each other changes their angular momentum: a common spin takes that out.
      centre = centre / mass;
      double inertia = 0;
      for (const std::uint32_t b : island.bodies) {
        const Vec2 r = out.state.x[b] - centre;
        inertia += shapes[b].inertia + shapes[b].mass * dot(r, r);
      }
      const double spin = -turned / inertia;
      for (const std::uint32_t b : island.bodies) {
        out.state.v[b] += spin * turned_left(out.state.x[b] - centre);
        out.state.spin[b] += spin;
      }
    }
    // What came in fell too far before, and is too fast by that: a group on a support pays for the lift with speed.
    if (!free && lifted > 0) lifted -= slow_down(island, rows, lifted, out.state);
    out.projected += lifted;
    moved = true;
  }
  if (moved) place_all(out.state, out.corners, out.boxes);
  return moved;
}

}  // namespace cleave::dbem
