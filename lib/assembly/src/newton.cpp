#include "newton.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cleave::assembly {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Rates below are none: free fall has about 1.
constexpr double at_rest = 1e-14;

void held_in_disc(const Vector2d& t, double radius, linear::Projection& out) {
  linear::onto_disc(t, radius, out);
  out.any = out.any || radius > 0;
}

}  // namespace

/// Projection of w on what an element can carry; Moreau's envelope is what it is the gradient of.
Newton::Local Newton::local(const Problem& problem, std::size_t k, const Vector3d& w) const {
  const Element& e = elements_->all()[k];
  Local out;
  if (e.bond) {
    if (problem.law == Law::frictionless) return out;
    const bool holds = problem.pressing.empty() || problem.pressing[k] != 0;
    const double tension = e.tension / problem.divisor;
    out.x[0] = std::clamp(w[0], -tension, 0.0);
    if (w[0] < 0 && w[0] > -tension) {
      out.slope(0, 0) = 1;
      out.any = true;
    }
    held_in_disc(w.tail<2>(), holds ? e.cohesion / problem.divisor : 0, out);
    return out;
  }
  const double mu = e.friction / problem.divisor;
  if (problem.law == Law::cone && mu > 0) return linear::onto_cone(w, mu, 0);
  if (w[0] > problem.least_normal) {
    out.x[0] = w[0];
    out.slope(0, 0) = 1;
    out.any = true;
  } else {
    out.x[0] = problem.least_normal;
  }
  switch (problem.law) {
    case Law::frictionless:
    case Law::cone: break;
    case Law::tresca: held_in_disc(w.tail<2>(), problem.threshold[k], out); break;
    case Law::coulomb: {
      const double radius = mu * out.x[0];
      held_in_disc(w.tail<2>(), radius, out);
      const double length = w.tail<2>().norm();
      if (length > radius && w[0] > 0 && mu > 0) out.slope.bottomLeftCorner<2, 1>() = mu / length * w.tail<2>();
      break;
    }
  }
  return out;
}

Newton::Newton(const Elements& elements)
    : elements_{&elements}, system_{elements.bodies(), elements.width(), linear::links_of(elements.all())} {}

State Newton::none() const {
  return {VectorXd::Zero(elements_->load().size()), std::vector<Vector3d>(elements_->all().size(), Vector3d::Zero())};
}

double Newton::evaluate(const Problem& problem, const State& at, double rho, const VectorXd& v, VectorXd& gradient,
                        std::vector<Local>* locals) const {
  gradient = -elements_->load();
  double value = 0.5 * v.squaredNorm() - elements_->load().dot(v);
  VectorXd forces = VectorXd::Zero(v.size());
  for (std::size_t k = 0; k < elements_->all().size(); ++k) {
    const Element& e = elements_->all()[k];
    Vector3d u = elements_->relative(e, v);
    if (!problem.slid.empty() && !e.bond) u[0] += e.friction / problem.divisor * problem.slid[k];
    const Vector3d w = at.x[k] - u / rho;
    const Local own = local(problem, k, w);
    elements_->add_force(e, own.x, forces);
    // Moreau's envelope: (|w|^2 - |w - P w|^2) / 2 = w.P w - |P w|^2 / 2.
    value += rho * (w.dot(own.x) - 0.5 * own.x.squaredNorm());
    if (locals != nullptr) (*locals)[k] = own;
  }
  gradient += v - forces;
  return value;
}

bool Newton::direct(const std::vector<Local>& locals, double rho, bool symmetric, const VectorXd& gradient,
                    VectorXd& step) {
  const Index w = elements_->width();
  system_.clear(symmetric);
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
  const std::vector<Element>& all = elements_->all();
  for (std::size_t first = 0; first < all.size();) {
    const Element& lead = all[first];
    Block own = Block::Zero(w, w), other = own, cross = own, back = own;
    bool any = false;
    std::size_t k = first;
    for (; k < all.size() && all[k].contact == lead.contact; ++k) {
      if (!locals[k].any) continue;
      any = true;
      const Rows left = all[k].on_body * (locals[k].slope / rho);
      own.noalias() += left * all[k].on_body.transpose();
      if (!lead.other) continue;
      const Rows right = all[k].on_other * (locals[k].slope / rho);
      other.noalias() += right * all[k].on_other.transpose();
      cross.noalias() += left * all[k].on_other.transpose();
      back.noalias() += right * all[k].on_body.transpose();
    }
    first = k;
    if (!any) continue;
    system_.add(lead.body, lead.body, own);
    if (!lead.other) continue;
    system_.add(*lead.other, *lead.other, other);
    system_.add(lead.body, *lead.other, cross);
    system_.add(*lead.other, lead.body, back);
  }
  step = -gradient;
  if (!system_.factorise()) return false;
  system_.solve(step);
  return step.allFinite();
}

