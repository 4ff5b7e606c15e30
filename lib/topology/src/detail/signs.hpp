#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "cleave/exact/predicates.hpp"
#include "cleave/facets/prepared.hpp"

namespace cleave::topology::detail {

/// Exact signs for planes by number: filter first, integers when it cannot decide; counts both. Not for several threads
/// at once: each takes one of its own (`another`), and the counts are added up afterwards.
class Signs final {
 public:
  explicit Signs(const Prepared& prepared) noexcept : planes_{prepared.planes}, held_{&prepared.held} {}

  /// For the same planes, with nothing counted.
  [[nodiscard]] Signs another() const noexcept {
    Signs fresh = *this;
    fresh.calls_ = fresh.exact_ = 0;
    return fresh;
  }
  void add_counts(const Signs& other) noexcept {
    calls_ += other.calls_;
    exact_ += other.exact_;
  }

  [[nodiscard]] const exact::Plane& plane(Index p) const noexcept { return planes_[p]; }

  /// (nP x nQ) . nR, with `point` = meet(line_of(P, Q), R).
  [[nodiscard]] exact::Sign det3(const exact::PointApprox& point, Index p, Index q, Index r) noexcept {
    ++calls_;
    if (const auto sign = exact::det3_filtered(point)) return *sign;
    if (held_->any() && held_->common({p, q, r}, 2)) return exact::Sign::zero;  // they hold one line
    ++exact_;
    // Nearly always two of them are parallel, and two equal normals tell that faster than a determinant.
    if (planes_[q].parallel_to(planes_[r]) || planes_[p].parallel_to(planes_[r])) return exact::Sign::zero;
    return exact::det3_exact(planes_[p], planes_[q], planes_[r]);
  }
  [[nodiscard]] exact::Sign det3(Index p, Index q, Index r) noexcept {
    return det3(exact::meet(exact::line_of(planes_[p], planes_[q]), planes_[r]), p, q, r);
  }
  /// Side of plane s on which the meet of p, q, r lies; `point` is its approximation. The three planes must meet in one
  /// point.
  [[nodiscard]] exact::Sign side(const exact::PointApprox& point, Index p, Index q, Index r, Index s) noexcept {
    if (s == p || s == q || s == r) return exact::Sign::zero;
    ++calls_;
    if (const auto sign = exact::side_filtered(point, planes_[s])) return *sign;
    if (held_->any() && held_->common({p, q, r, s}, 1)) return exact::Sign::zero;
    ++exact_;
    return exact::side_exact(planes_[p], planes_[q], planes_[r], planes_[s]);
  }
  /// Relative to a half-space: positive = inside.
  [[nodiscard]] exact::Sign inside(const exact::PointApprox& point, Index p, Index q, Index r, HalfSpace h) noexcept {
    const exact::Sign s = side(point, p, q, r, h.plane);
    return h.inside_positive ? s : -s;
  }
  /// The line of p and q is parallel to s (det3 = 0): its side.
  [[nodiscard]] exact::Sign parallel_side(Index p, Index q, Index s) noexcept {
    if (s == p || s == q) return exact::Sign::zero;
    ++calls_;
    if (held_->any() && held_->common({p, q, s}, 2)) return exact::Sign::zero;
    ++exact_;
    return exact::side_of_parallel_line(planes_[p], planes_[q], planes_[s]);
  }

  /// Of two parallel lines, the meets of p, q and of r, s: do nP x nQ and nR x nS have the same sense?
  [[nodiscard]] bool same_sense(const exact::LineApprox& a, Index p, Index q, const exact::LineApprox& b, Index r,
                                Index s) noexcept {
    if (p == r && q == s) return true;
    ++calls_;
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (std::abs(b.m[k]) > std::abs(b.m[axis])) axis = k;
    }
    constexpr double bound = 64 * exact::unit_roundoff;  // the components' error is below 48 u
    if (std::abs(a.m[axis]) > bound && std::abs(b.m[axis]) > bound) return (a.m[axis] > 0) == (b.m[axis] > 0);
    ++exact_;
    return exact::same_sense_exact(planes_[p], planes_[q], planes_[r], planes_[s]);
  }
  [[nodiscard]] bool same_sense(Index p, Index q, const exact::LineApprox& b, Index r, Index s) noexcept {
    return same_sense(exact::line_of(planes_[p], planes_[q]), p, q, b, r, s);
  }

  [[nodiscard]] std::uint64_t calls() const noexcept { return calls_; }
  [[nodiscard]] std::uint64_t exact_calls() const noexcept { return exact_; }

 private:
  std::span<const exact::Plane> planes_;
  const HeldCorners* held_;
  std::uint64_t calls_ = 0, exact_ = 0;
};

}  // namespace cleave::topology::detail
