#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "cleave/scene/bodies.hpp"

namespace cleave::scene {

double TimeFunction::operator()(double t) const {
  switch (kind) {
    case Kind::step: return 1;
    case Kind::ramp: return std::min(1.0, t / duration);
    case Kind::pulse: return t < duration / 2 ? 2 * t / duration : std::max(0.0, 2 - 2 * t / duration);
    case Kind::harmonic: return std::sin(2 * std::numbers::pi * frequency * t);
  }
  return 0;
}

double TimeFunction::mean(double from, double to) const {
  // Integral of a line of this slope and value at 0 over the part of the interval that lies in [low, high].
  const auto line = [&](double low, double high, double value, double slope) {
    const double a = std::max(from, low), b = std::min(to, high);
    return b > a ? (b - a) * (value + slope * (a + b) / 2) : 0.0;
  };
  constexpr double never = std::numeric_limits<double>::infinity();
  switch (kind) {
    case Kind::step: return 1;
    case Kind::ramp: return (line(0, duration, 0, 1 / duration) + line(duration, never, 1, 0)) / (to - from);
    case Kind::pulse:
      return (line(0, duration / 2, 0, 2 / duration) + line(duration / 2, duration, 2, -2 / duration)) / (to - from);
    case Kind::harmonic: {
      const double half = std::numbers::pi * frequency * (to - from);
      return (*this)(0.5 * (from + to)) * std::sin(half) / half;
    }
  }
  return 0;
}

double TimeFunction::fastest() const {
  switch (kind) {
    case Kind::step: break;
    case Kind::ramp:
    case Kind::pulse: return duration;
    case Kind::harmonic: return 1 / frequency;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace cleave::scene
