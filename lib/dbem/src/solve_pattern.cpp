#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <memory>

#include "body_factor.hpp"
#include "natural_map.hpp"

namespace cleave::dbem {
namespace {

/// Unknowns that are solved for as a full matrix; of rigid bodies, whose freedoms are cheaper sooner.
constexpr int dense_up_to = 60, dense_rigid_up_to = 40;

/// Numbers of the unknowns, -1 where there is none.
struct Numbering {
  std::vector<int> n, t;
  int count = 0;
  bool symmetric = true;
};

Numbering number(const Pattern& pattern) {
  Numbering number;
  const std::size_t m = pattern.closed.size();
  number.n.assign(m, -1);
  number.t.assign(m, -1);
  for (std::size_t k = 0; k < m; ++k) {
    if (pattern.closed[k] != 0) number.n[k] = number.count++;
    if (pattern.stuck[k] != 0) {
      number.t[k] = number.count++;
    } else if (pattern.closed[k] != 0 && pattern.q[k] != 0) {
      number.symmetric = false;
    }
  }
  return number;
}

/// Calls entry(row, column, value) for the reduced matrix and fills the right-hand side.
template <class Entry>
void assemble(const BlockMatrix& w, double soft, const Pattern& pattern, const std::vector<Vec2>& rhs,
              const Numbering& number, Eigen::VectorXd& right, Entry&& entry) {
  const std::size_t m = rhs.size();
  // Known parts: n of open contacts; the constant part of t of those that do not stick.
  std::vector<Vec2> known(m);
  for (std::size_t k = 0; k < m; ++k) {
    if (pattern.closed[k] == 0) known[k].x = rhs[k].x;
    if (pattern.stuck[k] == 0) known[k].y = rhs[k].y + pattern.q[k] * known[k].x;
  }
  for (std::size_t r = 0; r < m; ++r) {
    const int row_n = number.n[r];
    const int row_t = number.t[r];
    if (row_n < 0 && row_t < 0) continue;
    Vec2 sum{};
    for (std::size_t at = w.starts[r]; at < w.starts[r + 1]; ++at) {
      const std::size_t c = w.columns[at];
      bem::Mat2 block = w.values[at];
      if (c == r) {
        block.xx *= 1 + soft;
        block.yy *= 1 + soft;
      }
      sum += block * known[c];
      const double q = pattern.stuck[c] != 0 ? 0.0 : pattern.q[c];
      if (number.n[c] >= 0) {
        if (row_n >= 0) entry(row_n, number.n[c], block.xx + q * block.xy);
        if (row_t >= 0) entry(row_t, number.n[c], block.yx + q * block.yy);
      }
      if (number.t[c] >= 0) {
        if (row_n >= 0) entry(row_n, number.t[c], block.xy);
        if (row_t >= 0) entry(row_t, number.t[c], block.yy);
      }
    }
    if (row_n >= 0) right[row_n] = rhs[r].x - sum.x;
    if (row_t >= 0) right[row_t] = rhs[r].y - sum.y;
  }
}

Eigen::SparseMatrix<double> sparse(const BlockMatrix& w, double soft, const Pattern& pattern,
                                   const std::vector<Vec2>& rhs, const Numbering& number, Eigen::VectorXd& right) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(w.values.size() * 4);
  assemble(w, soft, pattern, rhs, number, right, [&](int r, int c, double v) { entries.emplace_back(r, c, v); });
  Eigen::SparseMatrix<double> a(number.count, number.count);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

/// The reduced matrix times z.
void multiply(const BlockMatrix& w, double soft, const Pattern& pattern, const Numbering& number,
              const Eigen::VectorXd& z, Eigen::VectorXd& out) {
  const std::size_t m = number.n.size();
  std::vector<Vec2> x(m);
  for (std::size_t k = 0; k < m; ++k) {
    if (number.n[k] >= 0) x[k].x = z[number.n[k]];
    x[k].y = number.t[k] >= 0 ? z[number.t[k]] : pattern.q[k] * x[k].x;
  }
  for (std::size_t r = 0; r < m; ++r) {
    if (number.n[r] < 0 && number.t[r] < 0) continue;
    const bem::Mat2& d = w.values[w.diagonal[r]];
    Vec2 sum{soft * d.xx * x[r].x, soft * d.yy * x[r].y};
    for (std::size_t at = w.starts[r]; at < w.starts[r + 1]; ++at) sum += w.values[at] * x[w.columns[at]];
    if (number.n[r] >= 0) out[number.n[r]] = sum.x;
    if (number.t[r] >= 0) out[number.t[r]] = sum.y;
  }
}

}  // namespace

/// The factor of the contacts' own matrix and what it was made for.
struct PatternSolver::FactorCache {
  FrontalFactor factor;
  Numbering number;
  Pattern pattern;
  double soft = 0;
};

PatternSolver::PatternSolver(Work& work) : work_{&work} {}
PatternSolver::~PatternSolver() = default;

namespace {

std::size_t changes(const Pattern& a, const Pattern& b) {
  std::size_t sum = 0;
  for (std::size_t k = 0; k < a.q.size(); ++k) {
    sum += a.closed[k] != b.closed[k] || a.stuck[k] != b.stuck[k] || a.q[k] != b.q[k] ? 1U : 0U;
  }
  return sum;
}

/// Factorises the reduced matrix, the identity where there is no unknown.
template <class FactorCache>
bool factorise(FactorCache& kept, const BlockMatrix& w, double soft, const Pattern& pattern, const Numbering& number) {
  kept.number = number;
  kept.pattern = pattern;
  kept.soft = soft;
  kept.factor.clear(number.symmetric);
  for (std::size_t r = 0; r < w.rows(); ++r) {
    const bool row_n = number.n[r] >= 0, row_t = number.t[r] >= 0;
    for (std::size_t at = w.starts[r]; at < w.starts[r + 1]; ++at) {
      const std::size_t c = w.columns[at];
      bem::Mat2 v = w.values[at];
      auto block = kept.factor.block(r, c);
      if (c == r) {
        v.xx *= 1 + soft;
        v.yy *= 1 + soft;
        if (!row_n) block(0, 0) = 1;
        if (!row_t) block(1, 1) = 1;
      }
      const double q = pattern.stuck[c] != 0 ? 0.0 : pattern.q[c];
      const bool column_n = number.n[c] >= 0, column_t = number.t[c] >= 0;
      if (row_n && column_n) block(0, 0) = v.xx + q * v.xy;
      if (row_t && column_n) block(1, 0) = v.yx + q * v.yy;
      if (row_n && column_t) block(0, 1) = v.xy;
      if (row_t && column_t) block(1, 1) = v.yy;
    }
  }
  return kept.factor.factorise();
}

/// The kept factor on the unknowns it shares with the present ones, the diagonal on the rest.
template <class FactorCache>
Eigen::VectorXd precondition(const FactorCache& kept, const BlockMatrix& w, const Numbering& number,
                             const Eigen::VectorXd& r) {
  const std::size_t m = number.n.size();
  Eigen::VectorXd inner = Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(m));
  for (std::size_t k = 0; k < m; ++k) {
    const auto at = 2 * static_cast<Eigen::Index>(k);
    if (number.n[k] >= 0 && kept.number.n[k] >= 0) inner[at] = r[number.n[k]];
    if (number.t[k] >= 0 && kept.number.t[k] >= 0) inner[at + 1] = r[number.t[k]];
  }
  kept.factor.solve(inner);
  Eigen::VectorXd z(r.size());
  for (std::size_t k = 0; k < m; ++k) {
    const auto at = 2 * static_cast<Eigen::Index>(k);
    const bem::Mat2& d = w.values[w.diagonal[k]];
    if (number.n[k] >= 0) z[number.n[k]] = kept.number.n[k] >= 0 ? inner[at] : r[number.n[k]] / d.xx;
    if (number.t[k] >= 0) z[number.t[k]] = kept.number.t[k] >= 0 ? inner[at + 1] : r[number.t[k]] / d.yy;
  }
  return z;
}

/// Right-preconditioned GMRES without restarts; empty when `most` steps do not get to what is `enough`.
template <class Apply, class Precondition>
Eigen::VectorXd gmres(const Eigen::VectorXd& right, Eigen::Index most, double tolerance, double enough, Apply&& apply,
                      Precondition&& precondition_by) {
  const double size = right.norm();
  if (size == 0) return Eigen::VectorXd::Zero(right.size());
  std::vector<Eigen::VectorXd> basis{right / size}, images;
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(most + 1, most);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(most + 1), cosines(most), sines(most);
  g[0] = size;
  for (Eigen::Index j = 0; j < most; ++j) {
    images.push_back(precondition_by(basis.back()));
    Eigen::VectorXd next(right.size());
    apply(images.back(), next);
    for (int pass = 0; pass < 2; ++pass) {
      for (Eigen::Index i = 0; i <= j; ++i) {
        const double along = basis[static_cast<std::size_t>(i)].dot(next);
        h(i, j) += along;
        next -= along * basis[static_cast<std::size_t>(i)];
      }
    }
    h(j + 1, j) = next.norm();
    const double left = h(j + 1, j);
    for (Eigen::Index i = 0; i < j; ++i) {
      const double a = h(i, j), b = h(i + 1, j);
      h(i, j) = cosines[i] * a + sines[i] * b;
      h(i + 1, j) = -sines[i] * a + cosines[i] * b;
    }
    const double length = std::hypot(h(j, j), h(j + 1, j));
    if (!(length > 0) || !std::isfinite(length)) return {};
    cosines[j] = h(j, j) / length;
    sines[j] = h(j + 1, j) / length;
    h(j, j) = length;
    g[j + 1] = -sines[j] * g[j];
    g[j] *= cosines[j];
    if (std::abs(g[j + 1]) <= tolerance * size || left == 0 || (j + 1 == most && std::abs(g[j + 1]) <= enough * size)) {
      const Eigen::Index n = j + 1;
      const Eigen::VectorXd y = h.topLeftCorner(n, n).triangularView<Eigen::Upper>().solve(g.head(n));
      Eigen::VectorXd z = Eigen::VectorXd::Zero(right.size());
      for (Eigen::Index i = 0; i < n; ++i) z += y[i] * images[static_cast<std::size_t>(i)];
      return z;
    }
    basis.push_back(next / left);
  }
  return {};
}

}  // namespace

