#include <algorithm>
#include <cmath>

#include "cleave/core/disjoint_sets.hpp"
#include "world_impl.hpp"

namespace cleave::motion {
namespace {

using Eigen::Vector3d;

Vector6 stacked(Vec3 a, Vec3 b) {
  Vector6 out;
  out << a.x, a.y, a.z, b.x, b.y, b.z;
  return out;
}

bool is_finite(const State& s) {
  return geometry::is_finite(s.shift) && geometry::is_finite(s.v) && geometry::is_finite(s.momentum) &&
         std::isfinite(s.turn.w + s.turn.x + s.turn.y + s.turn.z);
}

/// Steps that a group which would have gained energy stays with the implicit rule.
constexpr std::uint8_t implicit_for = 8;
/// Rounds of looking for contacts that came up during a step.
constexpr int rounds = 8;

}  // namespace

Matrix6 mass_matrix(const Shape& shape, Turn turn) {
  Matrix6 out = Matrix6::Zero();
  out.topLeftCorner<3, 3>().diagonal().setConstant(shape.mass);
  Eigen::Index column = 3;
  for (const Vec3 e : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const Vec3 j = turn * (shape.inertia * turn.back(e));
    out.col(column++).tail<3>() << j.x, j.y, j.z;
  }
  // Rounding leaves it not quite symmetric.
  out = (0.5 * (out + out.transpose())).eval();
  return out;
}

void World::Impl::drift_body(State& s, std::uint32_t b, double h) const {
  s.shift += h * s.v;
  const Spinning next = drift(shapes[b].inertia, {s.turn, s.momentum}, h);
  s.turn = normalized(next.turn);
  s.momentum = next.momentum;
}

double World::Impl::longest_step(double at_most) const {
  double step = std::min(at_most, options.step);
  for (std::uint32_t b = 0; b < shapes.size(); ++b) {
    if (!moves(b)) continue;
    const double g = hurry_of(b);
    const double turning = norm(spin(state[b], b));
    const double speed = norm(state[b].v) + turning * shapes[b].radius;
    const double far =
        std::min(options.displacement * extent, std::max(0.25 * shapes[b].thickness, 0.02 * shapes[b].size));
    if (turning > 0) step = std::min(step, options.rotation / turning);
    // speed h + g h^2 / 2 <= far
    if (speed > 0 || g > 0) step = std::min(step, 2 * far / (speed + std::sqrt(speed * speed + 2 * g * far)));
  }
  return step;
}

std::vector<Island> World::Impl::islands_of(const std::vector<Touch>& list) const {
  DisjointSets<std::uint32_t> sets{shapes.size()};
  std::vector<std::uint8_t> in(shapes.size(), 0);
  const auto link = [&](std::uint32_t a, std::uint32_t b) {
    if (moves(a) && moves(b)) sets.join(a, b);
    if (moves(a)) in[a] = 1;
    if (moves(b)) in[b] = 1;
  };
  for (const Touch& t : list) link(t.body, t.other);
  for (const BondState& bond : bonds) {
    if (!bond.broken) link(bond.bond.body, bond.bond.other);
  }
  for (const TieRecord& t : ties) {
    if (!t.broken) link(t.tie.body, t.tie.other);
  }
  std::vector<std::optional<std::uint32_t>> place(shapes.size());
  std::vector<Island> out;
  for (std::uint32_t b = 0; b < shapes.size(); ++b) {
    if (in[b] == 0) continue;
    const std::uint32_t root = sets.find(b);
    if (!place[root]) {
      place[root] = static_cast<std::uint32_t>(out.size());
      out.emplace_back();
    }
    out[*place[root]].bodies.push_back(b);
  }
  const auto island = [&](std::uint32_t a, std::uint32_t b) -> Island* {
    if (!moves(a) && !moves(b)) return nullptr;
    Island& own = out[*place[sets.find(moves(a) ? a : b)]];
    own.leans = own.leans || !moves(a) || !moves(b);
    return &own;
  };
  for (std::uint32_t k = 0; k < list.size(); ++k) {
    if (Island* own = island(list[k].body, list[k].other)) own->touches.push_back(k);
  }
  for (std::uint32_t k = 0; k < bonds.size(); ++k) {
    if (bonds[k].broken) continue;
    Island* own = island(bonds[k].bond.body, bonds[k].bond.other);
    for (std::uint32_t s = 0; own != nullptr && s < points_of(k); ++s) own->bonds.emplace_back(k, s);
  }
  for (std::uint32_t k = 0; k < ties.size(); ++k) {
    if (ties[k].broken) continue;
    if (Island* own = island(ties[k].tie.body, ties[k].tie.other)) own->ties.push_back(k);
  }
  return out;
}

Group World::Impl::group_of(const Island& island, const std::vector<Touch>& list, const std::vector<State>& mid,
                            double step, double rebound) const {
  Group group;
  const auto local = [&](std::uint32_t b) -> std::optional<std::uint32_t> {
    if (!moves(b)) return std::nullopt;
    return static_cast<std::uint32_t>(std::ranges::lower_bound(island.bodies, b) - island.bodies.begin());
  };
  for (const std::uint32_t b : island.bodies) {
    group.mass.push_back(mass_matrix(shapes[b], mid[b].turn));
    group.free.push_back(stacked(mid[b].v, spin(mid[b], b)) + kick_of(b, mid, step));
  }
  const auto add = [&](std::uint32_t body, std::uint32_t other, Vec3 at, Vec3 normal) -> Point& {
    auto first = local(body), second = local(other);
    Point p;
    const Frame frame = frame_of(normal);
    if (first) p.on_body = rows_of(frame, at - centroid(mid[body], body));
    if (second) p.on_other = -rows_of(frame, at - centroid(mid[other], other));
    if (!first) {
      std::swap(first, second);
      p.on_body.swap(p.on_other);
    }
    p.body = *first;
    p.other = second;
    return group.points.emplace_back(p);
  };
  const double slow = 2 * step * strongest();
  for (const std::uint32_t k : island.touches) {
    const Touch& t = list[k];
    Point& p = add(t.body, t.other, t.point, t.normal);
    const Surface &a = surfaces[t.surface], &b = surfaces[t.other_surface];
    p.mu = std::min(a.friction, b.friction);
    const Frame frame = frame_of(t.normal);
    p.start << dot(frame.n, t.impulse), dot(frame.t1, t.impulse), dot(frame.t2, t.impulse);
    p.b[0] = std::max(t.gap, 0.0) / step;
    // Speed of approach before the kick, where it closes in this step.
    const auto before = [&](std::uint32_t place) {
      const std::uint32_t own = island.bodies[place];
      return stacked(mid[own].v, spin(mid[own], own));
    };
    double closing = p.on_body.col(0).dot(before(p.body));
    if (p.other) closing += p.on_other.col(0).dot(before(*p.other));
    const double back = rebound * std::min(a.restitution, b.restitution);
    if (back > 0 && closing < -slow && p.b[0] + closing < 0) p.b[0] = back * closing;
  }
  for (const auto& [k, s] : island.bonds) {
    const Bond& bond = bonds[k].bond;
    const auto [at, normal] = place_of(k, point_of(k, s).at_start, mid);
    set_law(k, s, normal, step, add(bond.body, bond.other, at, normal));
  }
  for (const std::uint32_t k : island.ties) {
    const TieRecord& tie = ties[k];
    const auto [end, other] = ends_of(tie, mid);
    Point& p = add(tie.tie.body, tie.tie.other, end, geometry::normalized(other - end));
    set_tie(tie, slack_of(tie, mid), step, p);
  }
  return group;
}

World::Impl::Balance World::Impl::gain_of(const Island& island, const Group& group, const Solution& found,
                                          const std::vector<State>& mid, double step) const {
  std::vector<Vector6> before;
  Balance out;
  double size = 0;
  const bool mean = implicit[island.bodies[0]] == 0 && !options.quasi_static;
  const double late = (mean ? options.theta : 1) - 0.5;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const std::uint32_t b = island.bodies[k];
    const Shape& shape = shapes[b];
    before.push_back(stacked(mid[b].v, spin(mid[b], b)));
    size += shape.mass * (dot(mid[b].v, mid[b].v) + strongest() * shape.size) +
            dot(mid[b].momentum, solve(shape.inertia, mid[b].momentum));
    // All that acts for the whole step does its work along the way of that step, the later velocity's by the share
    // late.
    const Vector6 change = found.velocity[k] - before[k], kick = kick_of(b, mid, step);
    out.scheme -= late * change.dot(group.mass[k] * kick);
  }
  double moved = 0, pressed = 0, asked = 0;
  for (std::size_t k = 0; k < group.points.size(); ++k) {
    const Point& p = group.points[k];
    Vector3d first = p.on_body.transpose() * before[p.body];
    Vector3d then = p.on_body.transpose() * found.velocity[p.body];
    Vector3d free = p.on_body.transpose() * group.free[p.body];
    if (p.other) {
      first += p.on_other.transpose() * before[*p.other];
      then += p.on_other.transpose() * found.velocity[*p.other];
      free += p.on_other.transpose() * group.free[*p.other];
    } else {
      const Vector3d force = p.on_body.topRows<3>() * found.impulse[k];
      out.from_walls += Vec3{force[0], force[1], force[2]};
    }
    out.work += 0.5 * found.impulse[k].dot(first + then);
    moved += std::abs(found.impulse[k].dot(first)) + std::abs(found.impulse[k].dot(then));
    pressed += found.impulse[k].norm();
    asked = std::max(asked, free.norm());
    out.friction -= found.impulse[k].tail<2>().dot(then.tail<2>());
  }
  const double gain = out.work + out.scheme;
  // What the answer misses the law by is no gain of the rule: by how the scene is written it would be one or not.
  const double missed = found.report.residual * pressed * asked;
  out.gain = gain > 1e-13 * size + 1e-9 * moved + missed ? gain : 0;
  return out;
}

