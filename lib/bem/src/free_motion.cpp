#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <span>

#include "block_build.hpp"
#include "cleave/bem/motion.hpp"
#include "cleave/core/assert.hpp"
#include "with_eigen.hpp"

namespace cleave::bem {
FreeMotion::FreeMotion(const BlockOperator& block, Setup setup) : block_{&block}, setup_{std::move(setup)} {
  CLEAVE_ASSERT(setup_.step > 0);
  before_build_.assign(block.freedoms(), 0.0);
  adopt();
  q_.assign(3 + modes_.eigenvalues.size(), 0.0);
  v_ = q_;
  v_[0] = setup_.velocity.x;
  v_[1] = setup_.velocity.y;
  v_[2] = setup_.spin;
  q_[0] = block.centroid().x;
  q_[1] = block.centroid().y;
  pin_force_.assign(2 * setup_.pins.size(), 0.0);
  start();
}

/// All that follows from the operator alone.
void FreeMotion::adopt() {
  const BlockOperator& block = *block_;
  if (setup_.modes != std::size_t{0}) modes_ = free_modes(block, setup_.modes);
  const std::size_t nm = modes_.eigenvalues.size();
  internal_.assign(nm, 0.0);
  steep_ = setup_.rebuilding ? steepest_of(block, modes_) : std::vector<double>{};
  // Centrifugal load of a unit spin: phi^T M X; the position field is linear and the operator knows it exactly.
  centrifugal_.assign(nm, 0.0);
  if (nm > 0) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(ix(block.freedoms()));
    for (std::size_t i = 0; i < block.mesh().nodes.size(); ++i) {
      x(ix(2 * i)) = block.mesh().nodes[i].x.x;
      x(ix(2 * i + 1)) = block.mesh().nodes[i].x.y;
    }
    const Eigen::VectorXd c = view(modes_.shapes).transpose() * (view(block.mass_matrix()) * x);
    centrifugal_.assign(c.begin(), c.end());
  }
  pin_shapes_.clear();
  for (const Pin& pin : setup_.pins) {
    std::vector<double> rx(nm, 0.0), ry(nm, 0.0);
    const Element& e = block.mesh().elements[pin.place.element];
    const auto s = shape(block.mesh().order, pin.place.s);
    for (std::size_t a = 0; a < block.mesh().per_element(); ++a) {
      for (std::size_t k = 0; k < nm; ++k) {
        rx[k] += s[a] * modes_.shapes(2 * e.node[a], k);
        ry[k] += s[a] * modes_.shapes(2 * e.node[a] + 1, k);
      }
    }
    pin_shapes_.push_back(std::move(rx));
    pin_shapes_.push_back(std::move(ry));
  }
}

