#include "cleave/survey/traces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "cleave/core/overloaded.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"
#include "ratio.hpp"

namespace cleave::survey {
namespace {

/// a b - c d with one rounding error at most, and the sign always right (Kahan).
double exact_sign_difference(double a, double b, double c, double d) {
  const double w = c * d, error = std::fma(-c, d, w);
  return std::fma(a, b, -w) + error;
}
double exact_sign_cross(MapPoint a, MapPoint b) { return exact_sign_difference(a.x, b.y, a.y, b.x); }

double distance(MapPoint a, MapPoint b) { return std::hypot(a.x - b.x, a.y - b.y); }
MapPoint between(MapPoint a, MapPoint b, double t) { return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}; }

/// Where segment a-b crosses the border, as shares of it, ascending.
std::vector<double> cuts(const Window& window, MapPoint a, MapPoint b) {
  std::vector<double> t;
  std::visit(overloaded{
                 [&](const CircleWindow& w) {
                   const MapPoint d = b - a, f = a - w.centre;
                   const double p = d.x * d.x + d.y * d.y, q = f.x * d.x + f.y * d.y;
                   const double r = f.x * f.x + f.y * f.y - w.radius * w.radius;
                   const double root = q * q - p * r;
                   if (p == 0 || root <= 0) return;
                   for (const double s : {(-q - std::sqrt(root)) / p, (-q + std::sqrt(root)) / p}) {
                     if (s > 0 && s < 1) t.push_back(s);
                   }
                 },
                 [&](const PolygonWindow& w) {
                   const MapPoint d = b - a;
                   for (std::size_t i = 0, j = w.corners.size() - 1; i < w.corners.size(); j = i++) {
                     const MapPoint p = w.corners[j], e = w.corners[i] - p;
                     // Half-open at the edge's ends, so that a crossing at a corner counts once.
                     const double from = cross(d, p - a), to = cross(d, w.corners[i] - a);
                     if ((from >= 0) == (to >= 0)) continue;
                     const double s = cross(p - a, e) / cross(d, e);
                     if (s > 0 && s < 1) t.push_back(s);
                   }
                 },
             },
             window);
  std::ranges::sort(t);
  return t;
}

Estimate with_interval(std::string name, double value, double variation, double confidence, std::string method) {
  const double z = normal_quantile(0.5 + confidence / 2) * variation;
  return {std::move(name), value, value * std::exp(-z), value * std::exp(z), std::move(method), ""};
}
Estimate not_estimable(std::string name, std::string method, std::string note) {
  return {std::move(name), {}, 0, 0, std::move(method), std::move(note)};
}
double number(std::uint64_t n) { return static_cast<double>(n); }

}  // namespace

Estimate detail::ratio_of_sums(std::string name, double value, double variance, std::size_t count, double confidence,
                               std::string method) {
  constexpr double rounding = 1e-12;
  if (count < 2 || !(variance > rounding)) {
    return {std::move(name),
            value,
            0,
            INFINITY,
            std::move(method),
            count < 2 ? "no interval: one trace says nothing of how others scatter"
                      : "no interval: the traces are all alike and say nothing of how others scatter"};
  }
  const double n = number(count);
  const double half = special::student_t_quantile(0.5 + confidence / 2, n - 1) * std::sqrt(variance * n / (n - 1));
  return {std::move(name), value, value * std::exp(-half), value * std::exp(half), std::move(method), ""};
}

namespace {

/// Sum over traces of (x_i/x - m_i/m)^2: the squared coefficient of variation of x/m.
double ratio_variance(double xx, double xm, double x, double mm, double m) {
  return std::max(0.0, xx / (x * x) - 2 * xm / (x * m) + mm / (m * m));
}

}  // namespace

double area_of(const Window& window) noexcept {
  return std::visit(overloaded{
                        [](const CircleWindow& w) { return std::numbers::pi * w.radius * w.radius; },
                        [](const PolygonWindow& w) {
                          double sum = 0;
                          for (std::size_t i = 1; i + 1 < w.corners.size(); ++i) {
                            sum += cross(w.corners[i] - w.corners[0], (w.corners[i + 1] - w.corners[0]));
                          }
                          return std::abs(sum) / 2;
                        },
                    },
                    window);
}