bool World::Impl::close_island(const Island& island, const Solved& solved, const std::vector<State>& mid, double step,
                               Attempt& out) const {
  const Balance balance = gain_of(island, solved.group, solved.found, mid, step);
  const bool mean = implicit[island.bodies[0]] == 0 && !options.quasi_static && options.theta < 1;
  if (mean && !solved.rebounds && balance.gain > 0) return false;
  out.work += balance.work;
  out.scheme += balance.scheme;
  out.friction += balance.friction;
  out.given += balance.from_walls;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const std::uint32_t b = island.bodies[k];
    const Vector6& v = solved.found.velocity[k];
    out.state[b].v = {v[0], v[1], v[2]};
    out.state[b].momentum = shapes[b].inertia * mid[b].turn.back({v[3], v[4], v[5]});
    const Vec3 gained = out.state[b].v - mid[b].v;
    const double fall = step * norm(pull);
    if (fall > 0) out.report.unbalanced = std::max(out.report.unbalanced, norm(gained) / fall);
  }
  return true;
}

double World::Impl::theta_of(std::uint32_t b) const {
  return options.quasi_static || implicit[b] != 0 ? 1.0 : options.theta;
}

std::vector<State> World::Impl::predict(double step, std::vector<double>& travel) const {
  std::vector<State> mid = state;
  for (std::uint32_t b = 0; b < shapes.size(); ++b) {
    if (!moves(b)) continue;
    if (options.quasi_static) mid[b].v = mid[b].momentum = {};
    travel[b] =
        step * (norm(mid[b].v) + step * hurry_of(b) + norm(spin(mid[b], b)) * shapes[b].radius) + 1e-6 * shapes[b].size;
    drift_body(mid[b], b, (1 - theta_of(b)) * step);
  }
  return mid;
}

