#pragma once

#include <cstdint>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/core/vec2.hpp"
#include "cleave/geometry/vec3.hpp"

/// What changes with time, as scenes of all kinds state it.
namespace cleave::scene {

using Rate = Quantity<0, 0, -1>;  ///< 1/s

/// Factor of a load against time; times in s from the start of the run.
struct TimeFunction {
  enum class Kind : std::uint8_t { step, ramp, pulse, harmonic };
  Kind kind = Kind::step;
  Time duration;   ///< ramp to 1, triangular pulse to 1 and back
  Rate frequency;  ///< of a sine
  [[nodiscard]] double operator()(double t) const;
  [[nodiscard]] double mean(double from, double to) const;  ///< exact; from < to
  [[nodiscard]] Time fastest() const;                       ///< in which it changes; infinite: it does not
};

/// A vector over time, such as an acceleration (m/s2): V is Vec2 or geometry::Vec3. Times in s from the start of the
/// run.
template <class V>
struct TimeCourse {
  V amplitude{};  ///< of `time`; of a record, component by component
  TimeFunction time;
  /// Values at equal steps from 0 on, lines between them, nothing after the last; empty: `time`.
  std::vector<V> record;
  Time step;  ///< of the record
  [[nodiscard]] V at(double t) const;
  [[nodiscard]] V mean(double from, double to) const;  ///< exact; from < to
  [[nodiscard]] Time fastest() const;                  ///< in which it changes; infinite: it does not
  [[nodiscard]] Time end() const;                      ///< zero from then on; infinite: never
  [[nodiscard]] double largest() const;                ///< no less than the length of any value
};
extern template struct TimeCourse<Vec2>;
extern template struct TimeCourse<geometry::Vec3>;

}  // namespace cleave::scene
