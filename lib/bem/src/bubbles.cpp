#include <cmath>

#include "block_build.hpp"

namespace cleave::bem {

void Bubbles::evaluate(Vec2 at, std::vector<Value>& out) const {
  double beta = 1;
  Vec2 dbeta;
  for (const auto& [start, inward] : sides) {
    const double d = dot(at - start, inward);
    dbeta = d * dbeta + beta * inward;
    beta *= d;
  }
  const Vec2 x = at / size;
  out.clear();
  for (std::size_t n = 0; n < degree; ++n) {
    for (std::size_t j = 0; j <= n; ++j) {
      const auto i = static_cast<double>(n - j);
      const auto jj = static_cast<double>(j);
      const double p = std::pow(x.x, i) * std::pow(x.y, jj);
      const Vec2 dp{i == 0 ? 0 : i * std::pow(x.x, i - 1) * std::pow(x.y, jj) / size,
                    j == 0 ? 0 : jj * std::pow(x.x, i) * std::pow(x.y, jj - 1) / size};
      out.push_back({beta * p, {dbeta.x * p + beta * dp.x, dbeta.y * p + beta * dp.y}});
    }
  }
}

Bubbles bubbles_of(const std::vector<Loop>& loops, Vec2 origin, std::size_t degree) {
  Bubbles out;
  if (degree == 0 || loops.size() != 1) return out;
  const Loop& loop = loops.front();
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec2 into = point_on(loop, k, 0).derivative;
    const Vec2 away = point_on(loop, (k + 1) % loop.size(), 0).derivative;
    if (sweep_of(loop, k) != 0 || !(cross(into, away) > -1e-12 * norm(into) * norm(away))) return out;
  }
  const double h = std::sqrt(area_moments(loops).area);
  // Collinear neighbours count as one side.
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec2 t = point_on(loop, k, 0).derivative;
    const Vec2 inward = turned_left(t) / (norm(t) * h);
    if (!out.sides.empty() && std::abs(cross(out.sides.back().second, inward)) < 1e-12 / (h * h)) continue;
    if (k + 1 == loop.size() && std::abs(cross(out.sides.front().second, inward)) < 1e-12 / (h * h) &&
        dot(out.sides.front().second, inward) > 0) {
      continue;
    }
    out.sides.emplace_back(loop[k].start - origin, inward);
  }
  out.degree = degree;
  out.size = h;
  return out;
}

}  // namespace cleave::bem