bool holds(const Window& window, MapPoint p) noexcept {
  return std::visit(overloaded{
                        [&](const CircleWindow& w) { return distance(p, w.centre) < w.radius; },
                        [&](const PolygonWindow& w) {
                          bool inside = false;
                          for (std::size_t i = 0, j = w.corners.size() - 1; i < w.corners.size(); j = i++) {
                            const MapPoint a = w.corners[i] - p, b = w.corners[j] - p;
                            const double side = exact_sign_cross(a, b);
                            if (side == 0 && a.x * b.x <= 0 && a.y * b.y <= 0) return false;  // on the border
                            if ((a.y > 0) != (b.y > 0) && (side > 0) == (a.y < b.y)) inside = !inside;
                          }
                          return inside;
                        },
                    },
                    window);
}

double distance_to_border(const Window& window, MapPoint p) noexcept {
  return std::visit(overloaded{
                        [&](const CircleWindow& w) { return std::abs(distance(p, w.centre) - w.radius); },
                        [&](const PolygonWindow& w) {
                          double nearest = INFINITY;
                          for (std::size_t i = 0, j = w.corners.size() - 1; i < w.corners.size(); j = i++) {
                            const MapPoint along = w.corners[i] - w.corners[j], to = p - w.corners[j];
                            const double square = along.x * along.x + along.y * along.y;
                            const double share = square > 0 ? (to.x * along.x + to.y * along.y) / square : 0;
                            nearest = std::min(
                                nearest, distance(p, between(w.corners[j], w.corners[i], std::clamp(share, 0.0, 1.0))));
                          }
                          return nearest;
                        },
                    },
                    window);
}

double width_across(const Window& window, MapPoint direction) noexcept {
  return std::visit(overloaded{
                        [](const CircleWindow& w) { return 2 * w.radius; },
                        [&](const PolygonWindow& w) {
                          double low = INFINITY, high = -INFINITY;
                          for (const MapPoint p : w.corners) {
                            const double s = cross(direction, p);
                            low = std::min(low, s);
                            high = std::max(high, s);
                          }
                          return high - low;
                        },
                    },
                    window);
}

double chord_through(const Window& window, MapPoint inside, MapPoint direction) {
  double far = 0;  // beyond the window from any point in it
  std::visit(overloaded{
                 [&](const CircleWindow& w) { far = 3 * w.radius; },
                 [&](const PolygonWindow& w) {
                   for (const MapPoint p : w.corners) far = std::max(far, distance(p, inside));
                   far *= 1.5;
                 },
             },
             window);
  const MapPoint ahead{inside.x + far * direction.x, inside.y + far * direction.y},
      behind{inside.x - far * direction.x, inside.y - far * direction.y};
  const std::vector<double> to = cuts(window, inside, ahead), back = cuts(window, inside, behind);
  return to.empty() || back.empty() ? 0 : far * (to.front() + back.front());
}

namespace {

/// Ends that the border has cut off, though no crossing of it is found there: a map that was cut along it has its ends
/// on this side or that by rounding.
std::uint32_t cut_off_ends(const Window& window, const Polyline& line, double border,
                           std::span<const MapPoint> crossed) {
  std::uint32_t ends = 0;
  for (const MapPoint end : {line.front(), line.back()}) {
    if (distance_to_border(window, end) > border) continue;
    const bool found =
        std::ranges::any_of(crossed, [&](MapPoint c) { return distance(c, end) <= 2 * border; }) && !holds(window, end);
    ends += found ? 0U : 1U;
  }
  return ends;
}

}  // namespace

