#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "cleave/survey/traces.hpp"

/// What maximum likelihood of a law of one or two parameters needs.
namespace cleave::survey::detail {

/// Number of parameters that are fitted.
[[nodiscard]] constexpr int parameters(Family family) noexcept {
  return family == Family::lognormal || family == Family::gamma || family == Family::normal ? 2 : 1;
}
/// Parameters on the real line to a law; `min` and `max` are the limits of a power law.
[[nodiscard]] Fit law_at(Family family, const std::array<double, 2>& p, double min, double max);
/// Where to begin the search, for lengths of about this mean.
[[nodiscard]] std::array<double, 2> start_of(Family family, double mean);

/// Minimum of f over two variables by the simplex method (Nelder & Mead 1965), restarted once.
template <class F>
std::array<double, 2> minimum(std::array<double, 2> start, F&& f) {
  using Point = std::pair<double, std::array<double, 2>>;
  for (int restart = 0; restart < 2; ++restart) {
    std::array<Point, 3> s;
    for (std::size_t i = 0; i < 3; ++i) {
      std::array<double, 2> p = start;
      if (i > 0) p[i - 1] += 0.3;
      s[i] = {f(p), p};
    }
    const auto at = [&](const std::array<double, 2>& c, double t) {
      const std::array<double, 2> p{c[0] + t * (s[2].second[0] - c[0]), c[1] + t * (s[2].second[1] - c[1])};
      return Point{f(p), p};
    };
    for (int step = 0; step < 400; ++step) {
      std::ranges::sort(s, {}, &Point::first);
      if (std::abs(s[2].first - s[0].first) <= 1e-12 * (std::abs(s[0].first) + 1e-12)) break;
      const std::array<double, 2> c{(s[0].second[0] + s[1].second[0]) / 2, (s[0].second[1] + s[1].second[1]) / 2};
      const Point reflected = at(c, -1);
      if (reflected.first < s[0].first) {
        const Point further = at(c, -2);
        s[2] = further.first < reflected.first ? further : reflected;
      } else if (reflected.first < s[1].first) {
        s[2] = reflected;
      } else {
        const Point inside = reflected.first < s[2].first ? at(c, -0.5) : at(c, 0.5);
        if (inside.first < std::min(reflected.first, s[2].first)) {
          s[2] = inside;
        } else {
          for (std::size_t i = 1; i < 3; ++i) {
            auto& p = s[i].second;
            p = {(p[0] + s[0].second[0]) / 2, (p[1] + s[0].second[1]) / 2};
            s[i].first = f(p);
          }
        }
      }
    }
    std::ranges::sort(s, {}, &Point::first);
    start = s[0].second;
  }
  return start;
}

/// One standard error along each column of the Cholesky factor of the inverse Hessian of `loss` at `p`.
template <class Loss>
std::vector<std::array<double, 2>> one_error_away(const std::array<double, 2>& p, std::size_t parameters, Loss&& loss) {
  constexpr double h = 1e-3;
  const auto at = [&](double du, double dv) { return loss({p[0] + du * h, p[1] + dv * h}); };
  const double middle = at(0, 0);
  const double uu = (at(1, 0) - 2 * middle + at(-1, 0)) / (h * h);
  if (parameters == 1) {
    if (!(uu > 0) || !std::isfinite(uu)) return {};
    return {{p[0] + 1 / std::sqrt(uu), p[1]}};
  }
  const double vv = (at(0, 1) - 2 * middle + at(0, -1)) / (h * h);
  const double uv = (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h * h);
  const double determinant = uu * vv - uv * uv;
  if (!(uu > 0) || !(vv > 0) || !(determinant > 0) || !std::isfinite(determinant)) return {};
  const double first = std::sqrt(vv / determinant);  // of the covariance [vv, -uv; -uv, uu]/determinant
  const double across = -uv / determinant / first;
  const double second = std::sqrt(std::max(0.0, uu / determinant - across * across));
  return {{p[0] + first, p[1] + across}, {p[0], p[1] + second}};
}

}  // namespace cleave::survey::detail
