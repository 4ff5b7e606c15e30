#include "oracles.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stability_oracle {

namespace least_squares {

Real dot(const V& a, const V& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

namespace {

/// Solves the normal equations of the chosen columns by elimination with pivots; false when they are dependent.
bool solve(const std::vector<V>& n, const std::vector<std::size_t>& chosen, const V& b, std::vector<Real>& x) {
  const std::size_t m = chosen.size();
  std::vector<std::vector<Real>> a(m, std::vector<Real>(m + 1));
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < m; ++j) a[i][j] = dot(n[chosen[i]], n[chosen[j]]);
    a[i][m] = dot(n[chosen[i]], b);
  }
  for (std::size_t c = 0; c < m; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c; r < m; ++r) {
      if (std::abs(a[r][c]) > std::abs(a[pivot][c])) pivot = r;
    }
    if (std::abs(a[pivot][c]) < 1e-14L) return false;
    std::swap(a[c], a[pivot]);
    for (std::size_t r = 0; r < m; ++r) {
      if (r == c) continue;
      const Real f = a[r][c] / a[c][c];
      for (std::size_t k = c; k <= m; ++k) a[r][k] -= f * a[c][k];
    }
  }
  x.resize(m);
  for (std::size_t c = 0; c < m; ++c) x[c] = a[c][m] / a[c][c];
  return true;
}

}  // namespace

Left residual(const std::vector<V>& n, const V& r, bool broken) {
  std::vector<std::size_t> chosen;
  std::vector<Real> x(n.size(), 0);
  V s = r;
  for (int iteration = 0; iteration < 200; ++iteration) {
    std::size_t worst = n.size();
    Real least = -1e-13L;
    for (std::size_t k = 0; k < n.size(); ++k) {
      if (x[k] > 0 || std::ranges::find(chosen, k) != chosen.end()) continue;
      const Real along = dot(n[k], s);
      if (along < least) {
        least = along;
        worst = k;
      }
    }
    if (worst == n.size() || (broken && chosen.size() == 1)) break;
    chosen.push_back(worst);
    for (;;) {
      std::vector<Real> y;
      if (!solve(n, chosen, {-r[0], -r[1], -r[2]}, y)) {
        x[chosen.back()] = 0;
        chosen.pop_back();
        break;
      }
      Real step = 1;
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        if (y[i] <= 0) step = std::min(step, x[chosen[i]] / (x[chosen[i]] - y[i]));
      }
      for (std::size_t i = 0; i < chosen.size(); ++i) x[chosen[i]] += step * (y[i] - x[chosen[i]]);
      if (step >= 1) break;
      std::erase_if(chosen, [&](std::size_t k) {
        if (x[k] > 1e-15L) return false;
        x[k] = 0;
        return true;
      });
    }
    s = r;
    for (std::size_t k = 0; k < n.size(); ++k) {
      for (std::size_t c = 0; c < 3; ++c) s[c] += x[k] * n[k][c];
    }
  }
  return {s, static_cast<std::size_t>(std::ranges::count_if(x, [](Real v) { return v > 1e-12L; }))};
}

/// K = {0} when the normals positively span space: every axis, both ways, is a non-negative sum of them.
bool removable(const std::vector<V>& n) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (const Real sign : {-1.0L, 1.0L}) {
      V e{};
      e[c] = sign;
      const V left = residual(n, e).s;
      if (dot(left, left) > 1e-18L) return true;
    }
  }
  return false;
}

}  // namespace least_squares

namespace exhaustion {
namespace {

V sum(V a, double f, V b) { return {a.x + f * b.x, a.y + f * b.y, a.z + f * b.z}; }
double times(V a, V b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
V across(V a, V b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

}  // namespace

V residual(const std::vector<V>& n, V r) {
  V best = r;
  const auto offer = [&](V s) {
    if (times(s, s) < times(best, best)) best = s;
  };
  for (std::size_t i = 0; i < n.size(); ++i) {
    const double ni = -times(n[i], r);
    if (ni >= 0) offer(sum(r, ni, n[i]));
    for (std::size_t j = i + 1; j < n.size(); ++j) {
      const double c = times(n[i], n[j]), q = 1 - c * c;
      if (q > 1e-14) {
        const double a = (c * times(n[j], r) - times(n[i], r)) / q, b = (c * times(n[i], r) - times(n[j], r)) / q;
        if (a >= 0 && b >= 0) offer(sum(sum(r, a, n[i]), b, n[j]));
      }
      for (std::size_t k = j + 1; k < n.size(); ++k) {
        const double d = times(across(n[i], n[j]), n[k]);
        if (std::abs(d) < 1e-14) continue;
        const double a = -times(across(n[j], n[k]), r) / d, b = -times(across(n[k], n[i]), r) / d,
                     e = -times(across(n[i], n[j]), r) / d;
        if (a >= 0 && b >= 0 && e >= 0) offer({0, 0, 0});
      }
    }
  }
  return best;
}

double distance(V a, V b) {
  const V d = sum(a, -1, b);
  return std::sqrt(times(d, d));
}

}  // namespace exhaustion

namespace {

/// Rank of a set of integer vectors, by Gram-Schmidt in integers on at most three of them.
int rank_of(const std::vector<std::array<int, 3>>& vectors) {
  const auto cross = [](const auto& a, const auto& b) {
    return std::array{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const std::array none{0, 0, 0};
  std::array<int, 3> first = none, across = none;
  for (const auto& v : vectors) {
    if (v == none) continue;
    if (first == none) {
      first = v;
    } else if (across == none) {
      across = cross(first, v);
    } else if (across[0] * v[0] + across[1] * v[1] + across[2] * v[2] != 0) {
      return 3;
    }
  }
  return across != none ? 2 : first != none ? 1 : 0;
}

}  // namespace

int dimension_by_exhaustion(const std::vector<std::array<int, 3>>& normals) {
  std::vector<std::array<int, 3>> admissible;
  constexpr int reach = 4;
  for (int x = -reach; x <= reach; ++x) {
    for (int y = -reach; y <= reach; ++y) {
      for (int z = -reach; z <= reach; ++z) {
        const bool ok =
            std::ranges::all_of(normals, [&](const auto& n) { return n[0] * x + n[1] * y + n[2] * z >= 0; });
        if (ok) admissible.push_back({x, y, z});
      }
    }
  }
  return rank_of(admissible);
}

}  // namespace stability_oracle
