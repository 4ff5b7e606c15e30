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

constexpr int dense_up_to = 60;  // unknowns

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
struct PatternSolver::Kept {
  FrontalFactor factor;
  Numbering number;
  Pattern pattern;
  double soft = -1;
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
template <class Kept>
bool factorise(Kept& kept, const BlockMatrix& w, double soft, const Pattern& pattern, const Numbering& number) {
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
template <class Kept>
Eigen::VectorXd precondition(const Kept& kept, const BlockMatrix& w, const Numbering& number,
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

std::vector<Vec2> PatternSolver::solve(const ContactProblem& problem, double soft, const Pattern& pattern,
                                       const std::vector<Vec2>& rhs) {
  const BlockMatrix& w = problem.w;
  const Numbering number = dbem::number(pattern);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(number.count);
  Eigen::VectorXd z;
  if (number.count == 0) {
    assemble(w, soft, pattern, rhs, number, right, [](int, int, double) {});
  } else if (number.count <= dense_up_to) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(number.count, number.count);
    work_->add(std::pow(number.count, 3) / (number.symmetric ? 6 : 3) + 2 * product_work(problem));
    assemble(w, soft, pattern, rhs, number, right, [&](int r, int c, double v) { a(r, c) = v; });
    if (number.symmetric) {
      const Eigen::LLT<Eigen::MatrixXd> cholesky{a};
      z = cholesky.info() == Eigen::Success ? Eigen::VectorXd{cholesky.solve(right)}
                                            : Eigen::VectorXd{a.partialPivLu().solve(right)};
    } else {
      z = a.partialPivLu().solve(right);
    }
  } else {
    bool done = false;
    // Of a step of GMRES beside the factor.
    const double around = product_work(problem) + 100 * static_cast<double>(rhs.size());
    if (problem.rigid && 3 * static_cast<int>(problem.rigid->inverse_mass.size()) <= number.count) {
      if (!bodies_) bodies_ = std::make_unique<BodyFactor>(problem);
      const bool held = bodies_->holds(soft, pattern);
      if (held || bodies_->compute(problem, soft, pattern)) {
        if (!held) work_->add(bodies_->factor_work() + 50 * static_cast<double>(rhs.size()));
        assemble(w, soft, pattern, rhs, number, right, [](int, int, double) {});
        std::vector<Vec2> residual(rhs.size()), unknown;
        z = gmres(
            right, 30, 1e-12, 1e-9,
            [&](const Eigen::VectorXd& x, Eigen::VectorXd& out) { multiply(w, soft, pattern, number, x, out); },
            [&](const Eigen::VectorXd& r) {
              for (std::size_t k = 0; k < rhs.size(); ++k) {
                residual[k] = {number.n[k] >= 0 ? r[number.n[k]] : 0.0, number.t[k] >= 0 ? r[number.t[k]] : 0.0};
              }
              bodies_->apply(problem, residual, unknown);
              work_->add(bodies_->solve_work() + around);
              Eigen::VectorXd out(r.size());
              for (std::size_t k = 0; k < rhs.size(); ++k) {
                if (number.n[k] >= 0) out[number.n[k]] = unknown[k].x;
                if (number.t[k] >= 0) out[number.t[k]] = unknown[k].y;
              }
              return out;
            });
        done = z.size() > 0;
      }
    }
    const auto iterate = [&](Eigen::Index most) {
      assemble(w, soft, pattern, rhs, number, right, [](int, int, double) {});
      z = gmres(
          right, most, 1e-12, 1e-12,
          [&](const Eigen::VectorXd& x, Eigen::VectorXd& out) { multiply(w, soft, pattern, number, x, out); },
          [&](const Eigen::VectorXd& r) {
            work_->add(kept_->factor.solve_work() + around);
            return precondition(*kept_, w, number, r);
          });
      return z.size() > 0;
    };
    // A factor made for other states of a few contacts does: each takes GMRES two steps more.
    if (!done && kept_ && kept_->soft == soft && changes(kept_->pattern, pattern) <= 3) done = iterate(12);
    if (!done) {
      if (!kept_) kept_ = std::make_unique<Kept>(FrontalFactor{w.rows(), 2, links_of_contacts(w)});
      const bool factorised = factorise(*kept_, w, soft, pattern, number);
      work_->add(kept_->factor.factor_work() + 2 * product_work(problem));
      if (factorised) {
        done = iterate(20);
      } else {
        kept_.reset();
      }
    }
    if (!done) {
      work_->add(100 * std::pow(number.count, 2));  // a bound of what a sparse factor of the plane takes
      const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu{sparse(w, soft, pattern, rhs, number, right)};
      if (lu.info() != Eigen::Success) return {};
      z = lu.solve(right);
    }
  }
  if (!z.allFinite()) return {};
  std::vector<Vec2> x(rhs.size());
  for (std::size_t k = 0; k < rhs.size(); ++k) {
    x[k].x = number.n[k] >= 0 ? z[number.n[k]] : rhs[k].x;
    x[k].y = number.t[k] >= 0 ? z[number.t[k]] : rhs[k].y + pattern.q[k] * x[k].x;
  }
  return x;
}

}  // namespace cleave::dbem