double Newton::inner(const Problem& problem, State& state, double rho) {
  const bool convex = problem.law != Law::coulomb;
  std::vector<Local> locals(elements_->all().size());
  VectorXd gradient, tried_gradient, step, tried;
  double value = evaluate(problem, state, rho, state.v, gradient, &locals);
  double size = gradient.lpNorm<Eigen::Infinity>();
  const double enough = std::max(1e-15, 1e-16 * state.v.lpNorm<Eigen::Infinity>() / rho);
  int stuck = 0;
  for (int iteration = 0; iteration < (convex ? 80 : 30) && size > enough; ++iteration) {
    if (!direct(locals, rho, convex, gradient, step)) break;
    const double slope = gradient.dot(step);
    const double rounding = 1e-13 * (std::abs(value) + std::abs(elements_->load().dot(state.v)));
    const linear::Search how{.convex = convex, .rounding = rounding, .halvings = 30};
    const double share = linear::share_of_step({value, size}, slope, how, [&](double part) {
      tried = state.v + part * step;
      const double found = evaluate(problem, state, rho, tried, tried_gradient, nullptr);
      return linear::Merit{found, tried_gradient.lpNorm<Eigen::Infinity>()};
    });
    if (!(share > 0)) break;
    state.v += share * step;
    value = evaluate(problem, state, rho, state.v, gradient, &locals);
    const double before = std::exchange(size, gradient.lpNorm<Eigen::Infinity>());
    stuck = size > 0.5 * before && size < 1e-9 ? stuck + 1 : 0;
    if (stuck > 3) break;
  }
  for (std::size_t k = 0; k < locals.size(); ++k) state.x[k] = locals[k].x;
  return size;
}

Settled Newton::solve(const Problem& problem, State& state, double rough) {
  Settled result;
  const unsigned before = factors();
  // Forces that grow far before they hold need less weight; where rates are large that would cost their digits.
  constexpr double fine = 1e-5, finest = 1e-13;
  const bool far = problem.law == Law::cone || problem.law == Law::frictionless;
  double rho = rough, last = 1;
  int idle = 0;
  for (int outer = 0; outer < 100; ++outer) {
    const std::vector<Vector3d> old = state.x;
    result.off = inner(problem, state, rho);
    if (problem.law == Law::coulomb && result.off > 1e-6) break;  // not convex, and lost
    double change = 0;
    for (std::size_t k = 0; k < old.size(); ++k) {
      change = std::max(change, (state.x[k] - old[k]).lpNorm<Eigen::Infinity>());
    }
    result.violation = rho * change;
    const double speed = state.v.lpNorm<Eigen::Infinity>();
    if (speed < at_rest) break;
    const double fall = last > 0 ? result.violation / last : 0;
    last = result.violation;
    if (rho > 1.01 * fine) {
      rho = std::max(fine, 0.1 * rho);
      continue;
    }
    if (result.violation <= (far ? 2e-16 : 1e-15) * speed) break;
    if (fall > 0.2) rho = std::max({finest, far ? 0 : 1e-8 * speed, (fall > 0.8 ? 0.01 : 0.1) * rho});
    idle = fall > 0.5 ? idle + 1 : 0;
    if (idle > 14) break;
  }
  // Small weights cost digits of balance where rates are large: back.
  if (rho < 1e-3 * fine && state.v.lpNorm<Eigen::Infinity>() > at_rest) result.off = inner(problem, state, fine);
  result.factors = factors() - before;
  return result;
}

}  // namespace cleave::assembly
