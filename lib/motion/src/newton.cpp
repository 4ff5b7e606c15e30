#include "newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cleave::motion {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

Scaled::Scaled(const Group& group) : bodies{group.mass.size()} {
  std::vector<Matrix6> half;  // inverse of the factor of the mass
  half.reserve(bodies);
  for (const Matrix6& m : group.mass) half.emplace_back(m.llt().matrixL().solve(Matrix6::Identity()));
  elements.reserve(group.points.size());
  for (const Point& p : group.points) {
    Element e{p.body, p.other, p.on_body, p.on_other, p.b, p.mu, p.cohesion, p.tension, 1, p.shear, p.most};
    e.y += p.on_body.transpose() * group.free[p.body];
    e.on_body = (half[p.body] * e.on_body).eval();
    double square = e.on_body.squaredNorm();
    if (p.other) {
      e.y += p.on_other.transpose() * group.free[*p.other];
      e.on_other = (half[*p.other] * e.on_other).eval();
      square += e.on_other.squaredNorm();
    }
    e.scale = 1 / std::sqrt(square / 3);
    e.on_body *= e.scale;
    e.on_other *= e.scale;
    e.y *= e.scale;
    unit = std::max(unit, e.y.lpNorm<Eigen::Infinity>());
    elements.push_back(e);
  }
  if (!(unit > 0)) return;
  for (Element& e : elements) {
    e.y /= unit;
    e.scale *= unit;
    e.cohesion /= e.scale;
    e.tension /= e.scale;
    e.most /= e.scale;
    e.tension = e.mu > 0 ? std::min(e.tension, e.cohesion / e.mu) : e.tension;
  }
}

Vector3d Scaled::relative(const Element& e, const VectorXd& v) const {
  Vector3d u = e.y;
  u.noalias() += e.on_body.transpose() * v.segment<6>(row(e.body));
  if (e.other) u.noalias() += e.on_other.transpose() * v.segment<6>(row(*e.other));
  return u;
}

Vector3d Scaled::change(const Element& e, const VectorXd& dv) {
  Vector3d du = e.on_body.transpose() * dv.segment<6>(row(e.body));
  if (e.other) du += e.on_other.transpose() * dv.segment<6>(row(*e.other));
  return du;
}

void Scaled::add(const Element& e, const Vector3d& x, VectorXd& v) const {
  v.segment<6>(row(e.body)).noalias() += e.on_body * x;
  if (e.other) v.segment<6>(row(*e.other)).noalias() += e.on_other * x;
}

namespace {

bool is_symmetric(const Eigen::Matrix3d& m) { return m == m.transpose(); }

void held_in_disc(const Vector2d& t, double radius, linear::Projection& out) {
  linear::onto_disc(t, radius, out);
  out.any = out.any || radius > 0 || t.norm() <= radius;
}

}  // namespace

Newton::Newton(const Scaled& scaled) : scaled_{&scaled}, system_{scaled.bodies, 6, linear::links_of(scaled.elements)} {}

Newton::Local Newton::project(const Programme& programme, std::size_t k, const Vector3d& w) const {
  const Scaled::Element& e = scaled_->elements[k];
  Local out;
  if (e.shear) {
    if (programme.law != Law::frictionless) held_in_disc(w.tail<2>(), e.cohesion, out);
    return out;
  }
  if (programme.law == Law::cone && e.mu > 0) {
    out = linear::onto_cone(w, e.mu, e.cohesion / e.mu);
    // The apex of a bond that is weaker in tension is cut off.
    if (out.x[0] < -e.tension) {
      out = {};
      out.x[0] = -e.tension;
      held_in_disc(w.tail<2>(), e.cohesion - e.mu * e.tension, out);
    }
    return out;
  }
  if (w[0] >= e.most) {
    out.x[0] = e.most;
    return out;
  }
  const bool closed = w[0] > -e.tension;
  out.x[0] = closed ? w[0] : -e.tension;
  if (closed) {
    out.slope(0, 0) = 1;
    out.any = true;
  }
  switch (programme.law) {
    case Law::frictionless: break;
    case Law::tresca: held_in_disc(w.tail<2>(), programme.given[k], out); break;
    case Law::cone: held_in_disc(w.tail<2>(), e.cohesion, out); break;
    case Law::coulomb: {
      const double radius = closed                            ? e.mu * out.x[0] + e.cohesion
                            : e.cohesion > 0 && e.tension > 0 ? e.cohesion - e.mu * e.tension
                                                              : 0;
      const double length = w.tail<2>().norm();
      held_in_disc(w.tail<2>(), radius, out);
      if (closed && length > radius && e.mu > 0) out.slope.bottomLeftCorner<2, 1>() = e.mu / length * w.tail<2>();
      break;
    }
  }
  return out;
}

double Newton::evaluate(const Programme& programme, const std::vector<Vector3d>& centre, double rho, const VectorXd& v,
                        VectorXd& gradient, std::vector<Local>& locals) const {
  gradient = v;
  double value = 0.5 * v.squaredNorm();
  VectorXd forces = VectorXd::Zero(v.size());
  for (std::size_t k = 0; k < locals.size(); ++k) {
    const Scaled::Element& e = scaled_->elements[k];
    Vector3d u = scaled_->relative(e, v);
    if (programme.law == Law::cone) u[0] += e.mu * programme.given[k];
    const Vector3d w = centre[k] - u / rho;
    locals[k] = project(programme, k, w);
    scaled_->add(e, locals[k].x, forces);
    value += rho * (w.dot(locals[k].x) - 0.5 * locals[k].x.squaredNorm());
  }
  gradient -= forces;
  return value;
}

