#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "cleave/core/special.hpp"
#include "cleave/survey/traces.hpp"
#include "maximum_likelihood.hpp"

/// Trace lengths of discs. With D = l cosh t the density, the probability of more than l and its integral are
///   E D g(l) = int l f(l cosh t) dt,   E D G(l) = int (l sinh t)^2 f dt,
///   E D int_l G = int (l/2) sinh t [(l cosh t)^2 gd t - l^2 sinh t] f dt,   gd t = atan sinh t = acos(1/cosh t),
/// t from 0 on: smooth and even in t, so the trapezoid rule converges faster than any power of its step.
namespace cleave::survey {
namespace {

constexpr double tiny = 1e-300;
constexpr std::size_t most_points = 400;

/// Density with its constants worked out once.
class Density final {
 public:
  explicit Density(const Fit& law) : law_{&law} {
    if (law.family == Family::gamma) constant_ = -special::log_gamma(law.a) - std::log(law.b);
  }
  [[nodiscard]] double operator()(double x) const {
    if (law_->family != Family::gamma) return law_->density(x);
    const double y = x / law_->b;
    return std::exp((law_->a - 1) * std::log(y) - y + constant_);
  }

 private:
  const Fit* law_;
  double constant_ = 0;
};

/// Diameters beyond which nothing is left that a double can see.
double upper_end(const Fit& law) {
  switch (law.family) {
    case Family::exponential: return 45 * law.a;
    case Family::lognormal: return std::exp(std::min(700.0, law.a + 8 * law.b));
    case Family::gamma: return law.b * (law.a + 12 * std::sqrt(law.a) + 45);
    case Family::power: return law.max;
    case Family::normal: return law.a + 9 * law.b;
  }
  std::unreachable();
}

/// Width of the law in the logarithm: what a step must resolve.
double log_width(const Fit& law) {
  switch (law.family) {
    case Family::exponential: return 1;
    case Family::lognormal: return law.b;
    case Family::gamma: return 1 / std::sqrt(1 + law.a);
    case Family::power: return 0.2;
    case Family::normal: return std::min(1.0, law.b / law.a);
  }
  std::unreachable();
}

/// sinh, cosh and gd of the trapezoid rule's points, for all lengths of one law.
struct Steps {
  double step = 0.1;
  std::vector<std::array<double, 3>> at;  ///< sinh, cosh, gd