std::vector<SeenTrace> seen_through(const Window& window, std::span<const Polyline> traces, double border) {
  const auto seen_end = [&](MapPoint p) {
    return holds(window, p) && (border <= 0 || distance_to_border(window, p) > border) ? 1U : 0U;
  };
  std::vector<SeenTrace> seen;
  for (std::size_t number = 0; number < traces.size(); ++number) {
    const Polyline& line = traces[number];
    SeenTrace trace{.trace = number, .direction = {}};
    double whole = 0, longest = 0;
    MapPoint along{};
    std::vector<MapPoint> crossed;
    for (std::size_t i = 1; i < line.size(); ++i) {
      const double length = distance(line[i - 1], line[i]);
      whole += length;
      if (length > longest) {
        longest = length;
        along = line[i] - line[i - 1];
      }
      if (length == 0) continue;
      std::vector<double> t = cuts(window, line[i - 1], line[i]);
      trace.crossings += static_cast<std::uint32_t>(t.size());
      for (const double share : t) crossed.push_back(between(line[i - 1], line[i], share));
      t.insert(t.begin(), 0);
      t.push_back(1);
      for (std::size_t k = 1; k < t.size(); ++k) {
        if (holds(window, between(line[i - 1], line[i], (t[k - 1] + t[k]) / 2)))
          trace.length += (t[k] - t[k - 1]) * length;
      }
    }
    if (!(whole > 0) || !(trace.length > 0)) continue;
    trace.ends = seen_end(line.front()) + seen_end(line.back());
    if (border > 0) trace.crossings += cut_off_ends(window, line, border, crossed);
    MapPoint d = line.back() - line.front();
    if (std::hypot(d.x, d.y) < 1e-6 * whole) d = along;
    const double norm = std::hypot(d.x, d.y);
    trace.direction = {d.x / norm, d.y / norm};
    seen.push_back(trace);
  }
  return seen;
}

namespace {
double perimeter_of(const Window& window) {
  if (const auto* circle = std::get_if<CircleWindow>(&window)) return 2 * std::numbers::pi * circle->radius;
  const auto& corners = std::get<PolygonWindow>(window).corners;
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) sum += norm(corners[(i + 1) % corners.size()] - corners[i]);
  return sum;
}
}  // namespace

CutOffEnds cut_off_by_border(const Window& window, std::span<const Polyline> traces) {
  CutOffEnds cut;
  if (traces.size() > 20000) return cut;
  const double size = std::sqrt(area_of(window)), rounding = 1e-5 * size, farthest = 0.03 * size;
  constexpr double alarm = 8;  // logarithm of the likelihood ratio
  std::vector<double> near;
  std::size_t farther = 0;
  for (const Polyline& line : traces) {
    if (line.empty()) continue;
    for (const MapPoint end : {line.front(), line.back()}) {
      if (!holds(window, end)) continue;
      const double distance = distance_to_border(window, end);
      if (distance <= farthest) near.push_back(distance);
      farther += distance > farthest ? 1U : 0U;
    }
  }
  std::ranges::sort(near);
  const double strip = perimeter_of(window) * farthest;
  const double rate =
      std::max(1.0, number(farther)) / std::max(0.1 * size * size, size * size - strip) * perimeter_of(window);
  // The strip in which chance is the worst explanation (scan statistic of Kulldorff 1997).
  double worst = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const double n = number(i + 1), by_chance = rate * std::max(near[i], rounding);
    const double ratio = n > by_chance ? n * std::log(n / by_chance) - (n - by_chance) : 0;
    const bool rounded = near[i] <= rounding;
    if (!(ratio > worst) || (!rounded && ratio < alarm)) continue;
    worst = ratio;
    cut = {i + 1, metres(near[i]), by_chance, metres(std::max(10 * rounding, 1.5 * near[i]))};
  }
  return cut;
}

WindowCounts count(const Window& window, std::span<const SeenTrace> seen) {
  WindowCounts c;
  c.area = area_of(window);
  double weighted = 0;
  for (const SeenTrace& t : seen) {
    (t.ends == 0 ? c.n0 : t.ends == 1 ? c.n1 : c.n2) += 1;
    c.crossings += t.crossings;
    c.length += t.length;
    c.sum_length2 += t.length * t.length;
    c.sum_length_ends += t.length * t.ends;
    c.sum_crossings2 += static_cast<double>(t.crossings) * t.crossings;
    c.sum_crossings_ends += static_cast<double>(t.crossings) * t.ends;
    weighted += t.length * width_across(window, t.direction);
  }
  if (c.length > 0) c.width = weighted / c.length;
  if (const auto* circle = std::get_if<CircleWindow>(&window)) {
    c.radius = circle->radius;
    c.width = 2 * circle->radius;
  } else {
    c.circle = false;
  }
  return c;
}

