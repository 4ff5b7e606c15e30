#include <algorithm>
#include <cmath>
#include <limits>

#include "suite.hpp"

namespace cleave::contact_suite {

double judge(const dbem::ContactProblem& problem, const std::vector<dbem::Vec2>& impulse) {
  const std::size_t m = problem.b.size();
  if (impulse.size() != m) return std::numeric_limits<double>::infinity();
  double worst = 0, scale = 1e-300;        // impulses
  double worst_speed = 0, speed = 1e-300;  // the same as velocities, where a light body beside a heavy one shows
  for (std::size_t r = 0; r < m; ++r) {
    double g = problem.b[r].x, s = problem.b[r].y, w_n = 0, w_t = 0;
    for (std::size_t at = problem.w.starts[r]; at < problem.w.starts[r + 1]; ++at) {
      const std::size_t c = problem.w.columns[at];
      const auto& w = problem.w.values[at];
      g += w.xx * impulse[c].x + w.xy * impulse[c].y;
      s += w.yx * impulse[c].x + w.yy * impulse[c].y;
      if (c == r) {
        w_n += w.xx;
        w_t += w.yy;
      }
    }
    const double n = impulse[r].x + problem.tension[r];  // measured from where the bond tears
    const double t = impulse[r].y;
    if (!std::isfinite(g) || !std::isfinite(s) || !std::isfinite(n) || !std::isfinite(t)) {
      return std::numeric_limits<double>::infinity();
    }
    scale = std::max(
        {scale, std::abs(impulse[r].x), std::abs(t), std::abs(problem.b[r].x) / w_n, std::abs(problem.b[r].y) / w_t});
    // The smaller of force and gap must vanish and neither may be negative: |min(n, g / w)| says all three.
    const double normal = std::abs(std::min(n, g / w_n));
    // Friction: how far t is from the point of its interval that t - s / w is nearest to. The interval belongs to the
    // normal force as it is read by the pair (n, g): whichever of n and g is active.
    const double pressed = std::max(n - g / w_n, 0.0) - problem.tension[r];
    const double limit = std::max(problem.mu[r] * pressed + problem.cohesion[r], 0.0);
    const double wanted = t - s / w_t;
    const double nearest = wanted > limit ? limit : wanted < -limit ? -limit : wanted;
    const double sideways = std::abs(t - nearest);
    worst = std::max({worst, normal, sideways});
    worst_speed = std::max({worst_speed, normal * w_n, sideways * w_t});
    speed = std::max({speed, std::abs(problem.b[r].x), std::abs(problem.b[r].y), 1e-6 * w_n * std::abs(impulse[r].x),
                      1e-6 * w_t * std::abs(t)});
  }
  return std::max(worst / scale, worst_speed / speed);
}

}  // namespace cleave::contact_suite
