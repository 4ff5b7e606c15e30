#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"
#include "cleave/survey/traces.hpp"
#include "disc_fit.hpp"
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
    case Family::constant: return law.a;
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
    case Family::constant: return 1;
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

/// Of discs that are all of one size, in closed form.
double of_one_size(double diameter, double l, std::uint32_t ends) {
  if (!(l < diameter)) return 0;
  const double x = l / diameter, root = std::sqrt((1 - x) * (1 + x));
  return ends == 2 ? x / (diameter * root) : ends == 1 ? root : diameter / 2 * (std::acos(x) - x * root);
}

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
  if (diameters.family == Family::constant) return of_one_size(diameters.a, l, 2);
  return integral(Density{diameters}, {diameters, l}, upper_end(diameters), l, 2) / diameters.moment(1);
}
double disc_trace_above(const Fit& diameters, double l) {
  if (diameters.family == Family::constant) return of_one_size(diameters.a, l, 1);
  return integral(Density{diameters}, {diameters, l}, upper_end(diameters), l, 1) / diameters.moment(1);
}

double disc_chance(const Fit& diameters, const Meeting& meeting) {
  const double mean = diameters.moment(1), l0 = meeting.truncation;
  if (!(l0 > 0)) return meeting.chance(1, quarter_sine(2) * diameters.moment(2) / mean);
  if (diameters.family == Family::constant) {
    return meeting.chance(of_one_size(diameters.a, l0, 1), of_one_size(diameters.a, l0, 0));
  }
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
    case Family::power:
    case Family::constant: return 0;
  }
  std::unreachable();
}

constexpr double least_spread = 0.02, most_spread = 4;
/// No maximum in between: a spread below 2 % of the size or beyond all that joints can have.
bool at_bounds(const Fit& law) {
  const double spread = std::exp(log_spread(law));
  return (law.family == Family::lognormal || law.family == Family::gamma) &&
         !(spread > least_spread && spread < most_spread);
}

/// Scale of the gamma law of shape exp(`log_shape`) that is likeliest, by golden section: E D^2/E D, which the traces
/// tell well, is that of `best` to within a factor of 3.
template <class Loss>
std::array<double, 2> best_scale(double log_shape, const Fit& best, const Loss& loss) {
  constexpr double golden = 0.6180339887498949, precise = 1e-3;
  const double middle = std::log(best.b * (best.a + 1) / (std::exp(log_shape) + 1));
  double low = middle - std::log(3), high = middle + std::log(3);
  const auto at = [&](double log_scale) { return loss(std::array{log_shape, log_scale}); };
  double left = high - golden * (high - low), right = low + golden * (high - low);
  double at_left = at(left), at_right = at(right);
  while (high - low > precise) {
    if (at_left < at_right) {
      high = std::exchange(right, left);
      at_right = at_left;
      left = high - golden * (high - low);
      at_left = at(left);
    } else {
      low = std::exchange(left, right);
      at_left = at_right;
      right = low + golden * (high - low);
      at_right = at(right);
    }
  }
  return {log_shape, (low + high) / 2};
}

/// The narrowest and the widest gamma law whose loss is above that of `best` by no more than `allowed`.
template <class Loss>
std::array<double, 2> narrower_gamma(const std::array<double, 2>& best, const Fit& law, double allowed,
                                     const Loss& loss) {
  const double most = loss(best) + allowed;
  double low = best[0], high = best[0] + 8;
  for (int i = 0; i < 12; ++i) {
    const double middle = (low + high) / 2;
    (loss(best_scale(middle, law, loss)) <= most ? low : high) = middle;
  }
  return best_scale(low, law, loss);
}
template <class Loss>
std::array<double, 2> widest_gamma(const Fit& best, double allowed, const Loss& loss) {
  const double most = loss(std::array{std::log(best.a), std::log(best.b)}) + allowed;
  double low = -2 * std::log(most_spread), high = std::log(best.a);
  std::array<double, 2> widest = best_scale(low, best, loss);
  if (loss(widest) <= most) return widest;
  for (int i = 0; i < 10; ++i) {
    const double middle = (low + high) / 2;
    const std::array<double, 2> law = best_scale(middle, best, loss);
    (loss(law) <= most ? high : low) = middle;
    widest = law;
  }
  return widest;
}

