#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/scene2d/contact.hpp"

namespace cleave::scene {

/// Where the bodies of a run were, in up to 40 spans of time of equal length, which doubles as the run grows: whether a
/// body goes on moving at the end of a run is told from it, however long the run, and whether it was gone on with.
struct MotionTrail {
  /// Least and greatest of a body in a span, from its place at the start (m): x, y, and its turn at half its size.
  static constexpr std::size_t parts = 6;
  struct Span {
    std::uint64_t at = 0;       ///< from `at` times `length` on
    std::vector<double> reach;  ///< body by body
  };
  double length = 0;  ///< of a span, s
  std::vector<Span> spans;

  /// The places after a step, of all bodies; the first sets the length of the spans.
  void note(double time, std::span<const ContactBodyResult> bodies, std::span<const ContactPlacement> places);
  /// Of a body that has `speed` at the end: how fast it came to where it had not been, in the last tenth of the time
  /// (m/s). Empty: it rests, swings about its place, or comes to rest.
  [[nodiscard]] std::optional<double> goes_on(std::size_t body, double size, double speed, double time) const;
};

}  // namespace cleave::scene
