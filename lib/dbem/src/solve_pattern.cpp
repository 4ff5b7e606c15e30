#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <memory>

#include "natural_map.hpp"

namespace cleave::dbem {
namespace {

constexpr int dense_up_to = 120;  // unknowns

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

using Cholesky = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

Eigen::SparseMatrix<double> sparse(const BlockMatrix& w, double soft, const Pattern& pattern,
                                   const std::vector<Vec2>& rhs, const Numbering& number, Eigen::VectorXd& right,
                                   bool lower) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(w.values.size() * (lower ? 2 : 4));
  assemble(w, soft, pattern, rhs, number, right, [&](int r, int c, double v) {
    if (!lower || r >= c) entries.emplace_back(r, c, v);
  });
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

struct PatternSolver::Kept {
  Numbering number;
  double soft = 0;
  Cholesky factor;
};

PatternSolver::PatternSolver() = default;
PatternSolver::~PatternSolver() = default;

namespace {

/// The kept factor on the unknowns it shares with the present ones, the diagonal on the rest.
template <class Kept>
Eigen::VectorXd precondition(const Kept& kept, const BlockMatrix& w, const Numbering& number,
                             const Eigen::VectorXd& r) {
  Eigen::VectorXd inner = Eigen::VectorXd::Zero(kept.number.count);
  for (std::size_t k = 0; k < number.n.size(); ++k) {
    if (number.n[k] >= 0 && kept.number.n[k] >= 0) inner[kept.number.n[k]] = r[number.n[k]];
    if (number.t[k] >= 0 && kept.number.t[k] >= 0) inner[kept.number.t[k]] = r[number.t[k]];
  }
  const Eigen::VectorXd found = kept.factor.solve(inner);
  Eigen::VectorXd z(r.size());
  for (std::size_t k = 0; k < number.n.size(); ++k) {
    const bem::Mat2& d = w.values[w.diagonal[k]];
    if (number.n[k] >= 0) z[number.n[k]] = kept.number.n[k] >= 0 ? found[kept.number.n[k]] : r[number.n[k]] / d.xx;
    if (number.t[k] >= 0) z[number.t[k]] = kept.number.t[k] >= 0 ? found[kept.number.t[k]] : r[number.t[k]] / d.yy;
  }
  return z;
}

/// Right-preconditioned GMRES without restarts; empty when `most` steps do not reach the tolerance.
template <class Apply, class Precondition>
Eigen::VectorXd gmres(const Eigen::VectorXd& right, Eigen::Index most, double tolerance, Apply&& apply,
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
    if (std::abs(g[j + 1]) <= tolerance * size || left == 0) {
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

std::vector<Vec2> PatternSolver::solve(const BlockMatrix& w, double soft, const Pattern& pattern,
                                       const std::vector<Vec2>& rhs) {
  const Numbering number = dbem::number(pattern);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(number.count);
  Eigen::VectorXd z;
  if (number.count == 0) {
    assemble(w, soft, pattern, rhs, number, right, [](int, int, double) {});
  } else if (number.count <= dense_up_to) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(number.count, number.count);
    assemble(w, soft, pattern, rhs, number, right, [&](int r, int c, double v) { a(r, c) = v; });
    if (number.symmetric) {
      const Eigen::LLT<Eigen::MatrixXd> cholesky{a};
      z = cholesky.info() == Eigen::Success ? Eigen::VectorXd{cholesky.solve(right)}
                                            : Eigen::VectorXd{a.partialPivLu().solve(right)};
    } else {
      z = a.partialPivLu().solve(right);
    }
  } else {
    const auto slipping = static_cast<std::size_t>(std::ranges::count_if(pattern.q, [](double q) { return q != 0; }));
    const auto iterate = [&](Eigen::Index most) {
      z = gmres(
          right, most, 1e-12,
          [&](const Eigen::VectorXd& x, Eigen::VectorXd& out) { multiply(w, soft, pattern, number, x, out); },
          [&](const Eigen::VectorXd& r) { return precondition(*kept_, w, number, r); });
      return z.size() > 0;
    };
    bool done = false;
    if (10 * slipping < rhs.size()) {
      if (kept_ && kept_->number.n.size() == rhs.size() && kept_->soft <= 3 * soft && soft <= 3 * kept_->soft) {
        assemble(w, soft, pattern, rhs, number, right, [](int, int, double) {});
        done = iterate(15);
      }
      if (!done) {
        Pattern plain = pattern;
        plain.q.assign(plain.q.size(), 0.0);
        Eigen::VectorXd unused = Eigen::VectorXd::Zero(number.count);
        kept_ = std::make_unique<Kept>();
        kept_->number = number;
        kept_->soft = soft;
        kept_->factor.compute(sparse(w, soft, plain, rhs, number, unused, true));
        assemble(w, soft, pattern, rhs, number, right, [](int, int, double) {});
        if (kept_->factor.info() != Eigen::Success) {
          kept_.reset();
        } else if (slipping == 0) {
          z = kept_->factor.solve(right);
          Eigen::VectorXd back(right.size());
          multiply(w, soft, pattern, number, z, back);
          z += kept_->factor.solve(right - back);  // once more for the digits the regularisation costs
          done = true;
        } else {
          done = iterate(40);
        }
      }
    }
    if (!done) {
      const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu{sparse(w, soft, pattern, rhs, number, right, false)};
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
