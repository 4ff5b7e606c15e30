#include <algorithm>
#include <limits>

#include "cleave/scene2d/contact.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;

/// Component by component.
Vec2 times(Vec2 a, Vec2 b) { return {a.x * b.x, a.y * b.y}; }

/// Integral of a line from (0, a) to (1, b) between two shares of it.
Vec2 under_line(Vec2 a, Vec2 b, double from, double to) { return (to - from) * (a + 0.5 * (from + to) * (b - a)); }

}  // namespace

Vec2 GroundMotion::at(double t) const {
  if (record.empty()) return time(t) * amplitude;
  const double last = static_cast<double>(record.size() - 1);
  const double place = t / step.si();
  if (!(place >= 0) || place > last) return {};
  const auto k = std::min(static_cast<std::size_t>(place), record.size() - 1);
  const Vec2 next = k + 1 < record.size() ? record[k + 1] : record[k];
  return times(amplitude, record[k] + (place - static_cast<double>(k)) * (next - record[k]));
}

Vec2 GroundMotion::mean(double from, double to) const {
  if (record.empty()) return time.mean(from, to) * amplitude;
  const double last = static_cast<double>(record.size() - 1);
  const double a = std::clamp(from / step.si(), 0.0, last), b = std::clamp(to / step.si(), 0.0, last);
  Vec2 sum{};
  for (auto k = static_cast<std::size_t>(a); k + 1 < record.size() && static_cast<double>(k) < b; ++k) {
    const double start = static_cast<double>(k);
    sum += under_line(record[k], record[k + 1], std::max(a - start, 0.0), std::min(b - start, 1.0));
  }
  return times(amplitude, (step.si() / (to - from)) * sum);
}

Vec2 SupportMotion::velocity(Time at) const {
  const double t = at.si();
  if (is_velocity) return course.at(t);
  return t > 0 ? t * course.mean(0, t) : Vec2{};
}

Time GroundMotion::fastest() const {
  // Lines between values change within a few of them.
  return record.empty() ? Time::from_si(time.fastest()) : 4 * step;
}

}  // namespace cleave::scene