WindowCounts pooled(std::span<const WindowCounts> counts) {
  WindowCounts sum;
  for (const WindowCounts& c : counts) {
    sum.n0 += c.n0;
    sum.n1 += c.n1;
    sum.n2 += c.n2;
    sum.crossings += c.crossings;
    sum.length += c.length;
    sum.area += c.area;
    sum.width += c.width;
    sum.sum_length2 += c.sum_length2;
    sum.sum_length_ends += c.sum_length_ends;
    sum.sum_crossings2 += c.sum_crossings2;
    sum.sum_crossings_ends += c.sum_crossings_ends;
    sum.circle = sum.circle && c.circle;
    sum.radius += c.radius;
  }
  return sum;
}

Estimate p20(const WindowCounts& c, double confidence) {
  const double m = number(c.ends());
  if (m == 0) return not_estimable("P20", "m/(2A)", "no end of a trace lies inside: enlarge or pool windows");
  return with_interval("P20", m / (2 * c.area), std::sqrt(number(4 * c.n2 + c.n1)) / m, confidence, "m/(2A)");
}

Estimate p21(const WindowCounts& c, double confidence) {
  if (!(c.length > 0)) return not_estimable("P21", "S/A", "no trace meets the window");
  return with_interval("P21", c.length / c.area, std::sqrt(c.sum_length2) / c.length, confidence, "S/A");
}

Estimate p21_by_crossings(const WindowCounts& c, double confidence) {
  if (!c.circle) return not_estimable("P21", "x/(4R)", "only for circles");
  const double x = number(c.crossings);
  if (x == 0) return not_estimable("P21", "x/(4R)", "no trace crosses the circle");
  return with_interval("P21", x / (4 * c.radius), std::sqrt(c.sum_crossings2) / x, confidence, "x/(4R)");
}

Estimate mean_length(const WindowCounts& c, double confidence) {
  const double m = number(c.ends());
  if (m == 0)
    return not_estimable("mean trace length", "2S/m", "no end of a trace lies inside: enlarge or pool windows");
  const double square = ratio_variance(c.sum_length2, c.sum_length_ends, c.length, number(4 * c.n2 + c.n1), m);
  return detail::ratio_of_sums("mean trace length", 2 * c.length / m, square, c.traces(), confidence, "2S/m");
}

Estimate mean_length_by_counts(const WindowCounts& c, double confidence) {
  const char* const method = c.circle ? "(pi R/2) x/m" : "(A/b) x/m";
  const double m = number(c.ends()), x = number(c.crossings);
  if (m == 0 || x == 0) {
    return not_estimable(
        "mean trace length", method,
        m == 0 ? "no end of a trace lies inside: enlarge or pool windows" : "no trace reaches the border: use 2S/m");
  }
  const double square = ratio_variance(c.sum_crossings2, c.sum_crossings_ends, x, number(4 * c.n2 + c.n1), m);
  // Several circles: areas over widths are pooled by sums as well.
  Estimate e =
      detail::ratio_of_sums("mean trace length", c.area / c.width * x / m, square, c.traces(), confidence, method);
  if (e.note.empty() && (m < 10 || x < 10)) e.note = "few ends or crossings: the interval is rough";
  return e;
}

Estimate p20_plain(const WindowCounts& c, double confidence) {
  const double n = number(c.traces());
  if (n == 0) return not_estimable("P20", "N/A", "no trace meets the window");
  Estimate e = with_interval("P20", n / c.area, 1 / std::sqrt(n), confidence, "N/A");
  e.note = "biased: counts what reaches in; for comparison only";
  return e;
}

}  // namespace cleave::survey
