#include "nonnegative.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace cleave::stability {
namespace {

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

void subtract(std::vector<double>& from, double factor, const std::vector<double>& what) {
  for (std::size_t i = 0; i < from.size(); ++i) from[i] -= factor * what[i];
}

/// Least squares on the chosen columns by orthogonalisation (twice, so that it is orthogonal to rounding); empty when
/// one depends on those before it.
std::optional<std::vector<double>> solve(const Columns& a, const std::vector<std::size_t>& chosen,
                                         const std::vector<double>& b) {
  const std::size_t n = chosen.size();
  Columns q;
  std::vector<std::vector<double>> r(n, std::vector<double>(n, 0));
  for (std::size_t j = 0; j < n; ++j) {
    std::vector<double> column = a[chosen[j]];
    const double before = std::sqrt(dot(column, column));
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t i = 0; i < j; ++i) {
        const double part = dot(q[i], column);
        r[i][j] += part;
        subtract(column, part, q[i]);
      }
    }
    r[j][j] = std::sqrt(dot(column, column));
    if (!(r[j][j] > 1e-12 * before)) return std::nullopt;
    for (double& c : column) c /= r[j][j];
    q.push_back(std::move(column));
  }
  std::vector<double> x(n, 0);
  std::vector<double> left = b;
  for (std::size_t j = 0; j < n; ++j) {
    x[j] = dot(q[j], left);
    subtract(left, x[j], q[j]);
  }
  for (std::size_t j = n; j-- > 0;) {
    for (std::size_t k = j + 1; k < n; ++k) x[j] -= r[j][k] * x[k];
    x[j] /= r[j][j];
  }
  return x;
}

class Solver final {
 public:
  Solver(const Columns& a, const std::vector<double>& b) : b_{b}, x_(a.size(), 0), residual_{b} {
    for (const auto& column : a) {
      const double length = std::sqrt(dot(column, column));
      length_.push_back(length > 0 ? length : 1);
      a_.push_back(column);
      for (double& c : a_.back()) c /= length_.back();
    }
  }

  NonNegative run() {
    const double enough = 1e-13 * std::sqrt(dot(b_, b_));
    std::vector<bool> barred(a_.size(), false);
    // Each round ends at another set of columns with a smaller residual; the bound is against rounding only.
    for (std::size_t round = 0; round < 3 * a_.size() + 30; ++round) {
      std::optional<std::size_t> best;
      double steepest = enough;
      for (std::size_t j = 0; j < a_.size(); ++j) {
        if (barred[j] || std::ranges::find(chosen_, j) != chosen_.end()) continue;
        const double slope = dot(a_[j], residual_);
        if (slope > steepest) {
          steepest = slope;
          best = j;
        }
      }
      if (!best) break;
      if (enter(*best)) {
        std::fill(barred.begin(), barred.end(), false);
      } else {
        barred[*best] = true;
      }
    }
    for (std::size_t j = 0; j < x_.size(); ++j) x_[j] /= length_[j];
    return {std::move(x_), std::move(residual_)};
  }

 private:
  bool enter(std::size_t column) {
    chosen_.push_back(column);
    auto z = solve(a_, chosen_, b_);
    if (!z || !(z->back() > 0)) {
      chosen_.pop_back();
      return false;
    }
    while (std::ranges::any_of(*z, [](double v) { return !(v > 0); })) {
      double step = 1;
      for (std::size_t i = 0; i < chosen_.size(); ++i) {
        const double now = x_[chosen_[i]];
        if (!((*z)[i] > 0)) step = std::min(step, now / (now - (*z)[i]));
      }
      for (std::size_t i = 0; i < chosen_.size(); ++i) {
        double& now = x_[chosen_[i]];
        now += step * ((*z)[i] - now);
        if (!((*z)[i] > 0) && now < 1e-15) now = 0;
      }
      const std::size_t before = chosen_.size();
      std::erase_if(chosen_, [&](std::size_t j) { return !(x_[j] > 0); });
      if (chosen_.size() == before) {  // rounding kept the one that stops us
        const auto least = std::ranges::min_element(chosen_, {}, [&](std::size_t j) { return x_[j]; });
        x_[*least] = 0;
        chosen_.erase(least);
      }
      z = solve(a_, chosen_, b_);
      if (!z) break;
    }
    if (z) {
      for (std::size_t i = 0; i < chosen_.size(); ++i) x_[chosen_[i]] = (*z)[i];
    }
    residual_ = b_;
    for (const std::size_t j : chosen_) subtract(residual_, x_[j], a_[j]);
    return true;
  }

  std::vector<double> b_;
  Columns a_;
  std::vector<double> length_;
  std::vector<double> x_;
  std::vector<std::size_t> chosen_;
  std::vector<double> residual_;
};

}  // namespace

NonNegative nonnegative_least_squares(const Columns& a, const std::vector<double>& b) { return Solver{a, b}.run(); }

NonNegative shortest_nonnegative(const Columns& a, const std::vector<double>& b) {
  // A small price on the length of x makes it unique; what it costs in the residual is put right afterwards.
  constexpr double price = 1e-5;
  Columns priced = a;
  for (std::size_t j = 0; j < a.size(); ++j) {
    priced[j].resize(b.size() + a.size(), 0);
    priced[j][b.size() + j] = price * std::sqrt(dot(a[j], a[j]));
  }
  std::vector<double> target = b;
  target.resize(b.size() + a.size(), 0);
  NonNegative found = nonnegative_least_squares(priced, target);
  found.residual.resize(b.size());
  for (int pass = 0; pass < 2; ++pass) {
    // The shortest change of the columns in use that takes the residual away: x += A'(A A')^+ (b - A x), by a basis of
    // what they span.
    std::vector<std::size_t> used;
    for (std::size_t j = 0; j < a.size(); ++j) {
      if (found.x[j] > 0) used.push_back(j);
    }
    std::vector<double> left = b;
    for (const std::size_t j : used) subtract(left, found.x[j], a[j]);
    std::vector<std::size_t> basis;
    for (const std::size_t j : used) {
      basis.push_back(j);
      if (!solve(a, basis, b)) basis.pop_back();
    }
    const auto change = solve(a, basis, left);
    if (!change) break;
    std::vector<double> x = found.x;
    bool good = true;
    for (std::size_t i = 0; i < basis.size(); ++i) {
      x[basis[i]] += (*change)[i];
      good = good && x[basis[i]] >= 0;
    }
    if (!good) break;
    found.x = std::move(x);
  }
  found.residual = b;
  for (std::size_t j = 0; j < a.size(); ++j) subtract(found.residual, found.x[j], a[j]);
  return found;
}

}  // namespace cleave::stability