  Steps(const Fit& law, double shortest) : step{std::clamp(0.35 * log_width(law), 0.01, 0.12)} {
    const double most = upper_end(law) / shortest;
    for (double t = 0;; t += step) {
      const double s = std::sinh(t), c = std::cosh(t);
      if (!at.empty() && c > most) break;
      at.push_back({s, c, std::atan(s)});
      if (at.size() > 4000) break;
    }
  }
};

/// What kind of seen length: density (2), probability of more (1), its integral (0); times E D.
double integral(const Density& f, const Steps& steps, double upper, double l, std::uint32_t ends) {
  double sum = 0;
  for (std::size_t i = 0; i < steps.at.size(); ++i) {
    const auto& [s, c, gd] = steps.at[i];
    if (l * c > upper) break;
    const double density = f(l * c);
    if (ends == 2) {
      sum += (i == 0 ? 0.5 : 1.0) * l * density;
    } else if (ends == 1) {
      sum += l * s * l * s * density;
    } else {
      sum += l / 2 * s * (l * c * l * c * gd - l * l * s) * density;
    }
  }
  return sum * steps.step;
}

/// Lengths and how often: those that were seen, or where they are many a grid between which the logarithms of what is
/// looked up are taken as straight.
struct Point {
  double length;
  std::array<double, 3> weight;  ///< by ends
};
std::vector<Point> points_of(const std::vector<SeenLength>& lengths, double low, double high) {
  std::vector<Point> points;
  if (lengths.size() <= most_points || !(high > low)) {
    for (const SeenLength& l : lengths) {
      Point p{l.length, {}};
      p.weight.at(std::min(l.ends, 2U)) = 1;
      points.push_back(p);
    }
    return points;
  }
  const double step = std::log(high / low) / (most_points - 1);
  for (std::size_t i = 0; i < most_points; ++i) points.push_back({low * std::exp(step * static_cast<double>(i)), {}});
  for (const SeenLength& l : lengths) {
    const double at = std::clamp(std::log(l.length / low) / step, 0.0, static_cast<double>(most_points - 1) - 1e-9);
    const auto i = static_cast<std::size_t>(at);
    const double part = at - static_cast<double>(i);
    points[i].weight.at(std::min(l.ends, 2U)) += 1 - part;
    points[i + 1].weight.at(std::min(l.ends, 2U)) += part;
  }
  return points;
}

}  // namespace

double disc_trace_density(const Fit& diameters, double l) {
  return integral(Density{diameters}, {diameters, l}, upper_end(diameters), l, 2) / diameters.moment(1);
}
double disc_trace_above(const Fit& diameters, double l) {
  return integral(Density{diameters}, {diameters, l}, upper_end(diameters), l, 1) / diameters.moment(1);
}

double disc_chance(const Fit& diameters, const Meeting& meeting) {
  const double mean = diameters.moment(1), l0 = meeting.truncation;
  if (!(l0 > 0)) return meeting.chance(1, quarter_sine(2) * diameters.moment(2) / mean);
  const Density f{diameters};
  const Steps steps{diameters, l0};
  const double upper = upper_end(diameters);
  return meeting.chance(integral(f, steps, upper, l0, 1) / mean, integral(f, steps, upper, l0, 0) / mean);
}

namespace {

/// Logarithm of a law's relative spread, 0 where it has none of its own. The density of traces of equal discs has a
/// pole at their diameter: towards one size, that of the longest trace, the likelihood rises without end as the root of
/// 1/spread. Times the spread it does not.
double log_spread(const Fit& law) {
  switch (law.family) {
    case Family::lognormal: return std::log(law.b);
    case Family::gamma: return -0.5 * std::log(law.a);
    case Family::normal: return std::log(law.b / law.a);
    case Family::exponential:
    case Family::power: return 0;
  }
  std::unreachable();
}

/// No maximum in between: a spread below 2 % of the size or beyond all that joints can have.
bool at_bounds(const Fit& law) {
  constexpr double least = 0.02, most = 4;
  const double spread = std::exp(log_spread(law));
  return (law.family == Family::lognormal || law.family == Family::gamma) && !(spread > least && spread < most);
}

}  // namespace

std::optional<Fit> fit_discs(std::span<const SeenLength> all, const Meeting& meeting, Family family) {
  std::vector<SeenLength> lengths;
  double sum = 0, ended = 0, low = INFINITY, high = 0;
  for (const SeenLength& l : all) {
    if (!(l.length > 0) || l.length < meeting.truncation) continue;
    lengths.push_back(l);
    sum += l.length;
    ended += l.ends;
    low = std::min(low, l.length);
    high = std::max(high, l.length);
  }
  if (!(ended > 0) || (family == Family::power && !(high > low))) return std::nullopt;
  const std::vector<Point> points = points_of(lengths, low, high);
  const auto number = static_cast<double>(lengths.size());
  const auto log_likelihood = [&](const Fit& law) -> double {
    const double mean = law.moment(1), upper = upper_end(law);
    if (!std::isfinite(mean) || !(mean > 0)) return -INFINITY;
    const double l0 = meeting.truncation;
    const Steps steps{law, l0 > 0 ? std::min(l0, low) : low};
    const Density f{law};
    double value = 0;
    for (const Point& p : points) {
      for (std::uint32_t ends = 0; ends < 3; ++ends) {
        const double weight = p.weight.at(ends);
        if (weight == 0) continue;
        value += weight * std::log(std::max(integral(f, steps, upper, p.length, ends) / mean, tiny));
      }
    }
    const double above = l0 > 0 ? integral(f, steps, upper, l0, 1) / mean : 1;
    const double excess = l0 > 0 ? integral(f, steps, upper, l0, 0) / mean : quarter_sine(2) * law.moment(2) / mean;
    return value - number * std::log(std::max(meeting.chance(above, excess), tiny));
  };
  const auto law = [&](std::array<double, 2> p) {
    if (detail::parameters(family) == 1) p[1] = 0;
    return detail::law_at(family, p, low * (1 - 1e-12), 10 * high);
  };
  const auto loss = [&](const std::array<double, 2>& p) {
    const double extra = detail::parameters(family) == 1 ? p[1] * p[1] : 0;  // an unused variable is drawn to 0
    const double l = -log_likelihood(law(p)) + extra - log_spread(law(p));
    return std::isfinite(l) ? l : 1e300;
  };
  const std::array<double, 2> best = detail::minimum(detail::start_of(family, sum / (0.5 * ended)), loss);
  Fit fit = law(best);
  if (at_bounds(fit)) return std::nullopt;
  for (const auto& p : detail::one_error_away(best, static_cast<std::size_t>(detail::parameters(family)), loss)) {
    const Fit moved = law(p);
    fit.moved.push_back({moved.a, moved.b});
  }
  fit.log_likelihood = log_likelihood(fit);
  fit.aic = 2 * detail::parameters(family) - 2 * fit.log_likelihood;
  return fit;
}

}  // namespace cleave::survey