/// Accelerations and pin forces of the state as it is: M a - J^T l = f, J a = -(J' v), after velocities are made to
/// agree with the pins. The body is undeformed since its operator was built.
void FreeMotion::start() {
  const BlockOperator& block = *block_;
  const std::size_t nm = modes_.eigenvalues.size();
  const std::size_t n = 3 + nm;
  const std::size_t nc = pin_force_.size();
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(ix(n + nc), ix(n + nc));
  Eigen::VectorXd b = Eigen::VectorXd::Zero(ix(n + nc));
  for (std::size_t i = 0; i < n; ++i) m(ix(i), ix(i)) = i < 2 ? block.mass() : (i == 2 ? block.inertia() : 1.0);
  std::vector<Vec2> arms;
  for (std::size_t p = 0; p < setup_.pins.size(); ++p) {
    const Element& e = block.mesh().elements[setup_.pins[p].place.element];
    const Vec2 r = rotated(e.at(setup_.pins[p].place.s), q_[2]);
    const Vec2 t = turned_left(r);
    arms.push_back(r);
    for (std::size_t c = 0; c < 2; ++c) {
      const auto row = ix(n + 2 * p + c);
      m(row, ix(c)) = 1;
      m(row, 2) = c == 0 ? t.x : t.y;
    }
    for (std::size_t k = 0; k < nm; ++k) {
      const Vec2 d = rotated({pin_shapes_[2 * p][k], pin_shapes_[2 * p + 1][k]}, q_[2]);
      m(ix(n + 2 * p), ix(3 + k)) = d.x;
      m(ix(n + 2 * p + 1), ix(3 + k)) = d.y;
    }
  }
  m.topRightCorner(ix(n), ix(nc)) = -m.bottomLeftCorner(ix(nc), ix(n)).transpose();
  const Eigen::PartialPivLU<Eigen::MatrixXd> solver{m};
  if (nc > 0) {
    for (std::size_t i = 0; i < n; ++i) b(ix(i)) = m(ix(i), ix(i)) * v_[i];
    const Eigen::VectorXd v = solver.solve(b);
    for (std::size_t i = 0; i < n; ++i) v_[i] = v(ix(i));
  }
  const auto f = loads_at(time(), q_, v_[2]);
  for (std::size_t i = 0; i < n; ++i) b(ix(i)) = f[i];
  for (std::size_t p = 0; p < arms.size(); ++p) {
    b(ix(n + 2 * p)) = v_[2] * v_[2] * arms[p].x;
    b(ix(n + 2 * p + 1)) = v_[2] * v_[2] * arms[p].y;
  }
  const Eigen::VectorXd s = solver.solve(b);
  a_.assign(s.begin(), s.begin() + static_cast<std::ptrdiff_t>(n));
  for (std::size_t c = 0; c < nc; ++c) pin_force_[c] = s(ix(n + c));
  pull_.assign(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < nc; ++c) pull_[i] += m(ix(n + c), ix(i)) * pin_force_[c];
  }
}

std::expected<void, MotionError> FreeMotion::rebuild() {
  const auto u = since_build();
  Eigen::VectorXd w = Eigen::VectorXd::Zero(ix(u.size()));
  for (std::size_t k = 0; k < modes_.eigenvalues.size(); ++k) w += v_[3 + k] * view(modes_.shapes).col(ix(k));
  for (InnerPoint& p : inner_) p.at += inner_state(*block_, p, u).displacement;
  if (!carried_) carried_.emplace(*block_);
  auto next = carried_->advance(*block_, u, setup_.rebuilding->build);
  if (!next) return std::unexpected(RebuildFailed{time(), next.error()});
  const double turning = block_->inertia() * v_[2];
  own_ = std::make_unique<BlockOperator>(*std::move(next));
  block_ = own_.get();
  for (std::size_t i = 0; i < u.size(); ++i) before_build_[i] += u[i];
  adopt();
  const std::size_t nm = modes_.eigenvalues.size();
  const auto shapes = view(modes_.shapes).transpose();
  const Eigen::Map<const Eigen::VectorXd> strained{carried_->strained().data(), ix(u.size())};
  const Eigen::VectorXd forces = shapes * (view(block_->stiffness()) * strained);
  const Eigen::VectorXd velocity = shapes * (view(block_->mass_matrix()) * w);
  q_.resize(3 + nm);
  v_.resize(3 + nm);
  for (std::size_t k = 0; k < nm; ++k) {
    q_[3 + k] = 0;
    v_[3 + k] = velocity(ix(k));
    internal_[k] = forces(ix(k));
  }
  v_[2] = turning / block_->inertia();
  for (TimedLoad& load : setup_.loads) {
    if (load.again) load.forces = load.again(*block_);
  }
  ++rebuilds_;
  start();
  return {};
}

