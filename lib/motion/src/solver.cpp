#include "solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "cascade.hpp"
#include "interior.hpp"
#include "judge.hpp"
#include "newton.hpp"

namespace cleave::motion {
namespace {

using Eigen::Vector3d;
using Status = SolveReport::Status;

void count_states(const Group& group, const Response& response, Solution& solution) {
  SolveReport& report = solution.report;
  for (std::size_t k = 0; k < solution.impulse.size(); ++k) {
    const Vector3d& p = solution.impulse[k];
    const Point& point = group.points[k];
    report.max_penetration = std::max(report.max_penetration, -response.y[k][0]);
    if (p.isZero()) {
      ++report.opened;
    } else if (point.axial) {
      ++(p[0] < point.most ? report.stick : report.slip);
    } else if (p.tail<2>().norm() >= (1 - 1e-9) * (point.mu * p[0] + point.cohesion)) {
      ++report.slip;
    } else {
      ++report.stick;
    }
  }
}

}  // namespace

Solution solve(const Group& group, const SolverOptions& options) {
  const std::vector<Vector3d> nothing(group.points.size(), Vector3d::Zero());
  Response response = respond(group, nothing);
  Solution out;
  const bool open = std::ranges::all_of(response.y, [](const Vector3d& y) { return y[0] >= 0; }) &&
                    std::ranges::all_of(group.points, [](const Point& p) { return p.cohesion <= 0 && p.tension <= 0; });
  if (open) {
    out.impulse = nothing;
    out.velocity = std::move(response.velocity);
    out.report.opened = nothing.size();
    return out;
  }
  out = best_answer(group, options);
  response = respond(group, out.impulse);
  out.velocity = response.velocity;
  out.report.residual = judge(group, out.impulse, response).residual;
  // Comparisons are false for what is no number.
  out.report.status = out.report.residual <= options.accept     ? Status::converged
                      : out.report.residual <= options.tolerate ? Status::rough
                                                                : Status::not_converged;
  count_states(group, response, out);
  return out;
}

Solution solve_softly(const Group& group, double weight) {
  Solution out;
  out.impulse.assign(group.points.size(), Vector3d::Zero());
  const Scaled scaled{group};
  if (scaled.unit > 0) {
    Interior interior{scaled};
    (void)interior.solve(out.impulse, {.weight = weight});
    for (std::size_t k = 0; k < out.impulse.size(); ++k) out.impulse[k] *= scaled.elements[k].scale;
    out.report.method = Method::interior;
    out.report.iterations = interior.factors();
  }
  Response response = respond(group, out.impulse);
  const Judged judged = judge(group, out.impulse, response);
  out.report.residual = judged.residual;
  out.report.missed_speed = judged.missed;
  out.report.status = Status::rough;
  out.velocity = std::move(response.velocity);
  count_states(group, response, out);
  return out;
}

Frame frame_of(Vec3 n) noexcept {
  const double s = n.z >= 0 ? 1 : -1;
  const double a = -1 / (s + n.z), b = n.x * n.y * a;
  return {n, {1 + s * n.x * n.x * a, s * b, -s * n.x}, {b, s + n.y * n.y * a, -n.y}};
}

Rows rows_of(const Frame& frame, Vec3 arm) noexcept {
  Rows out;
  Eigen::Index column = 0;
  for (const Vec3 d : {frame.n, frame.t1, frame.t2}) {
    const Vec3 m = cross(arm, d);
    out.col(column++) << d.x, d.y, d.z, m.x, m.y, m.z;
  }
  return out;
}

}  // namespace cleave::motion
