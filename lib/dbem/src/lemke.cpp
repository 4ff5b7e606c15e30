#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "natural_map.hpp"

namespace cleave::dbem {

// z = (n + tau, t+, t-, gamma), w = (g, s + gamma, -s + gamma, mu n + c - t+ - t-), 0 <= w _|_ z >= 0 (Cottle and
// Dantzig 1968; the linear complementarity form of plane Coulomb friction: Klarbring 1986). Scaled by the mean
// diagonal.
std::vector<Vec2> lemke(const ContactProblem& problem, Work& work, std::size_t& pivots) {
  const auto m = static_cast<Eigen::Index>(problem.contacts());
  const Eigen::Index n = 4 * m;
  std::vector<Vec2> b = problem.b;
  std::vector<Vec2> pull(problem.contacts());
  for (std::size_t k = 0; k < pull.size(); ++k) pull[k].x = -problem.tension[k];
  problem.w.add_product(pull, b);
  double diagonal = 0;
  double load = 1e-300;
  for (std::size_t k = 0; k < b.size(); ++k) {
    const bem::Mat2& d = problem.w.values[problem.w.diagonal[k]];
    diagonal += (d.xx + d.yy) / (2 * static_cast<double>(m));
    load = std::max({load, std::abs(b[k].x), std::abs(b[k].y)});
  }
  Eigen::MatrixXd table = Eigen::MatrixXd::Zero(n, 2 * n + 2);  // w, -z, -z0, q
  table.leftCols(n).setIdentity();
  table.col(2 * n).setConstant(-1);
  for (std::size_t r = 0; r < b.size(); ++r) {
    const auto row = static_cast<Eigen::Index>(r);
    for (std::size_t at = problem.w.starts[r]; at < problem.w.starts[r + 1]; ++at) {
      const auto column = static_cast<Eigen::Index>(problem.w.columns[at]);
      const bem::Mat2 d = (1 / diagonal) * problem.w.values[at];
      const auto put = [&](Eigen::Index i, Eigen::Index j, double v) { table(i * m + row, n + j * m + column) = -v; };
      put(0, 0, d.xx);
      put(0, 1, d.xy);
      put(0, 2, -d.xy);
      put(1, 0, d.yx);
      put(1, 1, d.yy);
      put(1, 2, -d.yy);
      put(2, 0, -d.yx);
      put(2, 1, -d.yy);
      put(2, 2, d.yy);
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
  std::vector<Eigen::Index> basis(static_cast<std::size_t>(n));
  for (Eigen::Index k = 0; k < n; ++k) basis[static_cast<std::size_t>(k)] = k;
  Eigen::VectorXd z = Eigen::VectorXd::Zero(2 * n + 1);
  Eigen::Index row = 0;
  bool done = table.col(2 * n + 1).minCoeff(&row) >= 0;
  Eigen::Index column = 2 * n;
  const std::size_t most = 40 * static_cast<std::size_t>(n);
  for (pivots = 0; !done && pivots < most && !work.over(); ++pivots) {
    work.add(static_cast<double>(n) * static_cast<double>(2 * n + 2));
    table.row(row) /= table(row, column);
    Eigen::VectorXd factor = table.col(column);
    factor[row] = 0;
    const Eigen::RowVectorXd pivot_row = table.row(row);
    table.noalias() -= factor * pivot_row;
    const Eigen::Index out = basis[static_cast<std::size_t>(row)];
    basis[static_cast<std::size_t>(row)] = column;
    if (out == 2 * n) {
      done = true;
      break;
    }
    column = out < n ? out + n : out - n;
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index k = 0; k < n; ++k) {
      if (table(k, column) > 1e-11) least = std::min(least, std::max(table(k, 2 * n + 1), 0.0) / table(k, column));
    }
    if (!std::isfinite(least)) return {};
    row = -1;
    for (Eigen::Index k = 0; k < n; ++k) {
      if (!(table(k, column) > 1e-11)) continue;
      if (std::max(table(k, 2 * n + 1), 0.0) / table(k, column) > least + 1e-13 * std::max(1.0, least)) continue;
      if (basis[static_cast<std::size_t>(k)] == 2 * n) {
        row = k;
        break;
      }
      if (row < 0 || table(k, column) > table(row, column)) row = k;
    }
  }
  if (!done) return {};
  for (Eigen::Index k = 0; k < n; ++k) z[basis[static_cast<std::size_t>(k)]] = table(k, 2 * n + 1);
  std::vector<Vec2> p(b.size());
  for (std::size_t k = 0; k < b.size(); ++k) {
    const auto at = n + static_cast<Eigen::Index>(k);
    p[k] = {z[at] * load / diagonal - problem.tension[k], (z[at + m] - z[at + 2 * m]) * load / diagonal};
    if (!std::isfinite(p[k].x) || !std::isfinite(p[k].y)) return {};
  }
  return p;
}

}  // namespace cleave::dbem