std::vector<double> FreeMotion::loads_at(double time, const std::vector<double>& q, double spin) const {
  const std::size_t nm = modes_.eigenvalues.size();
  std::vector<double> f(3 + nm, 0.0);
  f[0] = block_->mass() * setup_.gravity.x;
  f[1] = block_->mass() * setup_.gravity.y;
  for (std::size_t k = 0; k < nm; ++k) f[3 + k] = spin * spin * centrifugal_[k] - internal_[k];
  const double angle = q[2];
  for (const TimedLoad& load : setup_.loads) {
    const double factor = load.factor(time);
    if (factor == 0) continue;
    for (std::size_t i = 0; i < block_->mesh().nodes.size(); ++i) {
      const Vec2 given = factor * Vec2{load.forces[2 * i], load.forces[2 * i + 1]};
      if (given == Vec2{}) continue;
      const Vec2 own = load.follows ? given : rotated(given, -angle);
      const Vec2 world = load.follows ? rotated(given, angle) : given;
      f[0] += world.x;
      f[1] += world.y;
      Vec2 x = block_->mesh().nodes[i].x;
      for (std::size_t k = 0; k < nm; ++k) {
        const Vec2 shape{modes_.shapes(2 * i, k), modes_.shapes(2 * i + 1, k)};
        x += q[3 + k] * shape;
        f[3 + k] += dot(shape, own);
      }
      f[2] += cross(x, own);
    }
  }
  return f;
}

namespace {

/// The equations of the pins at the position `q`: their derivatives into `jacobian`, how far each is off over `per`
/// into the end of `right`. Returns the largest distance.
double pin_rows(const Mesh& mesh, const auto& pins, const auto& shapes, const std::vector<double>& q, double per,
                Eigen::MatrixXd& jacobian, Eigen::VectorXd& right) {
  const std::size_t n = q.size();
  double gap = 0;
  for (std::size_t p = 0; p < pins.size(); ++p) {
    Vec2 r = mesh.elements[pins[p].place.element].at(pins[p].place.s);
    for (std::size_t k = 0; 3 + k < n; ++k) r += q[3 + k] * Vec2{shapes[2 * p][k], shapes[2 * p + 1][k]};
    const Vec2 world = rotated(r, q[2]);
    const Vec2 turned = turned_left(world);
    const Vec2 miss = Vec2{q[0], q[1]} + world - pins[p].anchor;
    gap = std::max(gap, norm(miss));
    jacobian(ix(2 * p), 0) = jacobian(ix(2 * p + 1), 1) = 1;
    jacobian(ix(2 * p), 2) = turned.x;
    jacobian(ix(2 * p + 1), 2) = turned.y;
    for (std::size_t k = 0; 3 + k < n; ++k) {
      const Vec2 d = rotated({shapes[2 * p][k], shapes[2 * p + 1][k]}, q[2]);
      jacobian(ix(2 * p), ix(3 + k)) = d.x;
      jacobian(ix(2 * p + 1), ix(3 + k)) = d.y;
    }
    right(ix(n + 2 * p)) = -miss.x / per;
    right(ix(n + 2 * p + 1)) = -miss.y / per;
  }
  return gap;
}

/// A step of Newton's method on accelerations and pin forces. Masses are diagonal, so the pin forces come first:
/// c J D^-1 J^T f = r_pins - J D^-1 r, with c = `share`.
void correct(const Eigen::VectorXd& diagonal, const Eigen::MatrixXd& jacobian, double share,
             const Eigen::VectorXd& right, std::vector<double>& a, std::vector<double>& force) {
  if (force.empty()) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] += right(ix(i)) / diagonal(ix(i));
    return;
  }
  const Eigen::MatrixXd spread = diagonal.cwiseInverse().asDiagonal() * jacobian.transpose();
  const Eigen::VectorXd alone = diagonal.cwiseInverse().asDiagonal() * right.head(ix(a.size()));
  const Eigen::MatrixXd matrix = share * jacobian * spread;
  const Eigen::VectorXd more = matrix.partialPivLu().solve(right.tail(ix(force.size())) - jacobian * alone);
  const Eigen::VectorXd d = alone + share * spread * more;
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += d(ix(i));
  for (std::size_t c = 0; c < force.size(); ++c) force[c] += more(ix(c));
}

}  // namespace