bool Newton::factorise(const std::vector<Local>& locals, double rho, bool symmetric) {
  system_.clear(symmetric);
  for (std::size_t k = 0; k < locals.size(); ++k) {
    if (locals[k].any) system_.add_element(scaled_->elements[k], locals[k].slope / rho);
  }
  return system_.factorise();
}

bool Newton::direction(const std::vector<Local>& locals, double rho, const VectorXd& gradient, VectorXd& step) {
  // Where nothing slips with friction, half of the work does. Rounding may cost a pivot its sign; rows in another
  // order bear that.
  const bool symmetric = std::ranges::all_of(locals, [](const Local& l) { return !l.any || is_symmetric(l.slope); });
  if (!(symmetric && factorise(locals, rho, true)) && !factorise(locals, rho, false)) return false;
  step = -gradient;
  system_.solve(step);
  return step.allFinite();
}

namespace {

/// What rounding may leave of the residual: of G x where forces are large, and of the velocities at contacts where the
/// weight is small, as forces follow them by 1 / rho.
double rounding_of(const std::vector<linear::Projection>& locals, double rho, const VectorXd& v) {
  double carried = 1;
  bool any = false;
  for (const linear::Projection& l : locals) {
    carried = std::max(carried, l.x.lpNorm<Eigen::Infinity>());
    any = any || l.any;
  }
  const double followed =
      any ? std::sqrt(static_cast<double>(locals.size())) * (1 + v.lpNorm<Eigen::Infinity>()) / rho : 0;
  return std::numeric_limits<double>::epsilon() * (8 * carried + followed);
}

}  // namespace

double Newton::inner(const Programme& programme, std::vector<Vector3d>& x, double rho, VectorXd& v) {
  const bool convex = programme.law != Law::coulomb;
  std::vector<Local> locals(x.size()), tried_locals(x.size());
  VectorXd gradient, tried_gradient, step, tried;
  double value = evaluate(programme, x, rho, v, gradient, locals);
  double size = gradient.norm();
  int stuck = 0;
  for (int iteration = 0; iteration < (convex ? 100 : 30); ++iteration) {
    // Rounding is mostly far less than that; a search for what is below it would only cost.
    const double rounding = rounding_of(locals, rho, v);
    const bool is_near = size <= rounding;
    if (size <= 0.03 * rounding) break;
    if (!direction(locals, rho, gradient, step)) return std::numeric_limits<double>::infinity();
    const double slope = gradient.dot(step);
    const linear::Search how{.convex = convex, .rounding = 1e-13 * std::abs(value), .halvings = is_near ? 2 : 20};
    double tried_share = 0, tried_value = 0;
    const double share = linear::share_of_step({value, size}, slope, how, [&](double part) {
      tried_share = part;
      tried = v + part * step;
      tried_value = evaluate(programme, x, rho, tried, tried_gradient, tried_locals);
      return linear::Merit{tried_value, tried_gradient.norm()};
    });
    if (!(share > 0)) break;
    if (share == tried_share) {
      std::swap(v, tried);
      std::swap(gradient, tried_gradient);
      std::swap(locals, tried_locals);
      value = tried_value;
    } else {
      v += share * step;
      value = evaluate(programme, x, rho, v, gradient, locals);
    }
    const double before = std::exchange(size, gradient.norm());
    stuck = size > 0.5 * before && size < 1e-9 ? stuck + 1 : 0;
    if (stuck > 3 || (is_near && size > 0.5 * before)) break;
  }
  for (std::size_t k = 0; k < locals.size(); ++k) x[k] = locals[k].x;
  return size;
}

double Newton::solve(const Programme& programme, std::vector<Vector3d>& x, const Schedule& schedule) {
  VectorXd v = VectorXd::Zero(6 * static_cast<Index>(scaled_->bodies));
  for (std::size_t k = 0; k < x.size(); ++k) scaled_->add(scaled_->elements[k], x[k], v);
  // Forces that grow far before they hold, as under a heavy body, need less weight than others; where weights are too
  // small rounding takes over. The best answer at the end counts.
  constexpr double enough = 1e-12;
  double least = std::numeric_limits<double>::infinity(), least_change = least;
  double rho = schedule.rough, fine = schedule.fine;
  std::vector<Vector3d> best;
  for (int round = 0, at_fine = 0; round < 400; ++round) {
    const std::vector<Vector3d> old = x;
    const double off = inner(programme, x, rho, v);
    if (!(off < 1e-6)) break;
    double change = 0;
    for (std::size_t k = 0; k < x.size(); ++k) change = std::max(change, (x[k] - old[k]).lpNorm<Eigen::Infinity>());
    const double hidden = std::max(rho * change, off);
    if (rho > 1.001 * fine) {
      if ((round + 1) % schedule.recentrings == 0) rho = std::max(fine, schedule.fall * rho);
      continue;
    }
    // Forces may still come nearer where rounding hides it in the velocities.
    const bool nearer = rho * change < 0.5 * least_change && hidden < 2 * least;
    const bool better = hidden < 0.5 * least || nearer;
    if (hidden < least || nearer) best = x;
    least = std::min(least, hidden);
    least_change = std::min(least_change, rho * change);
    if (hidden <= enough) break;
    if (better && ++at_fine < schedule.last) continue;
    if (fine <= schedule.finest || least <= 100 * enough) break;
    rho = fine = std::max(schedule.finest, 0.1 * fine);
    at_fine = 0;
  }
  if (!best.empty()) x = std::move(best);
  return least;
}

}  // namespace cleave::motion
