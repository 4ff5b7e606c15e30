#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "cleave/scene/time_course.hpp"

namespace cleave::scene {

using geometry::Vec3;

double TimeFunction::operator()(double t) const {
  const double lasts = duration.si();
  switch (kind) {
    case Kind::step: return 1;
    case Kind::ramp: return std::min(1.0, t / lasts);
    case Kind::pulse: return t < lasts / 2 ? 2 * t / lasts : std::max(0.0, 2 - 2 * t / lasts);
    case Kind::harmonic: return std::sin(2 * std::numbers::pi * frequency.si() * t);
  }
  return 0;
}

double TimeFunction::mean(double from, double to) const {
  const double lasts = duration.si();
  // Integral of a line of this slope and value at 0 over the part of the interval that lies in [low, high].
  const auto line = [&](double low, double high, double value, double slope) {
    const double a = std::max(from, low), b = std::min(to, high);
    return b > a ? (b - a) * (value + slope * (a + b) / 2) : 0.0;
  };
  constexpr double never = std::numeric_limits<double>::infinity();
  switch (kind) {
    case Kind::step: return 1;
    case Kind::ramp: return (line(0, lasts, 0, 1 / lasts) + line(lasts, never, 1, 0)) / (to - from);
    case Kind::pulse: return (line(0, lasts / 2, 0, 2 / lasts) + line(lasts / 2, lasts, 2, -2 / lasts)) / (to - from);
    case Kind::harmonic: {
      const double half = std::numbers::pi * frequency.si() * (to - from);
      return (*this)(0.5 * (from + to)) * std::sin(half) / half;
    }
  }
  return 0;
}

Time TimeFunction::fastest() const {
  switch (kind) {
    case Kind::step: break;
    case Kind::ramp:
    case Kind::pulse: return duration;
    case Kind::harmonic: return Time::from_si(1 / frequency.si());
  }
  return Time::from_si(std::numeric_limits<double>::infinity());
}

namespace {

/// Component by component.
Vec2 times(Vec2 a, Vec2 b) { return {a.x * b.x, a.y * b.y}; }
Vec3 times(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

/// Integral of a line from (0, a) to (1, b) between two shares of it.
template <class V>
V under_line(V a, V b, double from, double to) {
  return (to - from) * (a + 0.5 * (from + to) * (b - a));
}

}  // namespace

template <class V>
V TimeCourse<V>::at(double t) const {
  if (record.empty()) return time(t) * amplitude;
  const double last = static_cast<double>(record.size() - 1);
  const double place = t / step.si();
  if (!(place >= 0) || place > last) return {};
  const auto k = std::min(static_cast<std::size_t>(place), record.size() - 1);
  const V next = k + 1 < record.size() ? record[k + 1] : record[k];
  return times(amplitude, record[k] + (place - static_cast<double>(k)) * (next - record[k]));
}

template <class V>
V TimeCourse<V>::mean(double from, double to) const {
  if (record.empty()) return time.mean(from, to) * amplitude;
  const double last = static_cast<double>(record.size() - 1);
  const double a = std::clamp(from / step.si(), 0.0, last), b = std::clamp(to / step.si(), 0.0, last);
  V sum{};
  for (auto k = static_cast<std::size_t>(a); k + 1 < record.size() && static_cast<double>(k) < b; ++k) {
    const double start = static_cast<double>(k);
    sum += under_line(record[k], record[k + 1], std::max(a - start, 0.0), std::min(b - start, 1.0));
  }
  return times(amplitude, (step.si() / (to - from)) * sum);
}

template <class V>
Time TimeCourse<V>::fastest() const {
  // Lines between values change within a few of them.
  return record.empty() ? time.fastest() : 4 * step;
}

template <class V>
Time TimeCourse<V>::end() const {
  if (!record.empty()) return static_cast<double>(record.size() - 1) * step;
  if (time.kind == TimeFunction::Kind::pulse) return time.duration;
  return Time::from_si(std::numeric_limits<double>::infinity());
}

template <class V>
double TimeCourse<V>::largest() const {
  if (record.empty()) return norm(amplitude);
  double out = 0;
  for (const V& value : record) out = std::max(out, norm(times(amplitude, value)));
  return out;
}

template struct TimeCourse<Vec2>;
template struct TimeCourse<Vec3>;

}  // namespace cleave::scene