std::expected<void, MotionError> FreeMotion::advance() {
  const std::size_t nm = modes_.eigenvalues.size();
  const std::size_t n = 3 + nm;
  const std::size_t nc = pin_force_.size();
  const double h = setup_.step;
  const AlphaNumbers g = numbers_of(setup_.scheme);
  const double now = time();
  const auto mass_of = [&](std::size_t i) { return i < 2 ? block_->mass() : (i == 2 ? block_->inertia() : 1.0); };
  const auto stiffness_of = [&](std::size_t i) { return i < 3 ? 0.0 : modes_.eigenvalues[i - 3]; };
  const auto drag_of = [&](std::size_t i) {
    if (i < 3) return 0.0;
    const double l = modes_.eigenvalues[i - 3];
    return setup_.damping.alpha + setup_.damping.beta * l + 2 * setup_.damping.share * std::sqrt(l);
  };
  const std::vector<double> f0 = loads_at(now, q_, v_[2]);
  std::vector<double> a = a_, q(n), v(n);
  std::vector<double> force = pin_force_;
  std::vector<double> residual(n + nc), pull(n, 0.0);
  Eigen::VectorXd right(ix(n + nc));
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(ix(nc), ix(n));
  // What forces are measured by: weight, inertia, and loads even where they balance each other.
  double weight = block_->mass() * (norm(setup_.gravity) + norm({a_[0], a_[1]})) + 1e-300;
  for (const TimedLoad& load : setup_.loads) {
    double sum = 0;
    for (const double f : load.forces) sum += std::abs(f);
    weight += sum * std::max(std::abs(load.factor(now)), std::abs(load.factor(now + h)));
  }
  constexpr std::size_t most = 30;
  for (std::size_t pass = 0;; ++pass) {
    for (std::size_t i = 0; i < n; ++i) {
      q[i] = q_[i] + h * v_[i] + h * h * ((0.5 - g.beta) * a_[i] + g.beta * a[i]);
      v[i] = v_[i] + h * ((1 - g.gamma) * a_[i] + g.gamma * a[i]);
    }
    const std::vector<double> f1 = loads_at(now + h, q, v[2]);
    std::ranges::fill(pull, 0.0);
    const double gap = pin_rows(block_->mesh(), setup_.pins, pin_shapes_, q, g.beta * h * h, jacobian, right);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t c = 0; c < nc; ++c) pull[i] += jacobian(ix(c), ix(i)) * force[c];
    }
    double worst = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double inertial = mass_of(i) * ((1 - g.am) * a[i] + g.am * a_[i]);
      const double elastic = stiffness_of(i) * ((1 - g.af) * q[i] + g.af * q_[i]) * (i < 3 ? 0.0 : 1.0);
      const double drag = drag_of(i) * ((1 - g.af) * v[i] + g.af * v_[i]);
      right(ix(i)) = -(inertial + elastic + drag - (1 - g.af) * (f1[i] + pull[i]) - g.af * (f0[i] + pull_[i]));
      const double scale = weight + std::abs(inertial) + std::abs(elastic);
      worst = std::max(worst, std::abs(right(ix(i))) / scale);
    }
    most_iterations_ = std::max(most_iterations_, pass);
    const double size = std::sqrt(block_->area()) + norm({q[0], q[1]});
    if (pass > 0 && worst < 1e-11 && gap < 1e-14 * size + 1e-300) break;
    if (pass >= most) {
      // Rounding may stop it a little above: accept what is as good as the arithmetic.
      if (worst < 1e-8 && gap < 1e-12 * size) break;
      return std::unexpected(NotConverged{now + h, worst});
    }
    Eigen::VectorXd diagonal(ix(n));
    for (std::size_t i = 0; i < n; ++i) {
      diagonal(ix(i)) =
          (1 - g.am) * mass_of(i) + (1 - g.af) * (h * h * g.beta * stiffness_of(i) + h * g.gamma * drag_of(i));
    }
    correct(diagonal, jacobian, 1 - g.af, right, a, force);
  }
  q_ = std::move(q);
  v_ = std::move(v);
  a_ = std::move(a);
  pin_force_ = std::move(force);
  pull_ = std::move(pull);
  ++steps_;
  if (steep_.empty()) return {};
  double bound = 0;
  for (std::size_t k = 0; k < nm; ++k) bound += std::abs(q_[3 + k]) * steep_[k];
  if (bound <= std::max(seen_, 0.5 * setup_.rebuilding->gradient)) return {};
  const double steep = steepest(*block_, since_build());
  seen_ = std::max(seen_, steep);
  return steep > setup_.rebuilding->gradient ? rebuild() : std::expected<void, MotionError>{};
}

