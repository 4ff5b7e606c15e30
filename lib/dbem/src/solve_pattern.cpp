#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <Eigen/SparseLU>
#include <cmath>

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

}  // namespace

std::vector<Vec2> solve_pattern(const BlockMatrix& w, double soft, const Pattern& pattern,
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
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(w.values.size() * 4);
    assemble(w, soft, pattern, rhs, number, right, [&](int r, int c, double v) {
      if (!number.symmetric || r >= c) entries.emplace_back(r, c, v);
    });
    Eigen::SparseMatrix<double> a(number.count, number.count);
    a.setFromTriplets(entries.begin(), entries.end());
    bool done = false;
    if (number.symmetric) {
      const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> cholesky{a};
      if (cholesky.info() == Eigen::Success) {
        z = cholesky.solve(right);
        done = true;
      } else {
        a = Eigen::SparseMatrix<double>{a.selfadjointView<Eigen::Lower>()};
      }
    }
    if (!done) {
      const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu{a};
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
