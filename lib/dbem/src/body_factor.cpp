#include "body_factor.hpp"

#include <algorithm>

namespace cleave::dbem {
namespace {

/// Smallest E over diag W: what rounding of the factors bears.
constexpr double least_softness = 1e-9;

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> links_of_bodies(const RigidForm& form) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> out;
  for (const auto& [i, j] : form.sides) {
    if (i.body != RigidForm::ground && j.body != RigidForm::ground && i.body != j.body)
      out.emplace_back(i.body, j.body);
  }
  std::ranges::sort(out);
  const auto twice = std::ranges::unique(out);
  out.erase(twice.begin(), twice.end());
  return out;
}

void add_masses(const RigidForm& form, FrontalFactor& factor) {
  for (std::size_t b = 0; b < form.inverse_mass.size(); ++b) {
    auto block = factor.block(b, b);
    for (int d = 0; d < 3; ++d) {
      // Freedoms that are held do not move.
      const double inverse = form.inverse_mass[b][static_cast<std::size_t>(d)];
      block(d, d) += inverse > 0 ? 1 / inverse : 1e30;
    }
  }
}

Vec2 softness_of(const ContactProblem& problem, std::size_t contact, double soft, double least) {
  const RigidForm& form = *problem.rigid;
  const bem::Mat2& w = problem.w.values[problem.w.diagonal[contact]];
  Vec2 bodies{};
  for (const RigidForm::Side& side : form.sides[contact]) {
    if (side.body == RigidForm::ground) continue;
    for (std::size_t d = 0; d < 3; ++d) {
      bodies.x += side.n[d] * side.n[d] * form.inverse_mass[side.body][d];
      bodies.y += side.t[d] * side.t[d] * form.inverse_mass[side.body][d];
    }
  }
  return {std::max((1 + soft) * w.xx - bodies.x, least * w.xx), std::max((1 + soft) * w.yy - bodies.y, least * w.yy)};
}

BodyFactor::BodyFactor(const ContactProblem& problem)
    : factor_{problem.rigid->inverse_mass.size(), 3, links_of_bodies(*problem.rigid)} {}

bool BodyFactor::compute(const ContactProblem& problem, double soft, const Pattern& pattern) {
  const RigidForm& form = *problem.rigid;
  const std::size_t m = problem.contacts();
  soft_ = soft;
  pattern_ = pattern;
  softness_.resize(m);
  bool symmetric = true;
  for (std::size_t k = 0; k < m; ++k) {
    if (pattern.closed[k] != 0 && pattern.stuck[k] == 0 && pattern.q[k] != 0) symmetric = false;
  }
  factor_.clear(symmetric);
  add_masses(form, factor_);
  for (std::size_t k = 0; k < m; ++k) {
    softness_[k] = softness_of(problem, k, soft, least_softness);
    const bool closed = pattern.closed[k] != 0, stuck = pattern.stuck[k] != 0;
    if (!closed && !stuck) continue;
    const double q = stuck ? 0.0 : pattern.q[k];
    for (const RigidForm::Side& a : form.sides[k]) {
      if (a.body == RigidForm::ground) continue;
      for (const RigidForm::Side& b : form.sides[k]) {
        if (b.body == RigidForm::ground) continue;
        auto block = factor_.block(a.body, b.body);
        if (closed) block.noalias() += (row_of(a.n) + q * row_of(a.t)).transpose() * (row_of(b.n) / softness_[k].x);
        if (stuck) block.noalias() += row_of(a.t).transpose() * (row_of(b.t) / softness_[k].y);
      }
    }
  }
  return factor_.factorise();
}

void BodyFactor::apply(const ContactProblem& problem, const std::vector<Vec2>& residual, std::vector<Vec2>& z) const {
  const RigidForm& form = *problem.rigid;
  const auto at = [](std::uint32_t body) { return 3 * static_cast<Eigen::Index>(body); };
  Eigen::VectorXd u = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(form.inverse_mass.size()));
  z.resize(residual.size());
  for (std::size_t k = 0; k < residual.size(); ++k) {
    z[k] = {residual[k].x / softness_[k].x, residual[k].y / softness_[k].y};
    const bool stuck = pattern_.stuck[k] != 0;
    const double n = pattern_.closed[k] != 0 ? z[k].x : 0.0;
    const double t = stuck ? z[k].y : pattern_.q[k] * n;
    for (const RigidForm::Side& a : form.sides[k]) {
      if (a.body == RigidForm::ground) continue;
      for (std::size_t d = 0; d < 3; ++d) u[at(a.body) + static_cast<Eigen::Index>(d)] += n * a.n[d] + t * a.t[d];
    }
  }
  factor_.solve(u);
  for (std::size_t k = 0; k < residual.size(); ++k) {
    for (const RigidForm::Side& a : form.sides[k]) {
      if (a.body == RigidForm::ground) continue;
      for (std::size_t d = 0; d < 3; ++d) {
        const double v = u[at(a.body) + static_cast<Eigen::Index>(d)];
        z[k].x -= a.n[d] * v / softness_[k].x;
        z[k].y -= a.t[d] * v / softness_[k].y;
      }
    }
    if (pattern_.closed[k] == 0) z[k].x = 0;
    if (pattern_.stuck[k] == 0) z[k].y = 0;
  }
}

}  // namespace cleave::dbem
