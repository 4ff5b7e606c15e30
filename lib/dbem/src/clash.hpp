#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact_candidate.hpp"

/// Overlaps of outlines as they lie: what every step is judged by. Shares nothing with the search for contacts.
namespace cleave::dbem {

/// An outline for the check.
struct Solid {
  std::span<const Vec2> corners;
  Box2 box;
  bool convex;
};

/// How deep two outlines overlap, m; at most `enough` may be missing. Convex ones: the least move that parts them (the
/// best of the lines along their edges). Others: how deep the outline of one lies in the other, at corners and midway
/// between crossings; no more than the least move that parts them, and no less than a quarter of the radius of a disc
/// that fits into both.
[[nodiscard]] double clash_depth(const Solid& a, const Solid& b, double enough);

/// Bodies in the order of their boxes along one axis, kept from call to call: a step changes little of it.
class Sweep final {
 public:
  /// Pairs (a < b, in order) whose boxes share more than a line; pairs of two `idle` bodies are left out.
  [[nodiscard]] std::vector<BodyPair> pairs(std::span<const Box2> boxes, std::span<const std::uint8_t> idle);

 private:
  std::vector<std::uint32_t> order_;
  double Vec2::* along_ = &Vec2::x;
  double Vec2::* across_ = &Vec2::y;
  void choose_axis(std::span<const Box2> boxes);
};

}  // namespace cleave::dbem
