#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tries.hpp"
#include "world_impl.hpp"

namespace cleave::dbem {

namespace {

/// Compliance of contacts that part bodies, over their own. Where there is no room to part (a body wedged between
/// others) a penetration stays, and the harder the contacts the longer it takes to find that out.
constexpr double parting_softness = 1e-4;
/// Bodies so many times heavier than others of their group do not move for what light ones yield: contacts are harder
/// there by as much as the masses are further apart.
constexpr double uneven = 1e3;
/// Rounding of forces hides what is softer.
constexpr double least_softness = 1e-11;

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
/// Gaps of such a group count up to this many times the deepest penetration: no body is moved so far, and an answer is
/// judged by the largest gap there is.
constexpr double far_away = 100;

/// Penetrations, over the smaller feature, that such a group keeps where sweeps do not part them: a tenth of what fails
/// a step.
constexpr double harmless = 1e-7;

/// Impulses that part bodies, empty when none were found: a convex programme. Newton nearly always gets home, the
/// interior-point solver does where it stagnates. In very large groups both are dear and a few sweeps part nearly as
/// well; where those do not (a body wedged between others), only what is `deep` is worth more, and Newton stagnates.
std::vector<Vec2> least_move(const ContactProblem& problem, Work& work, bool deep, SolverOptions how,
                             std::size_t& solves) {
  if (problem.contacts() > dear) {
    std::vector<Vec2> found = swept_apart(problem, work, 100);
    if (!found.empty() || !deep) return found;
  }
  how.accept = std::max(how.accept, problem.contacts() > dear ? 1e-3 : 1e-6);
  how.target = 1e-2 * how.accept;
  how.newton_iterations = 30;
  std::array methods{Method::newton, Method::interior};
  if (problem.contacts() > dear) std::ranges::reverse(methods);
  for (const Method method : methods) {
    how.method = method;
    PatternSolver linear{work};
    ContactSolution found = solve_again(problem, how, linear);
    solves += found.report.iterations;
    if (found.report.status != ContactReport::Status::not_converged) return std::move(found.impulse);
  }
  return {};
}

}  // namespace

std::vector<Clash> ContactSearch::clashes_of(Attempt& out) {
  std::vector<std::uint8_t> lazy(size());
  for (std::size_t b = 0; b < size(); ++b) {
    const bool there = out.state.x[b] == state.x[b] && out.state.angle[b] == state.angle[b];
    lazy[b] = idle(b) && there ? 1 : 0;
  }
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
    const bool bends = shapes[pair.a].modes > 0 || shapes[pair.b].modes > 0;
    const double share = bends ? options.overlap_elastic : options.overlap;
    if (depth > rounding) found.push_back({pair, depth, std::max(share * feature, 2 * rounding)});
  }
  return found;
}

/// How far springs in the joints of two bodies let them overlap.
double Parting::shortened_by_springs(const Attempt& out, BodyPair pair) const {
  double most = 0;
  for (const CachedContact& m : out.memory) {
    const bool between = (m.key.i == pair.a && m.key.j == pair.b) || (m.key.i == pair.b && m.key.j == pair.a);
    if (between) most = std::max(most, 2 * m.compliance.x * std::abs(m.force.x));
  }
  return most;
}