void World::Impl::let_fall(const std::vector<State>& mid, double step, Attempt& out) const {
  out.state = mid;
  out.work = out.friction = out.scheme = 0;
  out.given = {};
  out.broken.clear();
  out.contacts.clear();
  out.locked.assign(shapes.size(), 0);
  // What sleeps is not solved: what was said of it stays.
  for (std::size_t b = 0; b < asleep.size(); ++b) out.locked[b] = asleep[b] != 0 ? locked[b] : std::uint8_t{0};
  out.torn.clear();
  out.bond_impulse.assign(bonds.size(), {});
  out.ties = ties;
  for (TieRecord& tie : out.ties) {
    if (tie.broken) tie.force = 0;
  }
  out.report = {};
  out.report.may_be_locked = static_cast<std::size_t>(std::ranges::count(out.locked, std::uint8_t{1}));
  for (std::uint32_t b = 0; b < shapes.size(); ++b) {
    if (!moves(b)) continue;
    const Wrench more = loads_of(b, mid);
    out.state[b].v += step * (pull + more.force / shapes[b].mass);
    out.state[b].momentum += step * mid[b].turn.back(more.moment);
    out.given += step * (shapes[b].mass * pull + more.force);
  }
}

TouchingPairs touching_pairs(const std::vector<Touch>& list, std::size_t bodies) {
  TouchingPairs out;
  for (const Touch& t : list) out.pairs.emplace_back(std::min(t.body, t.other), std::max(t.body, t.other));
  std::ranges::sort(out.pairs);
  const auto [first, last] = std::ranges::unique(out.pairs);
  out.pairs.erase(first, last);
  out.count.assign(bodies, 0);
  for (const auto& [a, b] : out.pairs) {
    ++out.count[a];
    ++out.count[b];
  }
  return out;
}

