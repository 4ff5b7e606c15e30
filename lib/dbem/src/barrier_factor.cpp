#include "barrier_factor.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "body_factor.hpp"

namespace cleave::dbem {
namespace {

/// Conjugate gradients after the factor: enough for what it leaves out.
constexpr int most_rounds = 20;
/// Smallest E over diag W: below the regularisation of moving bodies, so that they are solved as they are.
constexpr double least_softness = 1e-11;

bem::Mat2 inverse(const bem::Mat2& a) {
  const double determinant = a.xx * a.yy - a.xy * a.yx;
  return {a.yy / determinant, -a.xy / determinant, -a.yx / determinant, a.xx / determinant};
}

double product(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += dot(a[k], b[k]);
  return sum;
}

bool in_bodies(const ContactProblem& problem) {
  return problem.rigid && 3 * problem.rigid->inverse_mass.size() < 2 * problem.contacts();
}

FrontalFactor factor_for(const ContactProblem& problem) {
  if (in_bodies(problem)) return {problem.rigid->inverse_mass.size(), 3, links_of_bodies(*problem.rigid)};
  return {problem.contacts(), 2, links_of_contacts(problem.w)};
}

}  // namespace

BarrierFactor::BarrierFactor(const ContactProblem& problem, Work& work)
    : problem_{&problem}, work_{&work}, bodies_{in_bodies(problem)}, factor_{factor_for(problem)} {}

Vec2 BarrierFactor::impulse(std::size_t contact, Vec2 z) const {
  return {z.x, sense_[contact] * (problem_->mu[contact] * z.x - z.y)};
}

Vec2 BarrierFactor::turned(std::size_t contact, Vec2 y) const {
  return {y.x + sense_[contact] * problem_->mu[contact] * y.y, -sense_[contact] * y.y};
}

bool BarrierFactor::compute(std::vector<Barrier> barrier) {
  const std::size_t m = problem_->contacts();
  sense_.resize(m);
  barrier_.resize(m);
  for (std::size_t c = 0; c < m; ++c) {
    const Barrier& b = barrier[c];
    const double mu = problem_->mu[c], far = std::min(b.ahead, b.back);
    sense_[c] = b.back >= b.ahead ? 1 : -1;
    barrier_[c] = {b.normal + 4 * mu * mu * far, -2 * mu * far, -2 * mu * far, b.ahead + b.back};
  }
  const bool done = bodies_ ? compute_in_bodies() : compute_in_contacts();
  work_->add(factor_.factor_work() + 50 * static_cast<double>(m));
  return done;
}

bool BarrierFactor::compute_in_contacts() {
  const BlockMatrix& w = problem_->w;
  factor_.clear(true);
  for (std::size_t r = 0; r < w.rows(); ++r) {
    for (std::size_t at = w.starts[r]; at < w.starts[r + 1]; ++at) {
      const std::size_t c = w.columns[at];
      Vec2 first = turned(r, w.values[at] * impulse(c, {1, 0})), second = turned(r, w.values[at] * impulse(c, {0, 1}));
      if (c == r) {
        first += Vec2{barrier_[r].xx, barrier_[r].yx};
        second += Vec2{barrier_[r].xy, barrier_[r].yy};
      }
      auto block = factor_.block(r, c);
      block(0, 0) = first.x;
      block(1, 0) = first.y;
      block(0, 1) = second.x;
      block(1, 1) = second.y;
    }
  }
  return factor_.factorise();
}

bool BarrierFactor::compute_in_bodies() {
  const RigidForm& form = *problem_->rigid;
  const std::size_t m = problem_->contacts();
  factor_.clear(true);
  add_masses(form, factor_);
  yielding_.resize(m);
  for (std::size_t k = 0; k < m; ++k) {
    const Vec2 e = softness_of(*problem_, k, 0, least_softness);
    const double mu = problem_->mu[k];
    yielding_[k] = inverse(barrier_[k] + bem::Mat2{e.x + mu * mu * e.y, -mu * e.y, -mu * e.y, e.y});
    const bem::Mat2& y = yielding_[k];
    const auto rows = [&](const RigidForm::Side& side) {
      const Eigen::RowVector3d t = sense_[k] * row_of(side.t);
      return std::pair{Eigen::RowVector3d{row_of(side.n) + mu * t}, Eigen::RowVector3d{-t}};
    };
    for (const RigidForm::Side& a : form.sides[k]) {
      if (a.body == RigidForm::ground) continue;
      const auto [of_n, of_r] = rows(a);
      for (const RigidForm::Side& b : form.sides[k]) {
        if (b.body == RigidForm::ground) continue;
        const auto [on_n, on_r] = rows(b);
        auto block = factor_.block(a.body, b.body);
        block.noalias() += of_n.transpose() * (y.xx * on_n + y.xy * on_r);
        block.noalias() += of_r.transpose() * (y.yx * on_n + y.yy * on_r);
      }
    }
  }
  return factor_.factorise();
}

void BarrierFactor::precondition(const std::vector<Vec2>& y, std::vector<Vec2>& z) const {
  const std::size_t m = y.size();
  work_->add(factor_.solve_work() + 50 * static_cast<double>(m) + product_work(*problem_));
  z.resize(m);
  if (!bodies_) {
    Eigen::VectorXd all(2 * static_cast<Eigen::Index>(m));
    for (std::size_t k = 0; k < m; ++k) all.segment(2 * static_cast<Eigen::Index>(k), 2) << y[k].x, y[k].y;
    factor_.solve(all);
    for (std::size_t k = 0; k < m; ++k) {
      z[k] = {all[2 * static_cast<Eigen::Index>(k)], all[2 * static_cast<Eigen::Index>(k) + 1]};
    }
    return;
  }
  const RigidForm& form = *problem_->rigid;
  const auto at = [](std::uint32_t body, std::size_t d) {
    return 3 * static_cast<Eigen::Index>(body) + static_cast<Eigen::Index>(d);
  };
  Eigen::VectorXd u = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(form.inverse_mass.size()));
  for (std::size_t k = 0; k < m; ++k) {
    z[k] = yielding_[k] * y[k];
    const Vec2 p = impulse(k, z[k]);
    for (const RigidForm::Side& side : form.sides[k]) {
      if (side.body == RigidForm::ground) continue;
      for (std::size_t d = 0; d < 3; ++d) u[at(side.body, d)] += p.x * side.n[d] + p.y * side.t[d];
    }
  }
  factor_.solve(u);
  for (std::size_t k = 0; k < m; ++k) {
    Vec2 moved{};
    for (const RigidForm::Side& side : form.sides[k]) {
      if (side.body == RigidForm::ground) continue;
      for (std::size_t d = 0; d < 3; ++d) moved += u[at(side.body, d)] * Vec2{side.n[d], side.t[d]};
    }
    z[k] -= yielding_[k] * turned(k, moved);
  }
}

bool BarrierFactor::solve(const std::vector<Vec2>& y, std::vector<Vec2>& z) const {
  const std::size_t m = y.size();
  std::vector<Vec2> left = y, near, along, p(m), image(m);
  z.assign(m, {});
  precondition(left, near);
  along = near;
  double size = product(left, near);
  const double first = size;
  for (int round = 0; round < most_rounds && size > 1e-24 * first; ++round) {
    for (std::size_t k = 0; k < m; ++k) {
      p[k] = impulse(k, along[k]);
      image[k] = {};
    }
    problem_->w.add_product(p, image);
    for (std::size_t k = 0; k < m; ++k) image[k] = turned(k, image[k]) + barrier_[k] * along[k];
    const double curvature = product(along, image);
    if (!(curvature > 0)) break;
    const double step = size / curvature;
    for (std::size_t k = 0; k < m; ++k) {
      z[k] += step * along[k];
      left[k] -= step * image[k];
    }
    precondition(left, near);
    const double next = product(left, near);
    for (std::size_t k = 0; k < m; ++k) along[k] = near[k] + (next / size) * along[k];
    size = next;
  }
  return size <= 1e-12 * first;
}

}  // namespace cleave::dbem