/// What one call is about.
struct PatternSolver::Call {
  const ContactProblem& problem;
  double soft;
  const Pattern& pattern;
  const std::vector<Vec2>& rhs;
  Numbering number;
  double around;  ///< work of a step of GMRES beside the factor
  Eigen::VectorXd right = {}, z = {};

  void assemble_right() {
    assemble(problem.w, soft, pattern, rhs, number, right, [](int, int, double) {});
  }
  /// False when it gives up.
  template <class Precondition>
  bool iterate(Eigen::Index most, double enough, Precondition&& precondition_by) {
    assemble_right();
    z = gmres(
        right, most, 1e-12, enough,
        [&](const Eigen::VectorXd& x, Eigen::VectorXd& out) { multiply(problem.w, soft, pattern, number, x, out); },
        precondition_by);
    return z.size() > 0;
  }
};

void PatternSolver::solve_dense(Call& call) {
  const int count = call.number.count;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(count, count);
  work_->add(std::pow(count, 3) / (call.number.symmetric ? 6 : 3) + 2 * product_work(call.problem));
  assemble(call.problem.w, call.soft, call.pattern, call.rhs, call.number, call.right,
           [&](int r, int c, double v) { a(r, c) = v; });
  if (call.number.symmetric) {
    const Eigen::LLT<Eigen::MatrixXd> cholesky{a};
    call.z = cholesky.info() == Eigen::Success ? Eigen::VectorXd{cholesky.solve(call.right)}
                                               : Eigen::VectorXd{a.partialPivLu().solve(call.right)};
  } else {
    call.z = a.partialPivLu().solve(call.right);
  }
}