std::optional<bool> World::Impl::as_before(const Island& island, const Attempt& so_far) const {
  // Other forces act now than in the last step: what stood under those may move under these.
  if (options.ground.moves_at(now - last_step)) return std::nullopt;
  for (const auto& [bond, point] : island.bonds) {
    if (bonds[bond].impulse.size() != points_of(bond)) return std::nullopt;
  }
  const TouchingPairs &old = so_far.before, &own = so_far.pairs;
  bool may_be_locked = false;
  for (const std::uint32_t b : island.bodies) {
    if (quiet[b] == 0 || old.count[b] != own.count[b]) return std::nullopt;
    may_be_locked = may_be_locked || locked[b] != 0;
  }
  for (const std::uint32_t k : island.touches) {
    const Touch& t = so_far.touches[k];
    const std::pair pair{std::min(t.body, t.other), std::max(t.body, t.other)};
    if (!std::ranges::binary_search(old.pairs, pair)) return std::nullopt;
  }
  return may_be_locked;
}

World::Impl::Solved World::Impl::solve_island(const Island& island, const Attempt& so_far,
                                              const std::vector<State>& mid, double step, double tolerate) const {
  Solved out;
  const std::vector<Touch>& list = so_far.touches;
  const std::optional<bool> settled = as_before(island, so_far);
  // Restitution in several contacts at once may ask for more energy than there is (Kane 1984): then for less.
  for (const double rebound : {1.0, 0.99, 0.97, 0.93, 0.85, 0.7, 0.5, 0.25, 0.0}) {
    out.group = group_of(island, list, mid, step, rebound);
    out.group.settled = settled;
    out.group.still = 0.1 * options.sleep_speed;
    SolverOptions how = options.solver;
    how.tolerate = tolerate;
    const double slow = 2 * step * strongest();
    how.locking = std::ranges::all_of(island.bodies, [&](std::uint32_t b) {
      return norm(mid[b].v) + norm(spin(mid[b], b)) * shapes[b].radius <= slow;
    });
    out.found = motion::solve(out.group, how);
    out.rebounds = std::ranges::any_of(out.group.points, [](const Point& p) { return p.b[0] < 0; });
    if (!out.rebounds || gain_of(island, out.group, out.found, mid, step).gain <= 0) break;
  }
  return out;
}

void World::Impl::note_contacts(const Island& island, const Solved& solved, const std::vector<State>& mid, double step,
                                Attempt& out) const {
  for (std::size_t k = 0; k < solved.group.points.size(); ++k) {
    const Point& p = solved.group.points[k];
    Vector3d slip = p.on_body.transpose() * solved.found.velocity[p.body];
    if (p.other) slip += p.on_other.transpose() * solved.found.velocity[*p.other];
    const Vector3d& i = solved.found.impulse[k];
    if (p.axial) {
      const std::size_t first = island.touches.size() + island.bonds.size();
      note_tie(island.ties[k - first], solved.group, p, i[0], p.b[0] + slip[0], step, out);
      continue;
    }
    if (k >= island.touches.size()) {
      const auto& [bond, number] = island.bonds[k - island.touches.size()];
      note_bond(bond, number, i, slip, mid, step, out);
      continue;
    }
    Touch& t = out.touches[island.touches[k]];
    t.impulse = in_space(frame_of(t.normal), i);
    out.contacts.push_back({t.body, t.other, t.point, t.normal, t.gap, t.impulse / step, slip.tail<2>().norm(), false});
  }
}

std::expected<bool, World::Impl::Failure> World::Impl::solve_all(const std::vector<State>& mid, double step,
                                                                 double tolerate, Attempt& out) {
  const std::vector<Island> islands = islands_of(out.touches);
  out.report.islands = islands.size();
  std::vector<std::uint8_t> touched(shapes.size(), 0);
  for (const Island& island : islands) {
    for (const std::uint32_t b : island.bodies) touched[b] = 1;
  }
  for (std::uint32_t b = 0; b < shapes.size(); ++b) {
    if (touched[b] != 0 || !moves(b)) continue;
    // An implicit step of what nothing touches loses what it is moved too far.
    const Vector6 kick = kick_of(b, mid, step);
    out.scheme -= (theta_of(b) - 0.5) * kick.dot(mass_matrix(shapes[b], mid[b].turn) * kick);
  }
  bool kept = true;
  const auto take_implicit_rule = [&](const Island& island) {
    for (const std::uint32_t b : island.bodies) implicit[b] = implicit_for;
    kept = false;
  };
  // A group takes one rule: the implicit one where one of its bodies does.
  for (const Island& island : islands) {
    const bool mixed = std::ranges::any_of(island.bodies, [&](std::uint32_t b) { return implicit[b] != 0; }) &&
                       std::ranges::any_of(island.bodies, [&](std::uint32_t b) { return implicit[b] == 0; });
    if (mixed) take_implicit_rule(island);
  }
  if (!kept) return false;
  const std::vector<Solved> all = parallel_map(islands.size(), ThreadLimit{options.threads}, [&](std::size_t k) {
    return solve_island(islands[k], out, mid, step, tolerate);
  });
  for (std::size_t k = 0; k < islands.size(); ++k) {
    const Island& island = islands[k];
    const Solved& solved = all[k];
    const SolveReport& report = solved.found.report;
    out.report.iterations += report.iterations;
    out.report.residual = std::max(out.report.residual, report.residual);
    if (report.may_be_locked) {
      out.report.may_be_locked += island.bodies.size();
      for (const std::uint32_t b : island.bodies) out.locked[b] = 1;
    }
    out.report.stick += report.stick;
    out.report.slip += report.slip;
    if (report.status == SolveReport::Status::rough) out.report.rough += island.bodies.size();
    out.report.missed_speed = std::max(out.report.missed_speed, report.missed_speed);
    if (report.status == SolveReport::Status::not_converged) {
      return std::unexpected(Failure{report.residual, "the contact law was not met"});
    }
    if (close_island(island, solved, mid, step, out)) {
      note_contacts(island, solved, mid, step, out);
    } else {
      take_implicit_rule(island);
    }
  }
  for (const std::uint32_t bond : out.torn) torn[bond] = 1;
  return kept && out.torn.empty();
}

