#include "cleave/survey/fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"

namespace cleave::survey {
namespace {

constexpr double tiny = 1e-300;

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

/// Parameters on the real line to a law.
Fit law_at(Family family, const std::array<double, 2>& p, double min, double max) {
  Fit fit;
  fit.family = family;
  switch (family) {
    case Family::exponential: fit.a = std::exp(p[0]); break;
    case Family::lognormal:
      fit.a = p[0];
      fit.b = std::exp(std::clamp(p[1], -20.0, 3.0));
      break;
    case Family::gamma:
      fit.a = std::exp(std::clamp(p[0], -4.0, 12.0));
      fit.b = std::exp(std::clamp(p[1], -40.0, 40.0));
      break;
    case Family::power:
      fit.a = std::exp(std::clamp(p[0], -4.0, 4.0));
      fit.min = min;
      fit.max = max;
      break;
  }
  return fit;
}

double log_likelihood(const Fit& fit, std::span<const SeenLength> lengths, const Meeting& meeting) {
  double sum = 0;
  for (const SeenLength& l : lengths) {
    const double v = l.ends == 2   ? fit.density(l.length)
                     : l.ends == 1 ? 1 - fit.below(l.length)
                                   : fit.mean_excess(l.length);
    sum += std::log(std::max(v, tiny));
  }
  return sum -
         static_cast<double>(lengths.size()) * std::log(std::max(meeting.area + meeting.width * fit.moment(1), tiny));
}

double distance_of(std::vector<double> values, const Fit& fit) {
  std::ranges::sort(values);
  const auto n = static_cast<double>(values.size());
  double d = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double f = fit.below(values[i]), k = static_cast<double>(i);
    d = std::max({d, f - k / n, (k + 1) / n - f});
  }
  return d;
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

int parameters(Family family) { return family == Family::exponential || family == Family::power ? 1 : 2; }

}  // namespace

std::string_view name_of(Family family) noexcept {
  switch (family) {
    case Family::exponential: return "exponential";
    case Family::lognormal: return "lognormal";
    case Family::gamma: return "gamma";
    case Family::power: return "power";
  }
  std::unreachable();
}

double Fit::density(double x) const {
  if (!(x > 0)) return 0;
  switch (family) {
    case Family::exponential: return std::exp(-x / a) / a;
    case Family::lognormal: {
      const double z = (std::log(x) - a) / b;
      return std::exp(-z * z / 2) / (x * b * std::sqrt(2 * std::numbers::pi));
    }
    case Family::gamma: return std::exp((a - 1) * std::log(x / b) - x / b - special::log_gamma(a)) / b;
    case Family::power:
      if (x < min || x > max) return 0;
      return a * std::pow(x, -a - 1) / (std::pow(min, -a) - std::pow(max, -a));
  }
  std::unreachable();
}

double Fit::below(double x) const {
  if (!(x > 0)) return 0;
  switch (family) {
    case Family::exponential: return -std::expm1(-x / a);
    case Family::lognormal: return special::normal_cdf((std::log(x) - a) / b);
    case Family::gamma: return special::gamma_below(a, x / b);
    case Family::power:
      if (x <= min) return 0;
      if (x >= max) return 1;
      return (std::pow(min, -a) - std::pow(x, -a)) / (std::pow(min, -a) - std::pow(max, -a));
  }
  std::unreachable();
}

double Fit::quantile(double u) const {
  switch (family) {
    case Family::exponential: return -a * std::log1p(-u);
    case Family::lognormal: return std::exp(a + b * normal_quantile(u));
    case Family::gamma: return b * special::gamma_below_inverse(a, u);
    case Family::power: return std::pow(std::pow(min, -a) - u * (std::pow(min, -a) - std::pow(max, -a)), -1 / a);
  }
  std::unreachable();
}

double Fit::moment(int k) const {
  switch (family) {
    case Family::exponential: return std::tgamma(k + 1.0) * std::pow(a, k);
    case Family::lognormal: return std::exp(k * a + k * k * b * b / 2);
    case Family::gamma: {
      double m = 1;
      for (int i = 0; i < k; ++i) m *= (a + i) * b;
      return m;
    }
    case Family::power: {
      const double c = a / (std::pow(min, -a) - std::pow(max, -a));
      return std::abs(k - a) < 1e-9 ? c * std::log(max / min)
                                    : c * (std::pow(max, k - a) - std::pow(min, k - a)) / (k - a);
    }
  }
  std::unreachable();
}

double Fit::mean_excess(double x) const {
  switch (family) {
    case Family::exponential: return a * std::exp(-x / a);
    case Family::lognormal:
      return std::exp(a + b * b / 2) * special::normal_cdf(b - (std::log(x) - a) / b) - x * (1 - below(x));
    case Family::gamma: return a * b * special::gamma_above(a + 1, x / b) - x * special::gamma_above(a, x / b);
    case Family::power: {
      if (x >= max) return 0;
      const double from = std::max(x, min), c = a / (std::pow(min, -a) - std::pow(max, -a));
      const double tail = std::abs(1 - a) < 1e-9 ? c * std::log(max / from)
                                                 : c * (std::pow(max, 1 - a) - std::pow(from, 1 - a)) / (1 - a);
      return tail - x * (1 - below(x));
    }
  }
  std::unreachable();
}

std::optional<Fit> fit_lengths(std::span<const SeenLength> lengths, const Meeting& meeting, Family family) {
  double sum = 0, ended = 0, low = INFINITY, high = 0;
  for (const SeenLength& l : lengths) {
    if (!(l.length > 0)) continue;
    sum += l.length;
    ended += l.ends;
    low = std::min(low, l.length);
    high = std::max(high, l.length);
  }
  if (!(ended > 0) || !(sum > 0)) return std::nullopt;
  if (family == Family::power && !(high > low)) return std::nullopt;
  const double mean = sum / (0.5 * ended);
  const std::array<double, 2> start = family == Family::exponential ? std::array{std::log(mean), 0.0}
                                      : family == Family::lognormal ? std::array{std::log(mean) - 0.3, std::log(0.8)}
                                      : family == Family::gamma     ? std::array{0.3, std::log(mean) - 0.3}
                                                                    : std::array{0.5, 0.0};
  const auto law = [&](std::array<double, 2> p) {
    if (parameters(family) == 1) p[1] = 0;
    return law_at(family, p, low * (1 - 1e-12), 10 * high);
  };
  const auto loss = [&](const std::array<double, 2>& p) {
    const double extra = parameters(family) == 1 ? p[1] * p[1] : 0;  // an unused variable is drawn to 0
    const double l = -log_likelihood(law(p), lengths, meeting) + extra;
    return std::isfinite(l) ? l : 1e300;
  };
  const std::array<double, 2> best = minimum(start, loss);
  Fit fit = law(best);
  for (const auto& p : one_error_away(best, static_cast<std::size_t>(parameters(family)), loss)) {
    const Fit moved = law(p);
    fit.moved.push_back({moved.a, moved.b});
  }
  fit.log_likelihood = log_likelihood(fit, lengths, meeting);
  fit.aic = 2 * parameters(family) - 2 * fit.log_likelihood;
  std::vector<double> complete;
  for (const SeenLength& l : lengths) {
    if (l.ends == 2) complete.push_back(l.length);
  }
  if (!complete.empty()) fit.distance = distance_of(std::move(complete), fit);
  return fit;
}

double std_of(const Fit& fit) { return std::sqrt(std::max(0.0, fit.moment(2) - fit.moment(1) * fit.moment(1))); }

Estimate estimate_of(const Fit& fit, std::string name, const std::function<std::optional<double>(const Fit&)>& figure,
                     double confidence) {
  Estimate e{std::move(name), figure(fit), 0, INFINITY, "maximum likelihood, delta method on the logarithm", ""};
  if (!e.value || !(*e.value > 0) || fit.moved.empty()) return e;
  double square = 0;
  for (const auto& [a, b] : fit.moved) {
    Fit moved = fit;
    moved.a = a;
    moved.b = b;
    const auto value = figure(moved);
    if (!value || !(*value > 0)) return e;
    const double change = std::log(*value / *e.value);
    square += change * change;
  }
  const double half = normal_quantile(0.5 + confidence / 2) * std::sqrt(square);
  e.low = *e.value * std::exp(-half);
  e.high = *e.value * std::exp(half);
  return e;
}

std::optional<Fit> fit_complete(std::span<const double> values, Family family, std::uint32_t resamples,
                                std::uint64_t seed) {
  std::vector<SeenLength> lengths;
  for (const double v : values) {
    if (v > 0) lengths.push_back({v, 2});
  }
  auto fit = fit_lengths(lengths, {1, 0}, family);
  if (!fit || resamples == 0 || lengths.size() < 5) return fit;
  std::uint32_t larger = 0;
  for (std::uint32_t b = 0; b < resamples; ++b) {
    Rng rng{{.seed = seed, .realization = 1, .purpose = 0xfffffffeU, .index = b}};
    std::vector<double> sample(lengths.size());
    for (double& v : sample) v = fit->quantile(rng.uniform());
    const auto again = fit_complete(sample, family, 0, seed);
    larger += again && again->distance >= fit->distance ? 1U : 0U;
  }
  fit->p_value = (1.0 + larger) / (1.0 + resamples);
  return fit;
}

ChiSquared chi_squared(std::span<const double> values, const Fit& fit) {
  ChiSquared result;
  result.bins = std::min<std::size_t>(values.size() / 5, 30);
  if (result.bins < 3) return result;
  std::vector<double> counts(result.bins, 0);
  for (const double v : values) {
    const double u = fit.below(v) * static_cast<double>(result.bins);
    counts[std::min(static_cast<std::size_t>(u), result.bins - 1)] += 1;
  }
  const double expected = static_cast<double>(values.size()) / static_cast<double>(result.bins);
  for (const double c : counts) result.statistic += (c - expected) * (c - expected) / expected;
  const double most = static_cast<double>(result.bins - 1);
  result.p_high = special::chi_squared_above(result.statistic, most);
  result.p_low = special::chi_squared_above(result.statistic, std::max(1.0, most - parameters(fit.family)));
  return result;
}

}  // namespace cleave::survey