/// Corners that went into a body in a step that ended in an overlap: finds the edges they came through. True when one
/// was added to the list.
bool Parting::add_missed(const Attempt& out, const std::vector<Clash>& clashes,
                         std::vector<ContactCandidate>& list) const {
  bool added = false;
  const auto enter = [&](std::uint32_t i, std::uint32_t j, double rounding) {
    for (std::size_t v = 0; v < corner_count(i); ++v) {
      if (shapes[i].sharp[v] == 0) continue;
      const auto edge = first_crossing(corners_of(corners, j), corners_of(out.corners, j), corners[first_corner[i] + v],
                                       out.corners[first_corner[i] + v], rounding);
      if (!edge) continue;
      ContactCandidate missed{.i = i,
                              .vertex = static_cast<std::uint32_t>(v),
                              .j = j,
                              .edge = static_cast<std::uint32_t>(*edge),
                              .gap = 0,
                              .ratio = 0,
                              .normal = {},
                              .point = {}};
      const ContactKey key = key_of(missed);
      if (std::ranges::any_of(list, [&](const ContactCandidate& other) { return key_of(other) == key; })) continue;
      update_candidate(missed, corners_of(corners, i), corners_of(corners, j));
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

/// Corners of which no line was known and that came in. True when a contact was added to the list.
bool Parting::add_crossed(const Attempt& out, std::vector<ContactCandidate>& list) const {
  bool added = false;
  for (const CornerChoice& choice : choices) {
    CornerChoice after = choice;
    for (ContactCandidate* line : {&after.first, &after.last}) {
      update_candidate(*line, corners_of(out.corners, line->i), corners_of(out.corners, line->j));
    }
    const std::uint32_t i = choice.first.i, j = choice.first.j;
    // Of the arithmetic, not what counts as touching: the shorter the step, the less comes in with the first one.
    const double rounding = 1e-12 * std::min(shapes[i].feature, shapes[j].feature) + 1e-15 * norm(after.first.point);
    const std::optional<ContactCandidate> crossed = line_crossed(choice, after, rounding);
    const auto known = [&](const ContactCandidate& other) { return key_of(other) == key_of(*crossed); };
    if (!crossed || std::ranges::any_of(list, known)) continue;
    list.push_back(*crossed);
    added = true;
  }
  return added;
}

/// Takes up to `wanted` of kinetic energy from a group, all velocities by one factor: what touches still touches, what
/// slides slides the same way. Returns what was taken; nothing where a support moves.
double Parting::slow_down(const Island& island, const Rows& rows, double wanted, State& at) const {
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

/// The least move in the norm of the masses that leaves no gap negative, as a contact problem without friction.
ContactProblem Parting::parting_problem(const Island& island, const Rows& rows, const std::vector<double>& gaps) const {
  const std::size_t m = gaps.size();
  ContactProblem problem;
  double lightest = std::numeric_limits<double>::infinity(), heaviest = 0;
  for (const std::uint32_t b : island.bodies) {
    if (shapes[b].inverse_x + shapes[b].inverse_y <= 0) continue;
    lightest = std::min(lightest, shapes[b].mass);
    heaviest = std::max(heaviest, shapes[b].mass);
  }
  const bool apart = heaviest > uneven * lightest;
  const double softness =
      apart ? std::max(parting_softness * uneven * lightest / heaviest, least_softness) : parting_softness;
  const double farthest =
      m > dear || apart ? -far_away * std::ranges::min(gaps) : std::numeric_limits<double>::infinity();
  problem.w = delassus(rows, 1, 1, 1, true);
  problem.mu.assign(m, 0.0);
  problem.cohesion.assign(m, 0.0);
  problem.tension.assign(m, 0.0);
  for (std::size_t k = 0; k < m; ++k) {
    bem::Mat2& d = problem.w.values[problem.w.diagonal[k]];
    d.xx *= 1 + softness;
    d.yy *= 1 + softness;
    problem.b.push_back({std::min(gaps[k], farthest), 0});
  }
  problem.rigid = rigid_form(rows, island, 1, true);
  return problem;
}

/// Moving bodies of a free group that slide past each other changes their angular momentum by `turned`: a common spin
/// takes that out. What energy that brings is taken from how they move against each other, all by one factor: what
/// touches still touches.
void Parting::keep_angular_momentum(const Island& island, double turned, State& at) const {
  double mass = 0, inertia = 0, angular = 0;
  Vec2 centre{}, velocity{};
  for (const std::uint32_t b : island.bodies) {
    mass += shapes[b].mass;
    centre += shapes[b].mass * at.x[b];
    velocity += shapes[b].mass * at.v[b];
  }
  centre = centre / mass;
  velocity = velocity / mass;
  for (const std::uint32_t b : island.bodies) {
    const Vec2 r = at.x[b] - centre;
    inertia += shapes[b].inertia + shapes[b].mass * dot(r, r);
    angular += shapes[b].inertia * at.spin[b] + shapes[b].mass * cross(r, at.v[b] - velocity);
  }
  const double common = angular / inertia, spin = -turned / inertia;
  const auto own = [&](std::uint32_t b) {  // against the group as one body
    return at.v[b] - velocity - common * turned_left(at.x[b] - centre);
  };
  double inner = 0;
  for (const std::uint32_t b : island.bodies) {
    const double turn = at.spin[b] - common;
    inner += 0.5 * shapes[b].mass * dot(own(b), own(b)) + 0.5 * shapes[b].inertia * turn * turn;
  }
  const double gain = spin * (angular + 0.5 * inertia * spin);
  const double factor = gain > 0 && inner > 0 ? std::sqrt(std::max(0.0, 1 - gain / inner)) : 1.0;
  for (const std::uint32_t b : island.bodies) {
    at.v[b] = velocity + (common + spin) * turned_left(at.x[b] - centre) + factor * own(b);
    at.spin[b] = common + spin + factor * (at.spin[b] - common);
  }
}

/// Parts one group; false: nothing to do, or left for the next step.
bool Parting::part_group(Island& island, Attempt& out, Work& work) const {
  std::erase_if(island.touches, [&](std::uint32_t k) {
    const auto held = [&](std::uint32_t b) { return shapes[b].inverse_x + shapes[b].inverse_y <= 0; };
    return held(out.touches[k].i) && held(out.touches[k].j);
  });
  double deepest = 0;  // over the smaller feature
  std::vector<double> gaps;
  for (const std::uint32_t k : island.touches) {
    const ContactCandidate& t = out.touches[k];
    gaps.push_back(compliance_of(t).x > 0 ? std::max(t.gap, 0.0) : t.gap);
    deepest = std::max(deepest, -gaps.back() / std::min(shapes[t.i].feature, shapes[t.j].feature));
  }
  if (deepest <= contact_depth) return false;
  const Rows rows = rows_of(out.touches, island, out.state);
  const ContactProblem problem = parting_problem(island, rows, gaps);
  const std::vector<Vec2> impulse = least_move(problem, work, deepest > harmless, options.solver, out.report.parting);
  if (impulse.empty()) return false;
  State shift;
  shift.v.assign(size(), {});
  shift.spin.assign(size(), 0);
  bool free = true;  // no support takes part
  for (std::size_t which = 0; which < rows.sides.size(); ++which) {
    const Side& s = rows.sides[which];
    const Shape& shape = shapes[s.body];
    const double p = impulse[which / 2].x;
    shift.v[s.body] += p * Vec2{shape.inverse_x * s.n.x, shape.inverse_y * s.n.y};
    shift.spin[s.body] += p * shape.inverse_spin * s.turn_n;
    free = free && !(shape.inverse_x * shape.inverse_y == 0);
  }
  double turned = 0, lifted = 0;
  for (const std::uint32_t b : island.bodies) {
    lifted -= shapes[b].mass * dot(options.gravity, shift.v[b]);
    out.state.x[b] += shift.v[b];
    out.state.angle[b] += shift.spin[b];
    turned += shapes[b].mass * cross(shift.v[b], out.state.v[b]);
  }
  if (free) keep_angular_momentum(island, turned, out.state);
  // What came in fell too far before, and is too fast by that: a group on a support pays for the lift with speed.
  if (!free && lifted > 0) lifted -= slow_down(island, rows, lifted, out.state);
  out.projected += lifted;
  return true;
}

/// Parts penetrating bodies. Positions only, but for what keeps energy and angular momentum.
bool Parting::separate_overlaps(Attempt& out, Work& work) const {
  bool moved = false;
  for (Island& island : islands_of(out.touches)) {
    const bool parted = part_group(island, out, work);
    moved = moved || parted;
  }
  if (moved) place_all(out.state, out.corners, out.boxes);
  return moved;
}

}  // namespace cleave::dbem
