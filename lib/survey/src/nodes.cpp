#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/survey/traces.hpp"

namespace cleave::survey {
namespace {

struct Segment {
  MapPoint a, b;
  std::size_t trace;
};
double low(const Segment& s) { return std::min(s.a.x, s.b.x); }
double high(const Segment& s) { return std::max(s.a.x, s.b.x); }

MapPoint between(MapPoint a, MapPoint b, double t) { return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}; }
double distance(MapPoint a, MapPoint b) { return std::hypot(a.x - b.x, a.y - b.y); }
double away(MapPoint p, const Segment& s) {
  const MapPoint d = s.b - s.a;
  const double l2 = d.x * d.x + d.y * d.y;
  const MapPoint f = p - s.a;
  const double t = l2 > 0 ? std::clamp((f.x * d.x + f.y * d.y) / l2, 0.0, 1.0) : 0.0;
  return distance(p, between(s.a, s.b, t));
}

/// What one trace has a part in.
struct Part {
  std::array<bool, 2> abuts{false, false};  ///< its ends on others
  std::uint64_t met = 0;                    ///< by ends of others, inside the window
  std::uint64_t crossings = 0;
  std::uint64_t ends = 0, own = 0;  ///< inside the window; of them on others
};

/// From T = Y + X connections and m = I + Y ends; each trace is an independent piece, a crossing one of two of them:
/// the squares of the parts count the pair itself once too often.
Estimate connections_per_trace(const Nodes& n, const std::vector<Part>& parts, double confidence) {
  Estimate e{"connections per trace", {}, 0, 0, "4 (Y + X)/(I + Y), delta method", ""};
  const auto ends = static_cast<double>(n.isolated + n.abutting), nodes = static_cast<double>(n.abutting + n.crossing);
  if (!(ends > 0)) {
    e.note = "no end of a trace lies inside: enlarge or pool windows";
    return e;
  }
  e.value = 4 * nodes / ends;
  if (!(nodes > 0)) {  // none met: at most so many as Poisson's law allows
    e.high = 4 * -std::log((1 - confidence) / 2) / ends;
    return e;
  }
  double square = 0;
  for (const Part& p : parts) {
    const double off = static_cast<double>(p.met + p.own + p.crossings) / nodes - static_cast<double>(p.ends) / ends;
    square += off * off;
  }
  const double half = normal_quantile(0.5 + confidence / 2) * std::sqrt(std::max(square - 1 / nodes, 1 / nodes));
  e.low = *e.value * std::exp(-half);
  e.high = *e.value * std::exp(half);
  return e;
}

}  // namespace

Nodes nodes(const Window& window, std::span<const Polyline> traces, double tolerance, double confidence) {
  // Segments sorted by x, swept: pairs whose boxes overlap.
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < traces.size(); ++i) {
    for (std::size_t k = 1; k < traces[i].size(); ++k) segments.push_back({traces[i][k - 1], traces[i][k], i});
  }
  std::ranges::sort(segments, {}, low);
  std::vector<Part> parts(traces.size());
  std::vector<std::array<std::size_t, 2>> at(traces.size());  // the trace an end lies on
  Nodes result;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (std::size_t j = i + 1; j < segments.size() && low(segments[j]) <= high(segments[i]) + tolerance; ++j) {
      const Segment &s = segments[i], &t = segments[j];
      if (s.trace == t.trace) continue;
      if (std::max(s.a.y, s.b.y) + tolerance < std::min(t.a.y, t.b.y) ||
          std::max(t.a.y, t.b.y) + tolerance < std::min(s.a.y, s.b.y)) {
        continue;
      }
      bool touches = false;
      for (const auto& [own, other] : {std::pair{&s, &t}, std::pair{&t, &s}}) {
        const Polyline& line = traces[own->trace];
        for (const std::size_t end : {std::size_t{0}, std::size_t{1}}) {
          const MapPoint p = end == 0 ? line.front() : line.back();
          if (distance(p, own->a) > 0 && distance(p, own->b) > 0) continue;
          if (away(p, *other) > tolerance) continue;
          parts[own->trace].abuts.at(end) = true;
          at[own->trace].at(end) = other->trace;
          touches = true;
        }
      }
      if (touches) continue;
      const MapPoint d = s.b - s.a, e = t.b - t.a;
      const double det = cross(d, e);
      if (det == 0) continue;
      const double u = cross(t.a - s.a, e) / det, v = cross(t.a - s.a, d) / det;
      if (u < 0 || u >= 1 || v < 0 || v >= 1) continue;
      if (!holds(window, between(s.a, s.b, u))) continue;
      ++result.crossing;
      ++parts[s.trace].crossings;
      ++parts[t.trace].crossings;
    }
  }
  for (std::size_t i = 0; i < traces.size(); ++i) {
    if (traces[i].empty()) continue;
    for (const std::size_t end : {std::size_t{0}, std::size_t{1}}) {
      if (!holds(window, end == 0 ? traces[i].front() : traces[i].back())) continue;
      const bool abuts = parts[i].abuts.at(end);
      (abuts ? result.abutting : result.isolated) += 1;
      ++parts[i].ends;
      if (!abuts) continue;
      ++parts[i].own;
      ++parts[at[i].at(end)].met;
    }
  }
  result.connections = connections_per_trace(result, parts, confidence);
  return result;
}

