#include "cleave/survey/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "cleave/core/rng.hpp"

namespace cleave::survey {
namespace {

constexpr const char* note = "for comparison only";

Estimate nothing(std::string name, std::string method, const std::string& why) {
  return {std::move(name), {}, 0, 0, std::move(method), std::string{note} + ": " + why};
}
Estimate around(std::string name, double value, double variance, double confidence, std::string method,
                const std::string& why) {
  const double half = std::exp(normal_quantile(0.5 + confidence / 2) * std::sqrt(std::max(0.0, variance)));
  return {std::move(name), value, value / half, value * half, std::move(method), std::string{note} + ": " + why};
}
double number(std::uint64_t n) { return static_cast<double>(n); }

/// What the spread of seen lengths is made of, less one trace.
struct Sums {
  double n = 0, length = 0, squares = 0, ends = 0;
  void add(const SeenLength& l, double times) {
    n += times;
    length += times * l.length;
    squares += times * l.length * l.length;
    ends += times * l.ends;
  }
  [[nodiscard]] double mean() const { return 2 * length / ends; }
  [[nodiscard]] double std() const { return std::sqrt(std::max(0.0, squares / n - length / n * (length / n))); }
  [[nodiscard]] double variation() const { return std() * n / length; }
};

}  // namespace

Estimate mean_length_by_pahl(const WindowCounts& c, double confidence) {
  const char* const method = "A (1 + q)/(b (1 - q)), q = (n0 - n2)/(N + 1) (Pahl 1981, A.11)";
  if (c.traces() == 0) return nothing("mean trace length", method, "no trace meets the window");
  // N + 1 + n0 - n2 = 2 n0 + n1 + 1 over 2 n2 + n1 + 1; the counts are Poisson.
  const double x = number(2 * c.n0 + c.n1) + 1, m = number(c.ends()) + 1;
  const double variance =
      number(4 * c.n0 + c.n1) / (x * x) + number(4 * c.n2 + c.n1) / (m * m) - 2 * number(c.n1) / (x * m);
  return around("mean trace length", c.area / c.width * x / m, variance, confidence, method,
                "parallel traces, biased by the 1");
}

Estimate mean_length_by_number(const WindowCounts& c, double confidence) {
  const char* const method = "pi R S/(pi R N - 2 S) (A.13)";
  const double n = number(c.traces());
  if (!c.circle || n == 0) return nothing("mean trace length", method, "only for circles that traces meet");
  // 1/mean = N/S - b/A.
  const double rate = n / c.length - c.width / c.area;
  if (!(rate > 0)) return nothing("mean trace length", method, "the traces are too long for the circle");
  const double variance = (n * n * c.sum_length2 / (c.length * c.length) - n) / (c.length * c.length);
  return around("mean trace length", 1 / rate, variance / (rate * rate), confidence, method,
                "a difference of two figures of much the same size");
}

Estimate p20_by_midpoints(std::span<const SeenLength> lengths, const Fit& law, double area, double confidence) {
  const char* const method = "(n2 + sum of P(midpoint inside))/A (Kulatilake & Wu 1984, A.26)";
  double sum = 0, squares = 0;
  for (const auto& [l, ends] : lengths) {
    double inside = 1;
    // Of a trace with one end in sight the midpoint is seen when it is shorter than twice the piece; of one without,
    // the place of the piece on it is uniform: (L - l)+ places, min(l, L - l) of them about the middle.
    if (ends == 1) inside = (law.below(2 * l) - law.below(l)) / std::max(1 - law.below(l), 1e-300);
    if (ends == 0) inside = 1 - law.mean_excess(2 * l) / std::max(law.mean_excess(l), 1e-300);
    inside = std::clamp(inside, 0.0, 1.0);
    sum += inside;
    squares += inside * inside;
  }
  if (!(sum > 0)) return nothing("P20", method, "no midpoint can lie inside");
  return around("P20", sum / area, squares / (sum * sum), confidence, method, "parallel traces of a known law");
}

std::vector<Estimate> spread_as_measured(std::span<const SeenLength> lengths, const Chords& chords, double confidence) {
  Sums all;
  for (const SeenLength& l : lengths) all.add(l, 1);
  const auto estimate = [&](std::string name, std::string method, const std::string& why,
                            const std::function<std::optional<double>(const Sums&)>& figure) {
    const auto value = all.ends > 0 && all.n > 2 ? figure(all) : std::nullopt;
    if (!value || !(*value > 0)) return nothing(std::move(name), std::move(method), "no such law or too few traces");
    double variance = 0;
    for (const SeenLength& l : lengths) {
      Sums rest = all;
      rest.add(l, -1);
      const auto without = rest.ends > 0 ? figure(rest) : std::nullopt;
      if (without && *without > 0) variance += std::pow(std::log(*without / *value), 2);
    }
    return around(std::move(name), *value, variance, confidence, std::move(method), why);
  };
  const auto sizes = [&](const Sums& s) {
    return size_law(Family::lognormal, s.mean(), s.mean() * s.mean() * (1 + s.variation() * s.variation()), chords);
  };
  const std::string pieces = "pieces cut off by the window pass for whole traces",
                    by_variation = "coefficient of variation as measured (Zhang & Einstein 2000)";
  return {estimate("standard deviation of the trace lengths", "as measured (Kulatilake et al. 1993)", pieces,
                   [](const Sums& s) { return std::optional{s.std()}; }),
          estimate("standard deviation of the trace lengths", by_variation, pieces,
                   [](const Sums& s) { return std::optional{s.mean() * s.variation()}; }),
          estimate("mean of lognormal sizes", by_variation, pieces,
                   [&](const Sums& s) {
                     const auto law = sizes(s);
                     return law ? std::optional{law->mean} : std::nullopt;
                   }),
          estimate("standard deviation of lognormal sizes", by_variation, pieces, [&](const Sums& s) {
            const auto law = sizes(s);
            return law ? std::optional{law->std} : std::nullopt;
          })};
}

double textbook_p_value(double distance, std::size_t n) {
  const double root = std::sqrt(static_cast<double>(n)), x = (root + 0.12 + 0.11 / root) * distance;
  if (!(x > 0.2)) return 1;  // the series below is 1 to 1e-12 there
  double p = 0, sign = 2;
  for (int k = 1; k <= 100; ++k) {
    const double term = std::exp(-2 * k * k * x * x);
    p += sign * term;
    if (term < 1e-17) break;
    sign = -sign;
  }
  return std::clamp(p, 0.0, 1.0);
}

}  // namespace cleave::survey
