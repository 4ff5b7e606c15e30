#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <span>

#include "cleave/core/disjoint_sets.hpp"

#include "world_impl.hpp"

namespace cleave::dbem {
namespace {

/// One value a mode.
auto modal_row(std::span<const double> all, std::size_t from, std::size_t modes) {
  return Eigen::Map<const Eigen::ArrayXd>(all.subspan(from, modes).data(), static_cast<Eigen::Index>(modes));
}
auto modal_row(std::span<double> all, std::size_t from, std::size_t modes) {
  return Eigen::Map<Eigen::ArrayXd>(all.subspan(from, modes).data(), static_cast<Eigen::Index>(modes));
}

}  // namespace

BoundaryPoint nearest_on(std::span<const Vec2> corners, Vec2 p) {
  BoundaryPoint best{.distance = std::numeric_limits<double>::infinity()};
  for (std::size_t e = 0; e < corners.size(); ++e) {
    const Vec2 along = corners[e + 1 == corners.size() ? 0 : e + 1] - corners[e];
    const double t = std::clamp(dot(p - corners[e], along) / dot(along, along), 0.0, 1.0);
    const double distance = norm(p - corners[e] - t * along);
    if (distance < best.distance) best = {e, t, distance};
  }
  return best;
}

std::vector<Island> ContactSearch::islands_of(const std::vector<ContactCandidate>& list) const {
  DisjointSets<std::uint32_t> together{size()};
  for (const ContactCandidate& t : list) {
    if (shapes[t.i].fixed || shapes[t.j].fixed) continue;
    together.join(t.i, t.j);
  }
  std::vector<Island> islands;
  std::vector<std::uint32_t> number(size(), static_cast<std::uint32_t>(-1));
  for (std::size_t k = 0; k < list.size(); ++k) {
    const std::uint32_t at = together.find(shapes[list[k].i].fixed ? list[k].j : list[k].i);
    if (number[at] == static_cast<std::uint32_t>(-1)) {
      number[at] = static_cast<std::uint32_t>(islands.size());
      islands.emplace_back();
    }
    islands[number[at]].touches.push_back(static_cast<std::uint32_t>(k));
  }
  for (std::uint32_t b = 0; b < size(); ++b) {
    if (shapes[b].fixed) continue;
    const std::uint32_t in = number[together.find(b)];
    if (in != static_cast<std::uint32_t>(-1)) islands[in].bodies.push_back(b);
  }
  return islands;
}

Rows ContactSolve::rows_of(const std::vector<ContactCandidate>& list, const Island& island, const State& at) const {
  Rows rows;
  rows.sides.reserve(2 * island.touches.size());
  for (const std::uint32_t which : island.touches) {
    const ContactCandidate& touch = list[which];
    const Vec2 n = touch.normal;
    const Vec2 t = turned_left(n);
    for (const bool edge_side : {false, true}) {
      const std::uint32_t body = edge_side ? touch.j : touch.i;
      const double sign = edge_side ? -1.0 : 1.0;
      Side side{.body = body,
                .arm = touch.point - at.x[body],  // of a bar too: both its ends lie on the line of its force
                .turn_n = 0,
                .turn_t = 0,
                .n = sign * n,
                .t = sign * t,
                .modal = rows.modal.size()};
      side.turn_n = cross(side.arm, side.n);
      side.turn_t = cross(side.arm, side.t);
      const std::size_t modes = shapes[body].modes;
      if (modes > 0) {
        const std::vector<double>& table = bodies[body].modes->shapes;
        const double c = std::cos(at.angle[body]);
        const double s = std::sin(at.angle[body]);
        const std::size_t from = edge_side ? touch.edge : touch.vertex;
        const std::size_t to = from + 1 == corner_count(body) ? 0 : from + 1;
        const double share = edge_side ? touch.ratio : touch.tie != no_tie ? tie_places[touch.tie][0].share : 0.0;
        const auto shape_of = [&](std::size_t corner, std::size_t axis) {
          return modal_row(std::span{table}, (2 * corner + axis) * modes, modes);
        };
        const Eigen::ArrayXd x = (1 - share) * shape_of(from, 0) + share * shape_of(to, 0);
        const Eigen::ArrayXd y = (1 - share) * shape_of(from, 1) + share * shape_of(to, 1);
        rows.modal.resize(side.modal + 2 * modes);
        std::size_t start = side.modal;
        for (const Vec2 d : {side.n, side.t}) {
          const Vec2 local{c * d.x + s * d.y, -s * d.x + c * d.y};
          modal_row(std::span{rows.modal}, start, modes) = local.x * x + local.y * y;
          start += modes;
        }
      }
      rows.sides.push_back(side);
    }
  }
  return rows;
}

ContactSolve::Damped ContactSolve::damped_over(double step) const {
  const double a = options.mass_damping * step;
  return a > 0 ? Damped{std::exp(-a), -std::expm1(-a) / a} : Damped{1, 1};
}

double ContactSolve::mode_inverse(std::size_t body, std::size_t mode, double theta, double step) const {
  const ModalBasis& basis = *bodies[body].modes;
  const double w = basis.omega[mode] * step * theta;
  return 1 / (1 + 2 * basis.damping * w + options.mass_damping * step * theta + w * w);
}

ContactSolve::SidesOfBodies ContactSolve::sides_of(const Rows& rows, double theta, double step, bool rigid_only) const {
  SidesOfBodies out;
  out.number.resize(size());
  for (std::size_t k = 0; k < rows.sides.size(); ++k) {
    const std::uint32_t body = rows.sides[k].body;
    if (shapes[body].fixed) continue;
    if (!out.number[body]) {
      out.number[body] = static_cast<std::uint32_t>(out.of.size());
      out.of.emplace_back();
    }
    out.of[*out.number[body]].push_back(static_cast<std::uint32_t>(k));
  }
  out.bending.resize(out.of.size());
  out.place.resize(rows.sides.size());
  for (const std::vector<std::uint32_t>& sides : out.of) {
    const std::uint32_t body = rows.sides[sides[0]].body;
    const std::size_t modes = rigid_only ? 0 : shapes[body].modes;
    for (std::size_t k = 0; k < sides.size(); ++k) out.place[sides[k]] = static_cast<Eigen::Index>(2 * k);
    if (modes == 0) continue;
    const auto many = static_cast<Eigen::Index>(2 * sides.size());
    Eigen::MatrixXd shape_rows(static_cast<Eigen::Index>(modes), many);
    Eigen::VectorXd inverse(static_cast<Eigen::Index>(modes));
    for (std::size_t q = 0; q < modes; ++q) {
      inverse[static_cast<Eigen::Index>(q)] = mode_inverse(body, q, theta, step);
    }
    for (const std::uint32_t side : sides) {
      const std::size_t from = rows.sides[side].modal;
      shape_rows.col(out.place[side]) = modal_row(std::span{rows.modal}, from, modes).matrix();
      shape_rows.col(out.place[side] + 1) = modal_row(std::span{rows.modal}, from + modes, modes).matrix();
    }
    const Eigen::MatrixXd scaled = inverse.asDiagonal() * shape_rows;
    out.bending[*out.number[body]].noalias() = shape_rows.transpose() * scaled;
  }
  return out;
}

BlockMatrix ContactSolve::delassus(const Rows& rows, double theta, double step, double felt, bool rigid_only) const {
  const std::size_t m = rows.sides.size() / 2;
  const SidesOfBodies sides = sides_of(rows, theta, step, rigid_only);
  BlockMatrix w;
  w.starts.reserve(m + 1);
  w.diagonal.resize(m);
  std::vector<std::optional<std::size_t>> place(m);
  w.starts.push_back(0);
  for (std::size_t r = 0; r < m; ++r) {
    const auto block_at = [&](std::uint32_t column) -> bem::Mat2& {
      if (!place[column]) {
        place[column] = w.columns.size();
        w.columns.push_back(column);
        w.values.emplace_back();
      }
      return w.values[*place[column]];
    };
    block_at(static_cast<std::uint32_t>(r));
    w.diagonal[r] = w.starts.back();
    for (const std::size_t which : {2 * r, 2 * r + 1}) {
      const Side& a = rows.sides[which];
      const Shape& shape = shapes[a.body];
      if (shape.fixed) continue;
      const Vec2 an = felt * Vec2{a.n.x * shape.inverse_x, a.n.y * shape.inverse_y};
      const Vec2 at = felt * Vec2{a.t.x * shape.inverse_x, a.t.y * shape.inverse_y};
      const double wn = felt * a.turn_n * shape.inverse_spin;
      const double wt = felt * a.turn_t * shape.inverse_spin;
      const std::uint32_t number = *sides.number[a.body];
      const Eigen::MatrixXd& bent = sides.bending[number];
      for (const std::uint32_t k : sides.of[number]) {
        const Side& b = rows.sides[k];
        bem::Mat2 sum{dot(an, b.n) + wn * b.turn_n, dot(an, b.t) + wn * b.turn_t, dot(at, b.n) + wt * b.turn_n,
                      dot(at, b.t) + wt * b.turn_t};
        if (bent.size() > 0) {
          const Eigen::Index i = sides.place[which];
          const Eigen::Index j = sides.place[k];
          sum += bem::Mat2{bent(i, j), bent(i, j + 1), bent(i + 1, j), bent(i + 1, j + 1)};
        }
        block_at(k / 2) += sum;
      }
    }
    for (std::size_t k = w.starts.back(); k < w.columns.size(); ++k) place[w.columns[k]].reset();
    w.starts.push_back(w.columns.size());
  }
  return w;
}

std::optional<RigidForm> ContactSolve::rigid_form(const Rows& rows, const Island& island, double felt,
                                                  bool stiffened) const {
  RigidForm form;
  if (!stiffened && std::ranges::any_of(island.bodies, [&](std::uint32_t b) { return shapes[b].modes > 0; }))
    return std::nullopt;
  std::vector<std::uint32_t> number(size(), RigidForm::ground);
  for (const std::uint32_t b : island.bodies) {
    number[b] = static_cast<std::uint32_t>(form.inverse_mass.size());
    form.inverse_mass.push_back(
        {felt * shapes[b].inverse_x, felt * shapes[b].inverse_y, felt * shapes[b].inverse_spin});
  }
  form.sides.resize(rows.sides.size() / 2);
  for (std::size_t k = 0; k < rows.sides.size(); ++k) {
    const Side& side = rows.sides[k];
    form.sides[k / 2][k % 2] = {
        number[side.body], {side.n.x, side.n.y, side.turn_n}, {side.t.x, side.t.y, side.turn_t}};
  }
  return form;
}

Vec2 ContactSolve::velocity_of(const Rows& rows, std::size_t contact, const State& at) const {
  Vec2 sum{};
  for (const std::size_t which : {2 * contact, 2 * contact + 1}) {
    const Side& s = rows.sides[which];
    sum.x += dot(s.n, at.v[s.body]) + s.turn_n * at.spin[s.body];
    sum.y += dot(s.t, at.v[s.body]) + s.turn_t * at.spin[s.body];
    const std::size_t modes = shapes[s.body].modes;
    if (modes == 0) continue;
    const auto de = modal_row(std::span{at.de}, first_mode[s.body], modes);
    sum.x += (modal_row(std::span{rows.modal}, s.modal, modes) * de).sum();
    sum.y += (modal_row(std::span{rows.modal}, s.modal + modes, modes) * de).sum();
  }
  return sum;
}

void ContactSolve::add_impulse(const Rows& rows, std::size_t contact, Vec2 p, std::array<double, 2> theta, double step,
                               State& at) const {
  const double felt = damped_over(step).felt;
  for (const std::size_t which : {2 * contact, 2 * contact + 1}) {
    const Side& s = rows.sides[which];
    const Shape& shape = shapes[s.body];
    const Vec2 impulse = felt * (p.x * s.n + p.y * s.t);
    at.v[s.body] += Vec2{shape.inverse_x * impulse.x, shape.inverse_y * impulse.y};
    at.spin[s.body] += shape.inverse_spin * (felt * (p.x * s.turn_n + p.y * s.turn_t));
    for (std::size_t k = 0; k < shape.modes; ++k) {
      at.de[first_mode[s.body] + k] += mode_inverse(s.body, k, theta[which % 2], step) *
                                       (p.x * rows.modal[s.modal + k] + p.y * rows.modal[s.modal + shape.modes + k]);
    }
  }
}

std::optional<std::uint32_t> JointState::bond_at(const ContactCandidate& t) const {
  if (t.tie != no_tie) return std::nullopt;
  const BondKey wanted{t.i, t.vertex, t.j, 0};
  const auto at = std::ranges::lower_bound(bond_keys, wanted);
  if (at == bond_keys.end() || at->body != t.i || at->vertex != t.vertex || at->other != t.j) return std::nullopt;
  return at->bond;
}

double JointState::cohesion_of(const ContactCandidate& t) const {
  if (const Bond* bond = bond_of(t)) return bond->cohesion;
  const auto at = bond_at(t);
  if (!at) return 0;
  const Bond& bond = bonds[*at];
  return (bond.broken && !bond.opened) || lost(*at) == Loss::by_slip ? bond.residual : 0.0;
}

const Bond* JointState::bond_of(const ContactCandidate& t) const {
  const auto at = bond_at(t);
  if (!at) return nullptr;
  const Bond& bond = bonds[*at];
  const bool torn = !torn_now.empty() && torn_now[bond.section] != 0;
  return bond.broken || torn || lost(*at) != Loss::none ? nullptr : &bond;
}

const JointLaw& JointState::law_of(const ContactCandidate& t) const {
  static const JointLaw smooth;
  if (t.tie != no_tie) return smooth;
  std::size_t of_i = bodies[t.i].property;
  std::size_t of_j = bodies[t.j].property;
  if (!bodies[t.j].properties.empty()) of_j = bodies[t.j].properties[t.edge];
  if (!bodies[t.i].properties.empty()) {
    const std::vector<Vec2>& c = shapes[t.i].corners;
    const std::size_t n = c.size();
    const std::size_t before = t.vertex == 0 ? n - 1 : t.vertex - 1;
    const Vec2 facing = rotated(-t.normal, -t.tilt - state.angle[t.i]);
    const auto along = [&](std::size_t edge) {
      const Vec2 d = c[edge + 1 == n ? 0 : edge + 1] - c[edge];
      return dot(turned_right(d), facing) / norm(d);
    };
    of_i = bodies[t.i].properties[along(t.vertex) >= along(before) ? t.vertex : before];
  }
  return laws.of(of_i, of_j);
}

Vec2 ContactSolve::with_gap(Vec2 free, Vec2 old, const ContactCandidate& touch, Vec2 force, const Island& island,
                            double thick, double step) const {
  // A spring in the joint: its shortening at the end of the step carries the force then.
  const Vec2 soft = compliance_of(touch);
  const double theta = island.theta;
  if (soft.y > 0) free.y += (-soft.y * force.y / step + (1 - theta) * old.y) / theta;
  if (soft.x > 0) return {free.x + (touch.gap / step + (1 - theta) * old.x) / theta, free.y};
  if (bounces(island, touch, old.x, step)) {
    // Away at e times the speed of approach, less what the loads take in the rest of the step: bouncing gains nothing.
    const double away = -island.rebound * law_of(touch).restitution * old.x + std::min(0.0, free.x - old.x);
    return {free.x - std::max(away, 0.0), free.y};
  }
  // Gaps of rounding size count as closed: a pile at rest sees the same problem every step. Between small bodies they
  // are as large as those of the large ones that hold them.
  const double feature = std::min(shapes[touch.i].feature, shapes[touch.j].feature);
  return {free.x + std::max(touch.gap - std::min(thick, 100 * feature) * contact_depth, 0.0) / step, free.y};
}

ContactProblem ContactSolve::problem_of(const std::vector<ContactCandidate>& list, const Island& island,
                                        const Rows& rows, const State& before, const State& free, double step,
                                        std::vector<Vec2>& viscous) const {
  const double theta = island.theta;
  const std::size_t m = island.touches.size();
  ContactProblem problem;
  const double felt = damped_over(step).felt;
  problem.w = delassus(rows, theta, step, felt, false);
  problem.rigid = rigid_form(rows, island, felt, false);
  problem.b.resize(m);
  problem.mu.resize(m);
  problem.cohesion.resize(m);
  problem.tension.resize(m);
  problem.start.resize(m);
  viscous.resize(m);
  const std::vector<Vec2> forces = warm_start(list, island);
  double softest = 0;
  double thick = 0;  // largest feature of the group
  for (const std::uint32_t body : island.bodies) thick = std::max(thick, shapes[body].feature);
  for (const std::size_t at : problem.w.diagonal) softest = std::max(softest, problem.w.values[at].xx);
  for (std::size_t k = 0; k < m; ++k) {
    const ContactCandidate& touch = list[island.touches[k]];
    const Bond* bond = bond_of(touch);
    const Vec2 force = forces[k];
    bem::Mat2& diagonal = problem.w.values[problem.w.diagonal[k]];
    // Clamped on both sides (shapes vanish there but for rounding): nothing can move, no force is felt.
    const bool immovable = diagonal.xx <= 1e-20 * softest || diagonal.yy <= 1e-20 * softest;
    if (immovable) {
      const double any = softest > 0 ? softest : 1.0;
      diagonal = {any, 0, 0, any};
    }
    diagonal.xx *= 1 + options.regularisation;
    diagonal.yy *= 1 + options.regularisation;
    const bem::Mat2 plain = diagonal;
    Vec2& b = problem.b[k];
    b = with_gap(velocity_of(rows, k, free), velocity_of(rows, k, before), touch, force, island, thick, step);
    const Vec2 soft = compliance_of(touch);
    diagonal.xx += soft.x / (step * step * theta);
    diagonal.yy += soft.y / (step * step * theta);
    problem.mu[k] = friction_of(touch, bond);
    problem.cohesion[k] = cohesion_of(touch) * step;
    problem.tension[k] = bond != nullptr ? bond->tension * step : 0.0;
    problem.start[k] = step * force;
    // Regularised about the forces of the step before: a load that stays makes nothing creep.
    const double share = options.regularisation / (1 + options.regularisation);
    viscous[k] = share * Vec2{plain.xx, plain.yy};
    b += -step * Vec2{viscous[k].x * force.x, viscous[k].y * force.y};
    if (immovable) {
      b = {};
      problem.start[k] = {};
    }
  }
  problem.yielding = viscous;
  return problem;
}

Vec2 ContactSolve::force_on(const State& at, std::size_t body, double step, double& torque,
                            std::vector<double>* modal) const {
  const double when = time + 0.5 * step;
  const Shape& shape = shapes[body];
  Vec2 acceleration = options.gravity;
  if (options.ground) {
    acceleration += -(options.ground_mean && step > 0 ? options.ground_mean(time, time + step) : options.ground(when));
  }
  Vec2 force = shape.mass * acceleration;
  torque = 0;
  if (modal != nullptr) modal->assign(shape.modes, 0.0);
  for (std::size_t q = 0; q < bodies[body].forces.size(); ++q) {
    const PointForce& load = bodies[body].forces[q];
    const double factor = load.mean && step > 0 ? load.mean(time, time + step) : load.factor(when);
    const double angle = at.angle[body] + 0.5 * step * at.spin[body];
    const Vec2 f = factor * (load.follows ? rotated(load.force, angle) : load.force);
    const Vec2 local = load.at - shape.local_centroid;
    force += f;
    torque += cross(rotated(local, angle), f);
    if (modal == nullptr || shape.modes == 0) continue;
    const auto [edge, share] = shape.load_places[q];
    const std::size_t to = edge + 1 == shape.corners.size() ? 0 : edge + 1;
    const Vec2 g = rotated(f, -angle);
    const std::vector<double>& table = bodies[body].modes->shapes;
    for (std::size_t m = 0; m < shape.modes; ++m) {
      const auto at_corner = [&](std::size_t c) {
        return g.x * table[2 * c * shape.modes + m] + g.y * table[(2 * c + 1) * shape.modes + m];
      };
      (*modal)[m] += (1 - share) * at_corner(edge) + share * at_corner(to);
    }
  }
  if (modal != nullptr && shape.stretches && !options.quasi_static) {
    const double square = at.spin[body] * at.spin[body];
    for (std::size_t m = 0; m < shape.modes; ++m) (*modal)[m] += square * bodies[body].modes->stretch[m];
  }
  return force;
}

void ContactSolve::free_motion(const State& before, const std::vector<double>& theta, double step, State& free) const {
  std::vector<double> modal;
  const auto [kept, felt] = damped_over(step);
  for (std::size_t b = 0; b < size(); ++b) {
    if (bodies[b].moves) free.v[b] = bodies[b].moves(time + step);
    if (idle(b)) continue;
    const Shape& shape = shapes[b];
    double torque = 0;
    const Vec2 force = force_on(before, b, step, torque, &modal);
    // A velocity that is given stays.
    const auto left = [&](double inverse) { return inverse > 0 ? kept : 1.0; };
    free.v[b] = {left(shape.inverse_x) * free.v[b].x, left(shape.inverse_y) * free.v[b].y};
    free.spin[b] *= left(shape.inverse_spin);
    free.v[b] += felt * step * Vec2{shape.inverse_x * force.x, shape.inverse_y * force.y};
    free.spin[b] += felt * step * shape.inverse_spin * torque;
    for (std::size_t m = 0; m < shape.modes; ++m) {
      const ModalBasis& basis = *bodies[b].modes;
      const std::size_t at = first_mode[b] + m;
      const double w = basis.omega[m];
      const double th = theta[b];
      const double damping = 2 * basis.damping * w + options.mass_damping;
      free.de[at] = ((1 - damping * (1 - th) * step) * before.de[at] -
                     step * w * w * (before.e[at] + th * (1 - th) * step * before.de[at]) + step * modal[m]) *
                    mode_inverse(b, m, th, step);
    }
  }
}

void ContactSolve::mark_impacts(const std::vector<ContactCandidate>& list, std::vector<Island>& islands, double step,
                                const std::vector<std::uint8_t>& implicit, std::vector<Rows>& made) const {
  made.clear();
  for (Island& island : islands) {
    made.push_back(rows_of(list, island, state));
    const Rows& rows = made.back();
    for (std::size_t k = 0; k < island.touches.size() && !island.impact; ++k) {
      if (list[island.touches[k]].tie != no_tie) continue;
      const double closing = velocity_of(rows, k, state).x;
      island.impact = closing < -1e-6 && list[island.touches[k]].gap + step * closing <= 0;
    }
    for (const std::uint32_t b : island.bodies) island.impact = island.impact || implicit[b] != 0;
    island.theta = island.impact || options.quasi_static ? 1.0 : 0.5;
  }
}

void ContactSolve::predict(const State& before, double step, std::size_t body, State& mid) const {
  mid.x[body] = before.x[body] + step * before.v[body];
  mid.angle[body] = before.angle[body] + step * before.spin[body];
  for (std::size_t m = first_mode[body]; m < first_mode[body + 1]; ++m) mid.e[m] = before.e[m] + step * before.de[m];
}

}  // namespace cleave::dbem
