#include "cleave/survey/traces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "cleave/core/fields.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"
#include "maximum_likelihood.hpp"

namespace cleave::survey {
namespace {

constexpr double tiny = 1e-300;

/// What a normal law leaves above 0.
double above_zero(const Fit& fit) { return special::normal_cdf(fit.a / fit.b); }

double log_likelihood(const Fit& fit, std::span<const SeenLength> lengths, const Meeting& meeting) {
  double sum = 0;
  for (const SeenLength& l : lengths) {
    const double v = l.ends == 2   ? fit.density(l.length)
                     : l.ends == 1 ? 1 - fit.below(l.length)
                                   : fit.mean_excess(l.length);
    sum += std::log(std::max(v, tiny));
  }
  const double met = meeting.chance(1 - fit.below(meeting.truncation), fit.mean_excess(meeting.truncation));
  return sum - static_cast<double>(lengths.size()) * std::log(std::max(met, tiny));
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

}  // namespace

namespace detail {

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
    case Family::normal:
      fit.a = std::exp(std::clamp(p[0], -40.0, 40.0));
      fit.b = std::exp(std::clamp(p[1], -40.0, 40.0));
      break;
    case Family::constant: fit.a = std::exp(p[0]); break;
  }
  return fit;
}

std::array<double, 2> start_of(Family family, double mean) {
  switch (family) {
    case Family::exponential: return {std::log(mean), 0.0};
    case Family::lognormal: return {std::log(mean) - 0.3, std::log(0.8)};
    case Family::gamma: return {0.3, std::log(mean) - 0.3};
    case Family::power: return {0.5, 0.0};
    case Family::normal: return {std::log(mean), std::log(mean) - 0.7};
    case Family::constant: return {std::log(mean), 0.0};
  }
  std::unreachable();
}

}  // namespace detail

std::string_view name_of(Family family) noexcept { return enum_name(family); }

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
    case Family::normal: return special::normal_density((x - a) / b) / (b * above_zero(*this));
    case Family::constant: return 0;  // it has none
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
    case Family::normal: return 1 - special::normal_cdf((a - x) / b) / above_zero(*this);
    case Family::constant: return x < a ? 0 : 1;
  }
  std::unreachable();
}

double Fit::quantile(double u) const {
  switch (family) {
    case Family::exponential: return -a * std::log1p(-u);
    case Family::lognormal: return std::exp(a + b * normal_quantile(u));
    case Family::gamma: return b * special::gamma_below_inverse(a, u);
    case Family::power: return std::pow(std::pow(min, -a) - u * (std::pow(min, -a) - std::pow(max, -a)), -1 / a);
    case Family::normal: return std::max(0.0, a - b * normal_quantile((1 - u) * above_zero(*this)));
    case Family::constant: return a;
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
    case Family::normal: {
      double before = 1, m = a + b * special::normal_density(a / b) / above_zero(*this);
      for (int i = 2; i <= k; ++i) before = std::exchange(m, a * m + (i - 1) * b * b * before);
      return m;
    }
    case Family::constant: return std::pow(a, k);
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
    case Family::normal: {
      const double z = (x - a) / b;
      return std::max(0.0, b * (special::normal_density(z) - z * special::normal_cdf(-z)) / above_zero(*this));
    }
    case Family::constant: return std::max(0.0, a - x);
  }
  std::unreachable();
}

double Meeting::chance(double survival, double excess) const noexcept {
  return area > 0 ? (area - width * truncation) * survival + width * excess : width * (excess + truncation * survival);
}

