#include "judge.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace cleave::motion {

using Eigen::Vector3d;

Response respond(const Group& group, const std::vector<Vector3d>& impulse) {
  Response out;
  std::vector<Vector6> given(group.mass.size(), Vector6::Zero());
  for (std::size_t k = 0; k < impulse.size(); ++k) {
    const Point& p = group.points[k];
    given[p.body] += p.on_body * impulse[k];
    if (p.other) given[*p.other] += p.on_other * impulse[k];
  }
  std::vector<Matrix6> inverse;
  inverse.reserve(group.mass.size());
  for (std::size_t b = 0; b < group.mass.size(); ++b) {
    inverse.emplace_back(group.mass[b].llt().solve(Matrix6::Identity()));
    given[b] = (inverse[b] * given[b]).eval();
    out.velocity.push_back(group.free[b] + given[b]);
  }
  for (const Point& p : group.points) {
    Vector3d diagonal = p.on_body.cwiseProduct(inverse[p.body] * p.on_body).colwise().sum().transpose();
    Vector3d own = p.b + p.on_body.transpose() * group.free[p.body];
    Vector3d made = p.on_body.transpose() * given[p.body];
    if (p.other) {
      diagonal += p.on_other.cwiseProduct(inverse[*p.other] * p.on_other).colwise().sum().transpose();
      own += p.on_other.transpose() * group.free[*p.other];
      made += p.on_other.transpose() * given[*p.other];
    }
    out.diagonal.push_back(diagonal);
    out.from_impulse.push_back(made);
    out.y.push_back(own + made);
  }
  return out;
}
namespace {

/// p - P(p - r y) of one point.
Vector3d natural(const Point& point, const Vector3d& diagonal, const Vector3d& y, const Vector3d& p) {
  if (point.shear) {
    Eigen::Vector2d t = p.tail<2>() - 2 / (diagonal[1] + diagonal[2]) * y.tail<2>();
    if (const double length = t.norm(); length > point.cohesion) t *= point.cohesion / length;
    return {p[0], p[1] - t[0], p[2] - t[1]};
  }
  if (point.axial) return {p[0] - std::clamp(p[0] - y[0] / diagonal[0], 0.0, point.most), p[1], p[2]};
  const double tension = point.mu > 0 ? std::min(point.tension, point.cohesion / point.mu) : point.tension;
  const double a = p[0] - y[0] / diagonal[0];
  const bool closed = a > -tension;
  const double n = closed ? a : -tension;
  const double bound = closed || tension > 0 ? std::max(0.0, point.mu * n + point.cohesion) : 0;
  Eigen::Vector2d t = p.tail<2>() - 2 / (diagonal[1] + diagonal[2]) * y.tail<2>();
  if (const double length = t.norm(); length > bound) t *= bound / length;
  Vector3d out;
  out << p[0] - n, p.tail<2>() - t;
  return out;
}
}  // namespace

Judged judge(const Group& group, const std::vector<Vector3d>& impulse, const Response& response) {
  double off = 0, off_speed = 0, force = 0, speed = 0, made = 0;
  for (std::size_t k = 0; k < impulse.size(); ++k) {
    const Vector3d f = natural(group.points[k], response.diagonal[k], response.y[k], impulse[k]);
    const Vector3d b = response.y[k] - response.from_impulse[k];
    const Vector3d diagonal = response.diagonal[k].cwiseMax(1e-300);  // none along the normal of shear alone
    off = std::max(off, f.lpNorm<Eigen::Infinity>());
    off_speed = std::max(off_speed, f.cwiseProduct(response.diagonal[k]).lpNorm<Eigen::Infinity>());
    force =
        std::max({force, impulse[k].lpNorm<Eigen::Infinity>(), b.cwiseQuotient(diagonal).lpNorm<Eigen::Infinity>()});
    speed = std::max(speed, b.lpNorm<Eigen::Infinity>());
    made = std::max(made, response.from_impulse[k].lpNorm<Eigen::Infinity>());
  }
  const double scale = std::max(speed, 1e-6 * made);
  if (!(force > 0) || !(scale > 0)) return {};
  return {std::max(off / force, off_speed / scale), off_speed};
}
double natural_residual(const Group& group, const std::vector<Vector3d>& impulse) {
  return judge(group, impulse, respond(group, impulse)).residual;
}

double cone_residual(const Group& group, const std::vector<Vector3d>& impulse) {
  const Response response = respond(group, impulse);
  double most = 0, off = 0, force = 1e-300;
  for (const Vector3d& d : response.diagonal) most = std::max(most, d.maxCoeff());
  for (std::size_t k = 0; k < impulse.size(); ++k) {
    const double mu = group.points[k].mu;
    Vector3d z = response.y[k];
    z[0] += mu * z.tail<2>().norm();
    z = impulse[k] - z / most;
    const double t = z.tail<2>().norm();
    if (mu * t <= -z[0]) {
      z.setZero();
    } else if (t > mu * z[0]) {
      const double n = (z[0] + mu * t) / (1 + mu * mu);
      z << n, mu * n / t * z.tail<2>();
    }
    off = std::max(off, (impulse[k] - z).lpNorm<Eigen::Infinity>());
    force = std::max(force, impulse[k].lpNorm<Eigen::Infinity>());
  }
  return off / force;
}

}  // namespace cleave::motion
