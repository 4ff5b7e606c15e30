#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "cleave/exact/integer.hpp"

namespace cleave::geometry {

/// A closed ring of corners, by their numbers, from which ears are cut off one by one. What the corners are is the
/// caller's: `Corners::turn(i, j, k)` is the exact sign of three of them (positive: counter-clockwise), and
/// `Corners::ignored(a, b, c)` a predicate of the corners that do not bar the ear a, b, c, wherever they are.
template <class Corners>
class EarRing final {
 public:
  using Triangle = std::array<std::size_t, 3>;

  EarRing(std::vector<std::size_t> ring, const Corners& corners) : ring_{std::move(ring)}, corners_{corners} {}

  [[nodiscard]] std::size_t size() const noexcept { return ring_.size(); }
  [[nodiscard]] std::size_t before(std::size_t k) const { return ring_[k == 0 ? ring_.size() - 1 : k - 1]; }
  [[nodiscard]] std::size_t after(std::size_t k) const { return ring_[k + 1 == ring_.size() ? 0 : k + 1]; }
  /// The corner at place k between its neighbours.
  [[nodiscard]] Triangle triangle(std::size_t k) const { return {before(k), ring_[k], after(k)}; }
  [[nodiscard]] exact::Sign turn(std::size_t k) const { return corners_.turn(before(k), ring_[k], after(k)); }

  /// It turns left, and no other corner lies in its triangle or on the border of it.
  [[nodiscard]] bool is_ear(std::size_t k) const {
    if (turn(k) != exact::Sign::positive) return false;
    const auto [a, b, c] = triangle(k);
    const auto ignored = corners_.ignored(a, b, c);
    const auto left_of = [this](std::size_t i, std::size_t j, std::size_t p) {
      return corners_.turn(i, j, p) != exact::Sign::negative;
    };
    for (const std::size_t i : ring_) {
      if (!ignored(i) && left_of(a, b, i) && left_of(b, c, i) && left_of(c, a, i)) return false;
    }
    return true;
  }
  /// The first place at or behind `from`, once around, for which `wanted` holds.
  template <class Wanted>
  [[nodiscard]] std::optional<std::size_t> find(std::size_t from, Wanted&& wanted) const {
    for (std::size_t step = 0; step < ring_.size(); ++step) {
      const std::size_t k = (from + step) % ring_.size();
      if (wanted(k)) return k;
    }
    return std::nullopt;
  }
  /// Takes the corner at place k out; the triangle that is cut off.
  Triangle cut(std::size_t k) {
    const Triangle ear = triangle(k);
    ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(k));
    return ear;
  }

 private:
  std::vector<std::size_t> ring_;
  const Corners& corners_;
};

}  // namespace cleave::geometry
