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
      block(d, d) += mass_of(form.inverse_mass[b][static_cast<std::size_t>(d)]);
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

namespace {

/// What the contacts add to the freedoms of their bodies: add(row body, column body, row, column), an outer product.
template <class Add>
void add_contacts(const RigidForm& form, const Pattern& pattern, const std::vector<Vec2>& softness, Add&& add) {
  for (std::size_t k = 0; k < softness.size(); ++k) {
    const bool closed = pattern.closed[k] != 0, stuck = pattern.stuck[k] != 0;
    if (!closed && !stuck) continue;
    const double q = stuck ? 0.0 : pattern.q[k];
    for (const RigidForm::Side& a : form.sides[k]) {
      if (a.body == RigidForm::ground) continue;
      const Three pushed{a.n[0] + q * a.t[0], a.n[1] + q * a.t[1], a.n[2] + q * a.t[2]};
      for (const RigidForm::Side& b : form.sides[k]) {
        if (b.body == RigidForm::ground) continue;
        const Vec2 s = softness[k];
        if (closed) add(a.body, b.body, pushed, std::array{b.n[0] / s.x, b.n[1] / s.x, b.n[2] / s.x});
        if (stuck) add(a.body, b.body, a.t, std::array{b.t[0] / s.y, b.t[1] / s.y, b.t[2] / s.y});
      }
    }
  }
}

}  // namespace

BodyFactor::BodyFactor(const ContactProblem& problem) {
  const std::size_t bodies = problem.rigid->inverse_mass.size();
  if (bodies <= CompactFactor::most_nodes) {
    few_.emplace(bodies, links_of_bodies(*problem.rigid));
  } else {
    many_.emplace(bodies, 3, links_of_bodies(*problem.rigid));
  }
}

bool BodyFactor::compute(const ContactProblem& problem, double soft, const Pattern& pattern) {
  const RigidForm& form = *problem.rigid;
  const std::size_t m = problem.contacts();
  soft_ = soft;
  pattern_ = pattern;
  softness_.resize(m);
  bool symmetric = true;
  for (std::size_t k = 0; k < m; ++k) {
    softness_[k] = softness_of(problem, k, soft, least_softness);
    if (pattern.closed[k] != 0 && pattern.stuck[k] == 0 && pattern.q[k] != 0) symmetric = false;
  }
  if (few_) {
    few_->clear();
    for (std::size_t b = 0; b < form.inverse_mass.size(); ++b) {
      for (std::size_t d = 0; d < 3; ++d) few_->block(b, b)[4 * d] = mass_of(form.inverse_mass[b][d]);
    }
    add_contacts(form, pattern, softness_,
                 [&](std::uint32_t a, std::uint32_t b, const Three& row, const Three& column) {
                   Block3& block = few_->block(a, b);
                   for (std::size_t r = 0; r < 3; ++r) {
                     for (std::size_t c = 0; c < 3; ++c) block[3 * r + c] += row[r] * column[c];
                   }
                 });
    return few_->factorise();
  }
  many_->clear(symmetric);
  add_masses(form, *many_);
  add_contacts(form, pattern, softness_, [&](std::uint32_t a, std::uint32_t b, const Three& row, const Three& column) {
    many_->block(a, b).noalias() += row_of(row).transpose() * row_of(column);
  });
  return many_->factorise();
}

namespace {

void solve_many(const FrontalFactor& factor, std::vector<Three>& x) {
  Eigen::VectorXd flat(3 * static_cast<Eigen::Index>(x.size()));
  Eigen::Index at = 0;
  for (const Three& three : x) {
    for (const double value : three) flat[at++] = value;
  }
  factor.solve(flat);
  at = 0;
  for (Three& three : x) {
    for (double& value : three) value = flat[at++];
  }
}

}  // namespace

void BodyFactor::apply(const ContactProblem& problem, const std::vector<Vec2>& residual, std::vector<Vec2>& z) const {
  const RigidForm& form = *problem.rigid;
  std::vector<Three> u(form.inverse_mass.size());
  z.resize(residual.size());
  for (std::size_t k = 0; k < residual.size(); ++k) {
    z[k] = {residual[k].x / softness_[k].x, residual[k].y / softness_[k].y};
    const bool stuck = pattern_.stuck[k] != 0;
    const double n = pattern_.closed[k] != 0 ? z[k].x : 0.0;
    const double t = stuck ? z[k].y : pattern_.q[k] * n;
    for (const RigidForm::Side& a : form.sides[k]) {
      if (a.body == RigidForm::ground) continue;
      for (std::size_t d = 0; d < 3; ++d) u[a.body][d] += n * a.n[d] + t * a.t[d];
    }
  }
  if (few_) few_->solve(u);
  if (many_) solve_many(*many_, u);
  for (std::size_t k = 0; k < residual.size(); ++k) {
    for (const RigidForm::Side& a : form.sides[k]) {
      if (a.body == RigidForm::ground) continue;
      for (std::size_t d = 0; d < 3; ++d) {
        const double v = u[a.body][d];
        z[k].x -= a.n[d] * v / softness_[k].x;
        z[k].y -= a.t[d] * v / softness_[k].y;
      }
    }
    if (pattern_.closed[k] == 0) z[k].x = 0;
    if (pattern_.stuck[k] == 0) z[k].y = 0;
  }
}

}  // namespace cleave::dbem