/// What was seen of discs, without what is shorter than the truncation.
struct Seen {
  std::vector<Point> points;
  std::vector<SeenLength> lengths;
  double number = 0, sum = 0, ended = 0, low = INFINITY, high = 0;
};
Seen seen_of(std::span<const SeenLength> all, double truncation) {
  Seen seen;
  for (const SeenLength& l : all) {
    if (!(l.length > 0) || l.length < truncation) continue;
    seen.lengths.push_back(l);
    seen.sum += l.length;
    seen.ended += l.ends;
    seen.low = std::min(seen.low, l.length);
    seen.high = std::max(seen.high, l.length);
  }
  seen.points = points_of(seen.lengths, seen.low, seen.high);
  seen.number = static_cast<double>(seen.lengths.size());
  return seen;
}

double log_likelihood(const Fit& law, const Seen& seen, const Meeting& meeting) {
  const double mean = law.moment(1), upper = upper_end(law), l0 = meeting.truncation;
  if (!std::isfinite(mean) || !(mean > 0)) return -INFINITY;
  const Steps steps{law, l0 > 0 ? std::min(l0, seen.low) : seen.low};
  const Density f{law};
  double value = 0;
  for (const Point& p : seen.points) {
    for (std::uint32_t ends = 0; ends < 3; ++ends) {
      const double weight = p.weight.at(ends);
      if (weight == 0) continue;
      value += weight * std::log(std::max(integral(f, steps, upper, p.length, ends) / mean, tiny));
    }
  }
  const double above = l0 > 0 ? integral(f, steps, upper, l0, 1) / mean : 1;
  const double excess = l0 > 0 ? integral(f, steps, upper, l0, 0) / mean : quarter_sine(2) * law.moment(2) / mean;
  return value - seen.number * std::log(std::max(meeting.chance(above, excess), tiny));
}

/// How well ends of traces are placed, as a share of the size: what bounds the pole at one size. Lengths on it are
/// averaged over as much.
constexpr double placed = 0.0025;

double one_size_likelihood(double diameter, const Seen& seen, const Meeting& meeting) {
  Fit law;
  law.family = Family::constant;
  law.a = diameter;
  double value = -seen.number * std::log(std::max(disc_chance(law, meeting), tiny));
  const double off = placed * diameter;
  for (const SeenLength& l : seen.lengths) {
    const double least = l.length - off;
    const double v = l.ends == 2
                         ? (of_one_size(diameter, least, 1) - of_one_size(diameter, l.length + off, 1)) / (2 * off)
                     : l.length < diameter - off ? of_one_size(diameter, l.length, l.ends)
                                                 : of_one_size(diameter, least, l.ends);
    value += std::log(std::max(v, tiny));
  }
  return value;
}

/// Largest standard deviation of sizes about this one that the traces allow: lognormal laws of that spread, each with
/// its best mean, are no worse than the law of one size by more than the 5 % point of chi-squared allows.
double largest_spread(const Fit& one, const Seen& seen, const Meeting& meeting) {
  constexpr double allowed = 1.92;
  for (const double spread : {0.5, 0.4, 0.3, 0.25, 0.2, 0.16, 0.13, 0.1, 0.08, 0.06, 0.05, 0.04, 0.03}) {
    Fit law;
    law.family = Family::lognormal;
    law.b = std::sqrt(std::log1p(spread * spread));
    for (double shift = -1.5; shift <= 0.5; shift += 0.25) {
      law.a = std::log(one.a) + shift * spread;
      if (log_likelihood(law, seen, meeting) > one.log_likelihood - allowed) return 1.25 * spread * one.a;
    }
  }
  return 0.03 * one.a;
}

