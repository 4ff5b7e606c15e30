#pragma once

#include <array>
#include <cstdint>

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

}  // namespace cleave::exact
