#include "natural_map.hpp"

#include <algorithm>
#include <cmath>

namespace cleave::dbem {

namespace {

/// Velocities below this share of the largest product W p are not looked at: 10^-8 of them would be rounding. A group
/// in free fall that keeps its stress has no others.
constexpr double rounding = 1e-6;

}  // namespace

void BlockMatrix::add_product(const std::vector<Vec2>& x, std::vector<Vec2>& y) const {
  for (std::size_t r = 0; r < rows(); ++r) {
    Vec2 sum{};
    for (std::size_t k = starts[r]; k < starts[r + 1]; ++k) sum += values[k] * x[columns[k]];
    y[r] += sum;
  }
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> links_of_contacts(const BlockMatrix& w) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> out;
  for (std::uint32_t r = 0; r < w.rows(); ++r) {
    for (std::size_t at = w.starts[r]; at < w.starts[r + 1]; ++at) {
      if (r < w.columns[at]) out.emplace_back(r, w.columns[at]);
    }
  }
  return out;
}

MapEvaluator::MapEvaluator(const ContactProblem& problem, double soft, std::span<const Vec2> centre,
                           Regularised regularised)
    : problem_{&problem},
      soft_{soft},
      centre_{centre},
      about_itself_{regularised == Regularised::about_itself && !problem.yielding.empty()} {
  r_.resize(problem.contacts());
  for (std::size_t k = 0; k < r_.size(); ++k) {
    const bem::Mat2& d = problem.w.values[problem.w.diagonal[k]];
    r_[k] = {1 / ((1 + soft) * d.xx), 1 / ((1 + soft) * d.yy)};
    load_ = std::max({load_, std::abs(problem.b[k].x / d.xx), std::abs(problem.b[k].y / d.yy)});
    speed_ = std::max({speed_, std::abs(problem.b[k].x), std::abs(problem.b[k].y)});
  }
}

void MapEvaluator::evaluate(const std::vector<Vec2>& p, NaturalMap& map) const {
  const std::size_t m = problem_->contacts();
  map.y = problem_->b;
  problem_->w.add_product(p, map.y);
  map.f.resize(m);
  map.a_n.resize(m);
  map.a_t.resize(m);
  map.bound.resize(m);
  map.largest = map.fastest = map.squared = 0;
  for (std::size_t k = 0; k < m; ++k) {
    if (soft_ > 0) {
      const bem::Mat2& d = problem_->w.values[problem_->w.diagonal[k]];
      const Vec2 off = centre_.empty() ? p[k] : p[k] - centre_[k];
      map.y[k] += soft_ * Vec2{d.xx * off.x, d.yy * off.y};
    }
    if (about_itself_) {
      const Vec2 off = p[k] - problem_->start[k];
      map.y[k] += -Vec2{problem_->yielding[k].x * off.x, problem_->yielding[k].y * off.y};
    }
    const double tension = problem_->tension[k];
    const double a_n = p[k].x - r_[k].x * map.y[k].x;
    const double a_t = p[k].y - r_[k].y * map.y[k].y;
    const double n = std::max(a_n, -tension);
    const double bound = std::max(0.0, problem_->mu[k] * n + problem_->cohesion[k]);
    map.a_n[k] = a_n;
    map.a_t[k] = a_t;
    map.bound[k] = bound;
    map.f[k] = {p[k].x - n, p[k].y - std::clamp(a_t, -bound, bound)};
    const double size = std::max(std::abs(map.f[k].x), std::abs(map.f[k].y));
    map.largest = size > map.largest || std::isnan(size) ? size : map.largest;
    map.fastest = std::max({map.fastest, std::abs(map.f[k].x) / r_[k].x, std::abs(map.f[k].y) / r_[k].y});
    map.squared += dot(map.f[k], map.f[k]);
  }
  if (!std::isfinite(map.squared)) map.largest = map.fastest = map.squared = 1e300;
}

double MapEvaluator::residual(const NaturalMap& map, const std::vector<Vec2>& p) const {
  double most = load_, product = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    most = std::max({most, std::abs(p[k].x), std::abs(p[k].y)});
    product = std::max({product, std::abs(p[k].x) / r_[k].x, std::abs(p[k].y) / r_[k].y});
  }
  const double speed = std::max(speed_, rounding * product);
  return std::max(map.largest / std::max(most, 1e-300), map.fastest / std::max(speed, 1e-300));
}

Judged judge(const ContactProblem& problem, const std::vector<Vec2>& impulse) {
  Judged given{0, {}};
  const MapEvaluator as_given{problem};
  as_given.evaluate(impulse, given.map);
  given.residual = as_given.residual(given.map, impulse);
  if (problem.yielding.empty()) return given;
  Judged own{0, {}};
  const MapEvaluator about_itself{problem, 0, {}, Regularised::about_itself};
  about_itself.evaluate(impulse, own.map);
  own.residual = about_itself.residual(own.map, impulse);
  return own.residual < given.residual ? own : given;
}

double natural_residual(const ContactProblem& problem, const std::vector<Vec2>& impulse) {
  if (problem.contacts() == 0) return 0;
  const MapEvaluator evaluator{problem};
  NaturalMap map;
  evaluator.evaluate(impulse, map);
  return evaluator.residual(map, impulse);
}

}  // namespace cleave::dbem