bool PatternSolver::solve_by_bodies(Call& call) {
  const ContactProblem& problem = call.problem;
  const Numbering& number = call.number;
  if (!problem.rigid) return false;
  const std::size_t bodies = problem.rigid->inverse_mass.size();
  if (bodies > CompactFactor::most_nodes && 3 * static_cast<int>(bodies) > number.count) return false;
  if (!bodies_) bodies_ = std::make_unique<BodyFactor>(problem);
  const bool held = bodies_->holds(call.soft, call.pattern);
  if (!held && !bodies_->compute(problem, call.soft, call.pattern)) return false;
  const std::size_t contacts = call.rhs.size();
  if (!held) work_->add(bodies_->factor_work() + 50 * static_cast<double>(contacts));
  std::vector<Vec2> residual(contacts), unknown;
  return call.iterate(30, 1e-9, [&](const Eigen::VectorXd& r) {
    for (std::size_t k = 0; k < contacts; ++k) {
      residual[k] = {number.n[k] >= 0 ? r[number.n[k]] : 0.0, number.t[k] >= 0 ? r[number.t[k]] : 0.0};
    }
    bodies_->apply(problem, residual, unknown);
    work_->add(bodies_->solve_work() + call.around);
    Eigen::VectorXd out(r.size());
    for (std::size_t k = 0; k < contacts; ++k) {
      if (number.n[k] >= 0) out[number.n[k]] = unknown[k].x;
      if (number.t[k] >= 0) out[number.t[k]] = unknown[k].y;
    }
    return out;
  });
}

