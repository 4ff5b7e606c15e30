#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "cleave/exact/integer.hpp"

namespace cleave::exact {

/// A site of the lattice. Invariant (kept by Lattice): |coordinates| <= 2^47.
struct LatticePoint {
  std::int64_t x = 0, y = 0, z = 0;
  friend constexpr auto operator<=>(const LatticePoint&, const LatticePoint&) = default;
  friend constexpr LatticePoint operator-(LatticePoint a, LatticePoint b) noexcept {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend constexpr LatticePoint operator+(LatticePoint a, LatticePoint b) noexcept {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
};

/// Integer lattice around a scene's own origin: position = origin + pitch * site, pitch a power of two.
class Lattice final {
 public:
  /// Covers the box [lo, hi] (m, finite, lo <= hi): pitch = the power of two for which the half extent is at most 2^46
  /// sites, origin = the box's centre rounded to a coarse power of two. Symmetric boxes about 0 keep their symmetry.
  [[nodiscard]] static Lattice covering(const std::array<double, 3>& lo, const std::array<double, 3>& hi) noexcept;

  [[nodiscard]] double pitch() const noexcept { return pitch_; }
  [[nodiscard]] const std::array<double, 3>& origin() const noexcept { return origin_; }
  /// Nearest site (ties to even). Precondition: inside the covered box grown by its own size.
  [[nodiscard]] LatticePoint snap(double x, double y, double z) const noexcept;
  /// Metres relative to the origin.
  [[nodiscard]] std::array<double, 3> relative(LatticePoint p) const noexcept {
    return {static_cast<double>(p.x) * pitch_, static_cast<double>(p.y) * pitch_, static_cast<double>(p.z) * pitch_};
  }
  [[nodiscard]] std::array<double, 3> position(LatticePoint p) const noexcept {
    const auto r = relative(p);
    return {origin_[0] + r[0], origin_[1] + r[1], origin_[2] + r[2]};
  }

 private:
  Lattice(double pitch, std::array<double, 3> origin) noexcept : pitch_{pitch}, origin_{origin} {}
  double pitch_;
  std::array<double, 3> origin_;
};

/// A plane through three lattice points: n . x + d = 0 with integer coefficients that are never rounded.
///
/// Invariant: the normal is not zero and its three components have no common factor. `n` has at most 97 bits, `d` at
/// most 146. `approx` are the same four numbers times one power of two, so that the largest |n| is in [1, 2) and
/// positions are in units of 2^48 sites; the normal with a relative error of at most 2^-52, d of at most 2^-51.
class Plane final {
 public:
  /// a, b, c turn counter-clockwise seen from the positive side. Empty when they lie on one line.
  [[nodiscard]] static std::optional<Plane> through(LatticePoint a, LatticePoint b, LatticePoint c) noexcept;
  /// Through `a` with the directions `u` and `v` (|components| <= 2^48); the positive side is that of u x v. Empty when
  /// parallel.
  [[nodiscard]] static std::optional<Plane> spanned(LatticePoint a, LatticePoint u, LatticePoint v) noexcept;

  /// From what `normal` and `offset` gave, as it was kept. Empty when they break the invariant.
  [[nodiscard]] static std::optional<Plane> of_coefficients(const std::array<Int128, 3>& normal,
                                                            const Int192& offset) noexcept;

  [[nodiscard]] const std::array<Int128, 3>& normal() const noexcept { return normal_; }
  [[nodiscard]] const Int192& offset() const noexcept { return offset_; }
  /// (n_x, n_y, n_z, d) scaled, see the class comment.
  [[nodiscard]] const std::array<double, 4>& approx() const noexcept { return approx_; }
  [[nodiscard]] Plane flipped() const noexcept;
  /// Unit normal in double, correct to a few ulp.
  [[nodiscard]] std::array<double, 3> unit_normal() const noexcept;

  /// Side of a lattice point; exact.
  [[nodiscard]] Sign side_of(LatticePoint p) const noexcept;
  /// Same set of points and same positive side.
  friend bool operator==(const Plane& a, const Plane& b) noexcept {
    return a.normal_ == b.normal_ && a.offset_ == b.offset_;
  }
  /// Same plane, either orientation.
  [[nodiscard]] bool coincides_with(const Plane& other) const noexcept;
  /// Normals parallel (same or opposite sense); exact.
  [[nodiscard]] bool parallel_to(const Plane& other) const noexcept;

 private:
  Plane() = default;
  void set_approx() noexcept;
  std::array<Int128, 3> normal_{};
  Int192 offset_{};
  std::array<double, 4> approx_{};
};

/// Sign of the determinant of the three normals (rows a, b, c); exact, filtered. (a x b) . c
[[nodiscard]] Sign orientation(const Plane& a, const Plane& b, const Plane& c) noexcept;

/// Sign of a . b; exact for components below 2^127 and products below 2^500.
[[nodiscard]] Sign dot_sign(const std::array<Int128, 3>& a, const std::array<Int128, 3>& b) noexcept;
/// The same for |a| < 2^100 and a site or a difference of sites, much faster.
[[nodiscard]] Sign dot_sign(const std::array<Int128, 3>& a, LatticePoint b) noexcept;

}  // namespace cleave::exact