Vec2 FreeMotion::centroid() const noexcept { return {q_[0], q_[1]}; }

Vec2 FreeMotion::position(BoundaryPlace place) const {
  const Element& e = block_->mesh().elements[place.element];
  Vec2 x = e.at(place.s);
  const auto s = shape(block_->mesh().order, place.s);
  for (std::size_t a = 0; a < block_->mesh().per_element(); ++a) {
    for (std::size_t k = 0; k < modes_.eigenvalues.size(); ++k) {
      x += (s[a] * q_[3 + k]) * Vec2{modes_.shapes(2 * e.node[a], k), modes_.shapes(2 * e.node[a] + 1, k)};
    }
  }
  return centroid() + rotated(x, q_[2]);
}

std::vector<double> FreeMotion::since_build() const {
  return expanded(modes_, std::span{q_}.subspan(3), block_->freedoms());
}

std::vector<double> FreeMotion::deformation() const {
  auto out = since_build();
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += before_build_[i];
  return out;
}

std::vector<double> FreeMotion::strained() const {
  auto out = since_build();
  for (std::size_t i = 0; carried_ && i < out.size(); ++i) out[i] += carried_->strained()[i];
  return out;
}

double FreeMotion::relative_deformation() const {
  double largest = 0;
  const auto u = deformation();
  for (std::size_t i = 0; i < block_->boundary_freedoms(); i += 2) largest = std::max(largest, norm({u[i], u[i + 1]}));
  return largest / std::sqrt(block_->area());
}

Energy FreeMotion::energy() const {
  Energy e;
  e.kinetic = 0.5 * block_->mass() * (v_[0] * v_[0] + v_[1] * v_[1]) + 0.5 * block_->inertia() * v_[2] * v_[2];
  for (std::size_t k = 0; k < modes_.eigenvalues.size(); ++k) {
    e.kinetic += 0.5 * v_[3 + k] * v_[3 + k];
    e.elastic += 0.5 * modes_.eigenvalues[k] * q_[3 + k] * q_[3 + k] + internal_[k] * q_[3 + k];
  }
  if (carried_) e.elastic += energy_of(*block_, carried_->strained());
  e.gravity = -block_->mass() * dot(setup_.gravity, centroid());
  return e;
}

Vec2 FreeMotion::momentum() const noexcept { return block_->mass() * Vec2{v_[0], v_[1]}; }

double FreeMotion::angular_momentum() const noexcept {
  return block_->inertia() * v_[2] + cross(Vec2{q_[0], q_[1]}, momentum());
}

std::size_t FreeMotion::follow(Vec2 inside) {
  CLEAVE_ASSERT(rebuilds_ == 0);
  inner_.push_back({inside, inside});
  return inner_.size() - 1;
}

InnerState FreeMotion::inner(std::size_t point) const {
  const InnerPoint& p = inner_[point];
  InnerState out = inner_state(*block_, p, since_build());
  if (rebuilds_ > 0) {
    out.displacement += p.at - p.reference;
    out.stress = inner_state(*block_, p, strained()).stress;
  }
  return out;
}

}  // namespace cleave::bem
