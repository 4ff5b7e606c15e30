#include "motion_trail.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace cleave::scene {
namespace {

constexpr std::size_t most_spans = 40;
// Of what a body at rest does: contacts are closed within 1e-9 of its size, and it sleeps below 1e-7 m/s.
constexpr double least_way = 1e-7;    // of its size
constexpr double least_speed = 1e-6;  // m/s

using Parts = std::array<double, MotionTrail::parts>;
constexpr double far_off = std::numeric_limits<double>::infinity();
constexpr Parts nowhere{far_off, -far_off, far_off, -far_off, far_off, -far_off};

void take(std::span<double> reach, std::span<const double> more) {
  for (std::size_t k = 0; k < reach.size(); k += 2) {
    reach[k] = std::min(reach[k], more[k]);
    reach[k + 1] = std::max(reach[k + 1], more[k + 1]);
  }
}

/// A way, by its parts: as bodies are said to have moved.
double way_of(double x, double y, double turn) { return std::hypot(x, y) + turn; }

/// How far `now` reaches beyond `before`.
double beyond(const Parts& now, const Parts& before) {
  const auto part = [&](std::size_t k) {
    if (now[k] > now[k + 1] || before[k] > before[k + 1]) return 0.0;
    return std::max({0.0, before[k] - now[k], now[k + 1] - before[k + 1]});
  };
  return way_of(part(0), part(2), part(4));
}
double width_of(const Parts& reach) {
  const auto part = [&](std::size_t k) { return std::max(0.0, reach[k + 1] - reach[k]); };
  return way_of(part(0), part(2), part(4));
}

}  // namespace

void MotionTrail::note(double time, std::span<const ContactBodyResult> bodies,
                       std::span<const ContactPlacement> places) {
  if (!(time > 0)) return;
  if (spans.empty()) {
    length = time;
    spans.push_back({.at = 0, .reach = std::vector<double>(parts * bodies.size(), 0.0)});
  }
  while (time / length >= static_cast<double>(most_spans)) {
    length *= 2;
    std::vector<Span> longer;
    for (Span& span : spans) {
      span.at /= 2;
      if (longer.empty() || longer.back().at != span.at) {
        longer.push_back(std::move(span));
      } else {
        take(longer.back().reach, span.reach);
      }
    }
    spans = std::move(longer);
  }
  // A step that ends with a span belongs to it.
  const auto at = static_cast<std::uint64_t>(std::max(0.0, std::ceil(time / length - 1e-9) - 1));
  std::vector<double> now(parts * bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const bem::Vec2 way = places[b].centroid - bodies[b].start;
    const double turn = places[b].rotation * bodies[b].size.si() / 2;
    const Parts reach{way.x, way.x, way.y, way.y, turn, turn};
    std::ranges::copy(reach, now.begin() + static_cast<std::ptrdiff_t>(parts * b));
  }
  if (at > spans.back().at) {
    spans.push_back({.at = at, .reach = std::move(now)});
  } else {
    take(spans.back().reach, now);
  }
}

std::optional<double> MotionTrail::goes_on(std::size_t body, double size, double speed, double time) const {
  if (spans.empty()) return std::nullopt;
  const double all = time / length;
  const auto tenth = static_cast<std::uint64_t>(std::max(1.0, std::round(all / 10)));
  const std::uint64_t end = spans.back().at + 1;
  const std::uint64_t last_from = end - std::min(end, tenth), before_from = end - std::min(end, 2 * tenth);
  Parts first = nowhere, before = nowhere, last = nowhere;
  for (const Span& span : spans) {
    take(span.at >= last_from     ? last
         : span.at >= before_from ? before
                                  : first,
         std::span{span.reach}.subspan(parts * body, parts));
  }
  const double gone_before = beyond(before, first);
  const double swing = width_of(before);
  take(first, before);
  const bool anywhere_before = first[0] <= first[1];
  const double gone = anywhere_before ? beyond(last, first) : width_of(last);
  const double last_time = time - static_cast<double>(last_from) * length;
  const double rate = gone / last_time;
  const double rate_before = gone_before / (static_cast<double>(tenth) * length);
  if (!(gone > least_way * size) || !(rate > least_speed)) return std::nullopt;
  if (rate < rate_before / 2) return std::nullopt;                       // it comes to rest
  if (gone < swing / 10) return std::nullopt;                            // it swings
  if (rate > 2 * rate_before && speed < rate / 10) return std::nullopt;  // it gave way once, and rests
  return rate;
}

}  // namespace cleave::scene