std::optional<World::Impl::Failure> World::Impl::attempt(double step, double tolerate, Attempt& out) {
  std::vector<double> travel(shapes.size(), 0);
  Look seen;
  for (int round = 0;;) {
    out = {};
    const std::vector<State> mid = predict(step, travel);
    place_all(mid, false);
    out.touches = touches_of(near_pairs(travel), travel, true);
    recall(out.touches, step);
    drop_bonded(out.touches, mid);
    out.before = touching_pairs(touches, shapes.size());
    bool kept = true;
    for (;; ++round) {
      let_fall(mid, step, out);
      out.pairs = touching_pairs(out.touches, shapes.size());
      const auto solved = solve_all(mid, step, tolerate, out);
      if (!solved) return solved.error();
      kept = *solved;
      if (!kept) break;
      out.loads = work_of_loads(mid, out.state, step);
      for (std::uint32_t b = 0; b < shapes.size(); ++b) {
        if (moves(b)) drift_body(out.state[b], b, theta_of(b) * step);
      }
      if (!std::ranges::all_of(out.state, is_finite)) return Failure{0, "the motion of a body is not finite"};
      place_all(out.state, false);
      seen = look();
      if (round >= rounds) break;
      std::vector<Touch> at_end = seen.touches;
      drop_bonded(at_end, out.state);
      const std::vector<Touch> more = missed(out.touches, at_end, mid, out.state);
      if (more.empty()) break;
      out.touches.insert(out.touches.end(), more.begin(), more.end());
    }
    out.report.retries = static_cast<std::size_t>(round);
    if (kept) break;
    // A bond gives once: such rounds end by themselves.
    if (out.torn.empty() && ++round > 4 * rounds) return Failure{0, "no rule of the step keeps the energy"};
  }
  lengthen_ties(out);
  double deepest = 0;
  out.projected = part(out.state, out.ties, seen, deepest);
  out.report.max_penetration = deepest;
  double smallest = extent;
  for (std::uint32_t b = 0; b < shapes.size(); ++b) {
    if (moves(b)) smallest = std::min(smallest, shapes[b].size);
  }
  if (deepest > 5e-3 * smallest) return Failure{deepest, "bodies ran into one another"};
  std::vector<std::uint32_t> pair;
  out.report.overlap = deepest_overlap(seen.pairs, pair);
  if (out.report.overlap > options.overlap) return Failure{out.report.overlap, "two bodies overlap", pair};
  return {};
}

void World::Impl::accept(Attempt& done) {
  for (std::uint32_t b = 0; b < shapes.size(); ++b) {
    if (moves(b)) energy.ground += shapes[b].mass * dot(pull - options.gravity, done.state[b].shift - state[b].shift);
  }
  state = std::move(done.state);
  touches = std::move(done.touches);
  contacts = std::move(done.contacts);
  locked = std::move(done.locked);
  for (const std::uint32_t k : done.broken) bonds[k].broken = true;
  ties = std::move(done.ties);
  for (std::size_t k = 0; k < bonds.size(); ++k) bonds[k].impulse = std::move(done.bond_impulse[k]);
  for (std::uint8_t& count : implicit) count = count > 0 ? static_cast<std::uint8_t>(count - 1) : count;
  expected += done.given;
}

}  // namespace cleave::motion