MeanAxis mean_axis(std::span<const WeightedAxis> axes, double confidence) {
  constexpr double degrees = 180 / std::numbers::pi;
  MeanAxis mean{0,
                {"direction", {}, 0, 0, "axial mean by length, delta method", ""},
                {"alignment", {}, 0, 0, "resultant of the doubled angles by length, delta method", ""},
                {"kappa", {}, 0, 0, "2/-ln(alignment): scatter of the strikes of steep joints, delta method", ""}};
  double c = 0, s = 0, sum = 0, squares = 0;
  for (const auto& [angle, weight] : axes) {
    c += weight * std::cos(2 * angle);
    s += weight * std::sin(2 * angle);
    sum += weight;
    squares += weight * weight;
  }
  if (!(sum > 0)) {
    for (Estimate* e : {&mean.direction, &mean.alignment, &mean.kappa}) e->note = "no trace";
    return mean;
  }
  const double middle = std::atan2(s, c), r = std::min(1.0, std::hypot(c, s) / sum);
  double along = 0, across = 0;
  for (const auto& [angle, weight] : axes) {
    const double u = weight * (std::cos(2 * angle - middle) - r), v = weight * std::sin(2 * angle - middle);
    along += u * u;
    across += v * v;
  }
  // The mean was fitted to the same pieces.
  const double pieces = sum * sum / squares;
  const double z =
      pieces > 1 + 1e-9 ? normal_quantile(0.5 + confidence / 2) * std::sqrt(pieces / (pieces - 1)) / sum : INFINITY;
  const double turn = middle / 2 * degrees;
  mean.axis = turn;
  mean.direction.value = turn < 0 ? turn + 180 : turn;
  const double half = across > 0 && r > 0 ? std::min(90.0, z * std::sqrt(across) / r / 2 * degrees)
                      : pieces > 1        ? 0
                                          : 90;
  mean.direction.low = *mean.direction.value - half;
  mean.direction.high = *mean.direction.value + half;
  if (half >= 90) mean.direction.note = "any: no direction is preferred";
  mean.alignment.value = r;
  mean.alignment.low = 0;
  mean.alignment.high = 1;
  const bool parallel = r > 1 - 1e-9;
  if (!parallel) {
    const double off = z * std::sqrt(along) / (1 - r * r);
    mean.alignment.low = std::max(0.0, std::tanh(std::atanh(r) - off));
    mean.alignment.high = std::tanh(std::atanh(r) + off);
  }
  mean.kappa.high = INFINITY;
  if (parallel || !(r > 0)) {
    mean.kappa.value = parallel ? 1e6 : 0;
    mean.kappa.note = parallel ? "all traces are parallel" : "no direction is preferred";
    return mean;
  }
  mean.kappa.value = 2 / -std::log(r);
  const double off = z * std::sqrt(along) / (r * -std::log(r));
  mean.kappa.low = *mean.kappa.value * std::exp(-off);
  mean.kappa.high = *mean.kappa.value * std::exp(off);
  return mean;
}

}  // namespace cleave::survey