std::optional<Fit> fit_lengths(std::span<const SeenLength> all, const Meeting& meeting, Family family) {
  std::vector<SeenLength> lengths;
  for (const SeenLength& l : all) {
    if (l.length > 0 && l.length >= meeting.truncation) lengths.push_back(l);
  }
  double sum = 0, ended = 0, low = INFINITY, high = 0;
  for (const SeenLength& l : lengths) {
    sum += l.length;
    ended += l.ends;
    low = std::min(low, l.length);
    high = std::max(high, l.length);
  }
  if (!(ended > 0) || !(sum > 0)) return std::nullopt;
  if (family == Family::power && !(high > low)) return std::nullopt;
  const double mean = sum / (0.5 * ended);
  const auto law = [&](std::array<double, 2> p) {
    if (detail::parameters(family) == 1) p[1] = 0;
    return detail::law_at(family, p, low * (1 - 1e-12), 10 * high);
  };
  const auto loss = [&](const std::array<double, 2>& p) {
    const double extra = detail::parameters(family) == 1 ? p[1] * p[1] : 0;  // an unused variable is drawn to 0
    const double l = -log_likelihood(law(p), lengths, meeting) + extra;
    return std::isfinite(l) ? l : 1e300;
  };
  const std::array<double, 2> best = detail::minimum(detail::start_of(family, mean), loss);
  Fit fit = law(best);
  for (const auto& p : detail::one_error_away(best, static_cast<std::size_t>(detail::parameters(family)), loss)) {
    const Fit moved = law(p);
    fit.moved.push_back({moved.a, moved.b});
  }
  fit.log_likelihood = log_likelihood(fit, lengths, meeting);
  fit.aic = 2 * detail::parameters(family) - 2 * fit.log_likelihood;
  std::vector<double> complete;
  for (const SeenLength& l : lengths) {
    if (l.ends == 2) complete.push_back(l.length);
  }
  if (!complete.empty()) fit.distance = distance_of(std::move(complete), fit);
  return fit;
}

Estimate over(const Estimate& a, const Estimate& b, std::string name, std::string method) {
  Estimate e{std::move(name),
             {},
             0,
             INFINITY,
             std::move(method),
             a.value && (bounded(a) || !b.note.empty()) ? b.note : a.note};
  if (!a.value || !b.value || !(*b.value > 0)) return e;
  e.value = *a.value * (1 / *b.value);
  const auto half = [](double one, double two) { return std::exp(std::hypot(std::log(one), std::log(two))); };
  e.low = a.low > 0 && std::isfinite(b.high) ? *e.value / half(*a.value / a.low, b.high / *b.value) : 0;
  e.high = *a.value > 0 && b.low > 0 ? *e.value * half(a.high / *a.value, *b.value / b.low) : INFINITY;
  return e;
}

double std_of(const Fit& fit) { return std::sqrt(std::max(0.0, fit.moment(2) - fit.moment(1) * fit.moment(1))); }

Estimate estimate_of(const Fit& fit, std::string name, const std::function<std::optional<double>(const Fit&)>& figure,
                     double confidence) {
  Estimate e{std::move(name),
             figure(fit),
             0,
             INFINITY,
             "maximum likelihood, delta method on the logarithm",
             "no interval: the likelihood has no curvature here"};
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
  if (std::isfinite(e.high)) e.note.clear();
  return e;
}

std::vector<Estimate> parameters_of(const Fit& fit, double confidence) {
  std::vector<Estimate> all;
  if (fit.family == Family::lognormal) {
    Estimate e{"a", fit.a, -INFINITY, INFINITY, "maximum likelihood, delta method", ""};
    if (!fit.moved.empty()) {
      double square = 0;
      for (const auto& [a, b] : fit.moved) square += (a - fit.a) * (a - fit.a);
      const double half = normal_quantile(0.5 + confidence / 2) * std::sqrt(square);
      e.low = fit.a - half;
      e.high = fit.a + half;
    }
    all.push_back(std::move(e));
  } else {
    all.push_back(estimate_of(fit, "a", [](const Fit& f) { return f.a; }, confidence));
  }
  if (detail::parameters(fit.family) == 2) {
    all.push_back(estimate_of(fit, "b", [](const Fit& f) { return f.b; }, confidence));
  }
  return all;
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
  result.p_low = special::chi_squared_above(result.statistic, std::max(1.0, most - detail::parameters(fit.family)));
  return result;
}

}  // namespace cleave::survey
