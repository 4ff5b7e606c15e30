#include "path_factor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "body_factor.hpp"

namespace cleave::dbem {
namespace {

/// Corrections of an answer by what it misses.
constexpr int most_rounds = 6;
/// Smallest E over diag W.
constexpr double least_softness = 1e-11;

double largest(const std::vector<Vec2>& y) {
  double most = 0;
  for (const Vec2 v : y) most = std::max({most, std::abs(v.x), std::abs(v.y)});
  return most;
}

}  // namespace

PathFactor::PathFactor(const ContactProblem& problem, Work& work)
    : problem_{&problem},
      work_{&work},
      factor_{problem.rigid->inverse_mass.size(), 3, links_of_bodies(*problem.rigid)} {}

Vec2 PathFactor::impulse(std::size_t contact, Vec2 z) const {
  return {z.x, sense_[contact] * (problem_->mu[contact] * z.x - z.y)};
}

/// ((E + D) T)^-1 y.
Vec2 PathFactor::without_bodies(std::size_t contact, Vec2 y) const {
  const Own& own = own_[contact];
  const double n = y.x / own.nn;
  return {n, (y.y - own.tn * n) / own.tt};
}

bool PathFactor::compute(const std::vector<Barrier>& barrier) {
  const RigidForm& form = *problem_->rigid;
  const std::size_t m = problem_->contacts();
  sense_.resize(m);
  own_.resize(m);
  barrier_.resize(m);
  factor_.clear(false);
  add_masses(form, factor_);
  for (std::size_t k = 0; k < m; ++k) {
    const Barrier& b = barrier[k];
    const double mu = problem_->mu[k], far = std::min(b.ahead, b.back);
    const Vec2 e = softness_of(*problem_, k, 0, least_softness);
    const double s = b.back >= b.ahead ? 1 : -1;
    sense_[k] = s;
    barrier_[k] = {b.normal, 2 * s * mu * far, -s * (b.ahead + b.back)};
    own_[k] = {e.x + b.normal, s * mu * (e.y + 2 * far), -s * (e.y + b.ahead + b.back)};
    for (const RigidForm::Side& moved : form.sides[k]) {
      if (moved.body == RigidForm::ground) continue;
      const Eigen::RowVector3d n = row_of(moved.n) / own_[k].nn;
      const Eigen::RowVector3d r = (row_of(moved.t) - own_[k].tn * n) / own_[k].tt;
      const Eigen::RowVector3d t = s * (mu * n - r);
      for (const RigidForm::Side& pushed : form.sides[k]) {
        if (pushed.body == RigidForm::ground) continue;
        auto block = factor_.block(pushed.body, moved.body);
        block.noalias() += row_of(pushed.n).transpose() * n;
        block.noalias() += row_of(pushed.t).transpose() * t;
      }
    }
  }
  work_->add(factor_.factor_work() + 50 * static_cast<double>(barrier.size()));
  return factor_.factorise();
}

void PathFactor::nearly(const std::vector<Vec2>& y, std::vector<Vec2>& z) const {
  work_->add(factor_.solve_work() + 50 * static_cast<double>(y.size()) + product_work(*problem_));
  const RigidForm& form = *problem_->rigid;
  const auto at = [](std::uint32_t body, std::size_t d) {
    return 3 * static_cast<Eigen::Index>(body) + static_cast<Eigen::Index>(d);
  };
  Eigen::VectorXd u = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(form.inverse_mass.size()));
  z.resize(y.size());
  for (std::size_t k = 0; k < y.size(); ++k) {
    z[k] = without_bodies(k, y[k]);
    const Vec2 p = impulse(k, z[k]);
    for (const RigidForm::Side& side : form.sides[k]) {
      if (side.body == RigidForm::ground) continue;
      for (std::size_t d = 0; d < 3; ++d) u[at(side.body, d)] += p.x * side.n[d] + p.y * side.t[d];
    }
  }
  factor_.solve(u);
  for (std::size_t k = 0; k < y.size(); ++k) {
    Vec2 moved{};
    for (const RigidForm::Side& side : form.sides[k]) {
      if (side.body == RigidForm::ground) continue;
      for (std::size_t d = 0; d < 3; ++d) moved += u[at(side.body, d)] * Vec2{side.n[d], side.t[d]};
    }
    z[k] -= without_bodies(k, moved);
  }
}

std::vector<Vec2> PathFactor::missing(const std::vector<Vec2>& y, const std::vector<Vec2>& z) const {
  std::vector<Vec2> p(z.size()), image(z.size()), left(z.size());
  for (std::size_t k = 0; k < z.size(); ++k) p[k] = impulse(k, z[k]);
  problem_->w.add_product(p, image);
  for (std::size_t k = 0; k < z.size(); ++k) {
    const Own& d = barrier_[k];
    left[k] = y[k] - image[k] - Vec2{d.nn * z[k].x, d.tn * z[k].x + d.tt * z[k].y};
  }
  return left;
}

bool PathFactor::solve(const std::vector<Vec2>& y, std::vector<Vec2>& z) const {
  const double whole = largest(y);
  z.assign(y.size(), {});
  std::vector<Vec2> left = y, more;
  double before = whole;
  for (int round = 0; round < most_rounds && before > 1e-12 * whole; ++round) {
    nearly(left, more);
    std::vector<Vec2> next = z;
    for (std::size_t k = 0; k < z.size(); ++k) next[k] += more[k];
    std::vector<Vec2> still = missing(y, next);
    const double now = largest(still);
    if (!(now < 0.5 * before)) break;
    z = std::move(next);
    left = std::move(still);
    before = now;
  }
  return before <= 1e-2 * whole;
}

}  // namespace cleave::dbem
