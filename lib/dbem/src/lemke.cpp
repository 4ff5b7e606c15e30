#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "natural_map.hpp"

namespace cleave::dbem {

namespace {

using Eigen::Index;

/// z = (n + tau, t+, t-, gamma), w = (g, s + gamma, -s + gamma, mu n + c - t+ - t-), 0 <= w _|_ z >= 0 (Cottle and
/// Dantzig 1968; the linear complementarity form of plane Coulomb friction: Klarbring 1986). Scaled by the mean
/// diagonal. Columns: w, -z, -z0, q.
struct Tableau {
  double diagonal = 0, load = 1e-300;
  Eigen::MatrixXd table;
  std::vector<Index> basis;

  explicit Tableau(const ContactProblem& problem);
  [[nodiscard]] Index rows() const { return table.rows(); }
  void pivot(Index row, Index column);
  /// Where `column` comes in: the row of the smallest ratio, z0 before others. Empty when nothing holds it.
  [[nodiscard]] std::optional<Index> row_for(Index column) const;
};

Tableau::Tableau(const ContactProblem& problem) {
  const auto m = static_cast<Index>(problem.contacts());
  const Index n = 4 * m;
  std::vector<Vec2> b = problem.b;
  std::vector<Vec2> pull(problem.contacts());
  for (std::size_t k = 0; k < pull.size(); ++k) pull[k].x = -problem.tension[k];
  problem.w.add_product(pull, b);
  for (std::size_t k = 0; k < b.size(); ++k) {
    const bem::Mat2& d = problem.w.values[problem.w.diagonal[k]];
    diagonal += (d.xx + d.yy) / (2 * static_cast<double>(m));
    load = std::max({load, std::abs(b[k].x), std::abs(b[k].y)});
  }
  table = Eigen::MatrixXd::Zero(n, 2 * n + 2);
  table.leftCols(n).setIdentity();
  table.col(2 * n).setConstant(-1);
  for (std::size_t r = 0; r < b.size(); ++r) {
    const auto row = static_cast<Index>(r);
    for (std::size_t at = problem.w.starts[r]; at < problem.w.starts[r + 1]; ++at) {
      const auto column = static_cast<Index>(problem.w.columns[at]);
      const bem::Mat2 d = (1 / diagonal) * problem.w.values[at];
      const std::array<std::array<double, 3>, 3> by{{{d.xx, d.xy, -d.xy}, {d.yx, d.yy, -d.yy}, {-d.yx, -d.yy, d.yy}}};
      for (Index i = 0; i < 3; ++i) {
        for (Index j = 0; j < 3; ++j) {
          table(i * m + row, n + j * m + column) = -by[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
        }
      }
    }
    table(m + row, n + 3 * m + row) = -1;
    table(2 * m + row, n + 3 * m + row) = -1;
    table(3 * m + row, n + row) = -problem.mu[r];
    table(3 * m + row, n + m + row) = 1;
    table(3 * m + row, n + 2 * m + row) = 1;
    const double c = std::max(0.0, problem.cohesion[r] - problem.mu[r] * problem.tension[r]);
    table(row, 2 * n + 1) = b[r].x / load;
    table(m + row, 2 * n + 1) = b[r].y / load;
    table(2 * m + row, 2 * n + 1) = -b[r].y / load;
    table(3 * m + row, 2 * n + 1) = c * diagonal / load;
  }
  basis.resize(static_cast<std::size_t>(n));
  std::iota(basis.begin(), basis.end(), Index{0});
}

void Tableau::pivot(Index row, Index column) {
  table.row(row) /= table(row, column);
  Eigen::VectorXd factor = table.col(column);
  factor[row] = 0;
  const Eigen::RowVectorXd pivot_row = table.row(row);
  table.noalias() -= factor * pivot_row;
}

std::optional<Index> Tableau::row_for(Index column) const {
  const Index n = rows();
  double least = std::numeric_limits<double>::infinity();
  for (Index k = 0; k < n; ++k) {
    if (table(k, column) > 1e-11) least = std::min(least, std::max(table(k, 2 * n + 1), 0.0) / table(k, column));
  }
  if (!std::isfinite(least)) return std::nullopt;
  std::optional<Index> row;
  for (Index k = 0; k < n; ++k) {
    if (!(table(k, column) > 1e-11)) continue;
    if (std::max(table(k, 2 * n + 1), 0.0) / table(k, column) > least + 1e-13 * std::max(1.0, least)) continue;
    if (basis[static_cast<std::size_t>(k)] == 2 * n) return k;
    if (!row || table(k, column) > table(*row, column)) row = k;
  }
  return row;
}

}  // namespace

std::vector<Vec2> lemke(const ContactProblem& problem, Work& work, std::size_t& pivots) {
  Tableau t{problem};
  const Index n = t.rows(), m = n / 4;
  Index row = 0;
  bool done = t.table.col(2 * n + 1).minCoeff(&row) >= 0;
  Index column = 2 * n;
  const std::size_t most = 40 * static_cast<std::size_t>(n);
  for (pivots = 0; !done && pivots < most && !work.over(); ++pivots) {
    work.add(static_cast<double>(n) * static_cast<double>(2 * n + 2));
    t.pivot(row, column);
    const Index out = std::exchange(t.basis[static_cast<std::size_t>(row)], column);
    if (out == 2 * n) {
      done = true;
      break;
    }
    column = out < n ? out + n : out - n;
    const auto next = t.row_for(column);
    if (!next) return {};
    row = *next;
  }
  if (!done) return {};
  Eigen::VectorXd z = Eigen::VectorXd::Zero(2 * n + 1);
  for (Index k = 0; k < n; ++k) z[t.basis[static_cast<std::size_t>(k)]] = t.table(k, 2 * n + 1);
  std::vector<Vec2> p(problem.contacts());
  for (std::size_t k = 0; k < p.size(); ++k) {
    const auto at = n + static_cast<Index>(k);
    p[k] = {z[at] * t.load / t.diagonal - problem.tension[k], (z[at + m] - z[at + 2 * m]) * t.load / t.diagonal};
    if (!std::isfinite(p[k].x) || !std::isfinite(p[k].y)) return {};
  }
  return p;
}

}  // namespace cleave::dbem