bool PatternSolver::solve_by_contacts(Call& call) {
  const BlockMatrix& w = call.problem.w;
  const auto iterate = [&](Eigen::Index most) {
    return call.iterate(most, 1e-12, [&](const Eigen::VectorXd& r) {
      work_->add(kept_->factor.solve_work() + call.around);
      return precondition(*kept_, w, call.number, r);
    });
  };
  // A factor made for other states of a few contacts does: each takes GMRES two steps more.
  if (kept_ && kept_->soft == call.soft && changes(kept_->pattern, call.pattern) <= 3 && iterate(12)) return true;
  if (!kept_) kept_ = std::make_unique<FactorCache>(FrontalFactor{w.rows(), 2, links_of_contacts(w)});
  const bool factorised = factorise(*kept_, w, call.soft, call.pattern, call.number);
  work_->add(kept_->factor.factor_work() + 2 * product_work(call.problem));
  if (factorised) return iterate(20);
  kept_.reset();
  return false;
}

std::optional<std::vector<Vec2>> PatternSolver::solve(const ContactProblem& problem, double soft,
                                                      const Pattern& pattern, const std::vector<Vec2>& rhs) {
  Call call{problem,
            soft,
            pattern,
            rhs,
            dbem::number(pattern),
            product_work(problem) + 100 * static_cast<double>(rhs.size())};
  const Numbering& number = call.number;
  call.right = Eigen::VectorXd::Zero(number.count);
  if (number.count == 0) {
    call.assemble_right();
  } else if (number.count <= (problem.rigid ? dense_rigid_up_to : dense_up_to)) {
    solve_dense(call);
  } else if (!solve_by_bodies(call) && !solve_by_contacts(call)) {
    work_->add(100 * std::pow(number.count, 2));  // a bound of what a sparse factor of the plane takes
    const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu{sparse(problem.w, soft, pattern, rhs, number, call.right)};
    if (lu.info() != Eigen::Success) return std::nullopt;
    call.z = lu.solve(call.right);
  }
  if (!call.z.allFinite()) return std::nullopt;
  std::vector<Vec2> x(rhs.size());
  for (std::size_t k = 0; k < rhs.size(); ++k) {
    x[k].x = number.n[k] >= 0 ? call.z[number.n[k]] : rhs[k].x;
    x[k].y = number.t[k] >= 0 ? call.z[number.t[k]] : rhs[k].y + pattern.q[k] * x[k].x;
  }
  return x;
}

}  // namespace cleave::dbem