/// Posterior of the diameter with the prior 1/D, in D = longest (1 + w^2), but for the rounding: near w = 0 it is
/// smooth.
std::optional<Fit> fit_one_size(const Seen& seen, const Meeting& meeting) {
  constexpr int steps = 1500;
  constexpr double most = 5;
  const double longest = seen.high / (1 + placed);
  std::vector<double> diameters, logs;
  for (int i = 0; i < steps; ++i) {
    const double t = (i + 0.5) / steps, w = most * t * t, d = longest * (1 + w * w);
    diameters.push_back(d);
    logs.push_back(one_size_likelihood(d, seen, meeting) + std::log(w * t / d));
  }
  const double top = std::ranges::max(logs);
  if (!std::isfinite(top)) return std::nullopt;
  double sum = 0, first = 0, second = 0;
  for (int i = 0; i < steps; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double weight = std::exp(logs[at] - top), x = std::log(diameters[at] / longest);
    sum += weight;
    first += weight * x;
    second += weight * x * x;
  }
  Fit fit;
  fit.family = Family::constant;
  fit.b = 0;
  double below = 0;
  for (std::size_t i = 0; i < diameters.size() && below < sum / 2; ++i) {
    below += std::exp(logs[i] - top);
    fit.a = diameters[i];
  }
  const double spread = std::sqrt(std::max(0.0, second / sum - first * first / (sum * sum)));
  fit.moved.push_back({fit.a * std::exp(std::hypot(spread, placed)), 0});
  fit.log_likelihood = one_size_likelihood(fit.a, seen, meeting);
  fit.aic = 2 - 2 * fit.log_likelihood;
  fit.max = largest_spread(fit, seen, meeting);
  return fit;
}

}  // namespace

std::optional<Fit> fit_discs(std::span<const SeenLength> all, const Meeting& meeting, Family family) {
  const auto discs = detail::fit_discs_to_edges(all, meeting, family, 0.95);
  return discs && !discs->at_widest ? std::optional{discs->fit} : std::nullopt;
}

std::optional<detail::DiscFit> detail::fit_discs_to_edges(std::span<const SeenLength> all, const Meeting& meeting,
                                                          Family family, double confidence) {
  const Seen seen = seen_of(all, meeting.truncation);
  if (!(seen.ended > 0) || (family == Family::power && !(seen.high > seen.low))) return std::nullopt;
  if (family == Family::constant) {
    auto one = fit_one_size(seen, meeting);
    return one ? std::optional{DiscFit{*std::move(one)}} : std::nullopt;
  }
  const auto law = [&](std::array<double, 2> p) {
    if (detail::parameters(family) == 1) p[1] = 0;
    return detail::law_at(family, p, seen.low * (1 - 1e-12), 10 * seen.high);
  };
  const auto loss = [&](const std::array<double, 2>& p) {
    const double extra = detail::parameters(family) == 1 ? p[1] * p[1] : 0;  // an unused variable is drawn to 0
    const double l = -log_likelihood(law(p), seen, meeting) + extra - log_spread(law(p));
    return std::isfinite(l) ? l : 1e300;
  };
  std::array<double, 2> best = detail::minimum(detail::start_of(family, seen.sum / (0.5 * seen.ended)), loss);
  DiscFit discs{law(best)};
  Fit& fit = discs.fit;
  if (at_bounds(fit)) {
    if (family != Family::gamma || std::exp(log_spread(fit)) < most_spread) return std::nullopt;
    best = best_scale(-2 * std::log(most_spread), fit, loss);
    fit = law(best);
    discs.at_widest = true;
  } else if (family == Family::gamma) {
    const double z = normal_quantile(0.5 + confidence / 2);
    const auto [log_shape, log_scale] = widest_gamma(fit, z * z / 2, loss);
    discs.widest = {std::exp(log_shape), std::exp(log_scale)};
  }
  const auto moved = discs.at_widest
                         ? std::vector{narrower_gamma(best, fit, 0.5, loss)}
                         : detail::one_error_away(best, static_cast<std::size_t>(detail::parameters(family)), loss);
  for (const auto& p : moved) fit.moved.push_back({law(p).a, law(p).b});
  fit.log_likelihood = log_likelihood(fit, seen, meeting);
  fit.aic = 2 * detail::parameters(family) - 2 * fit.log_likelihood;
  return discs;
}

}  // namespace cleave::survey
