#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "cleave/exact/plane.hpp"

/// Signs of the 3x3 and 4x4 determinants of plane coefficients, in two stages that can be called one by one.
///
/// A point is the meet of three planes P, Q, R in homogeneous form: with m = nP x nQ and w = dP nQ - dQ nP,
///     x = nR x w - dR m,   W = m . nR   (the point is x / W),
/// and a plane S has the value nS . x + dS W = det4(P, Q, R, S) there, so that its side is the sign of that times the
/// sign of W.
///
/// First stage: doubles with a static error bound. u = 2^-53. Coefficients obey |n_i| < 2 (relative error 2u) and
/// |d| <= 3 (4u), because sites are at most 2^47 and positions are in units of 2^48. Products and sums then give
///     m: |.| <= 8,  error <= 48u     w: |.| <= 12, error <= 96u      x: |.| <= 72, error <= 912u
///     W: |.| <= 48, error <= 512u    value of S: |.| <= 576, error <= 10320u
/// Second stage: the same formulas in 512-bit integers (they need at most 443 bits).
namespace cleave::exact {

inline constexpr double unit_roundoff = 0x1p-53;
inline constexpr double det3_error_bound = 1024 * unit_roundoff;
inline constexpr double meet_error_bound = 1024 * unit_roundoff;  ///< of the components of x
inline constexpr double det4_error_bound = 16384 * unit_roundoff;

/// Empty when |value| does not exceed the bound: not decided, which is not the same as zero.
[[nodiscard]] inline std::optional<Sign> sign_filtered(double value, double bound) noexcept {
  if (value > bound) return Sign::positive;
  if (value < -bound) return Sign::negative;
  return std::nullopt;
}

/// Pluecker coordinates of the line of two planes; m is its direction, zero when they are parallel.
struct LineApprox {
  std::array<double, 3> m, w;
};
struct PointApprox {
  std::array<double, 3> x;
  double w;
};

[[nodiscard]] inline LineApprox line_of(const Plane& p, const Plane& q) noexcept {
  const auto& a = p.approx();
  const auto& b = q.approx();
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]},
          {a[3] * b[0] - b[3] * a[0], a[3] * b[1] - b[3] * a[1], a[3] * b[2] - b[3] * a[2]}};
}

[[nodiscard]] inline PointApprox meet(const LineApprox& line, const Plane& plane) noexcept {
  const auto& n = plane.approx();
  const auto& m = line.m;
  const auto& w = line.w;
  return {{(n[1] * w[2] - n[2] * w[1]) - n[3] * m[0], (n[2] * w[0] - n[0] * w[2]) - n[3] * m[1],
           (n[0] * w[1] - n[1] * w[0]) - n[3] * m[2]},
          m[0] * n[0] + m[1] * n[1] + m[2] * n[2]};
}

/// Sign of (nP x nQ) . nR.
[[nodiscard]] inline std::optional<Sign> det3_filtered(const PointApprox& point) noexcept {
  return sign_filtered(point.w, det3_error_bound);
}
[[nodiscard]] Sign det3_exact(const Plane& p, const Plane& q, const Plane& r) noexcept;

/// Side of S on which the meet of P, Q, R lies. Laws: zero iff the four planes share a point (or direction); turning P,
/// Q, R round or swapping two of them changes nothing; flipping S swaps the sides; zero when S is one of P, Q, R.
[[nodiscard]] inline std::optional<Sign> side_filtered(const PointApprox& point, const Plane& s) noexcept {
  const auto& n = s.approx();
  const double value = (n[0] * point.x[0] + n[1] * point.x[1] + n[2] * point.x[2]) + n[3] * point.w;
  const auto numerator = sign_filtered(value, det4_error_bound);
  if (!numerator) return std::nullopt;
  const auto denominator = sign_filtered(point.w, det3_error_bound);
  if (!denominator) return std::nullopt;
  return *numerator * *denominator;
}
/// Precondition: P, Q, R meet in one point.
[[nodiscard]] Sign side_exact(const Plane& p, const Plane& q, const Plane& r, const Plane& s) noexcept;

/// The same point as `meet`, from the integers: correct to 4 u of its size, with W between 1/8 and 1/4 of either sign,
/// so that inside the scene (|x| <= |W|) the bounds above hold by far. Precondition: P, Q, R meet in one point.
[[nodiscard]] PointApprox refined_meet(const Plane& p, const Plane& q, const Plane& r) noexcept;

/// Of two parallel lines: do nP x nQ and nR x nS have the same sense?
[[nodiscard]] bool same_sense_exact(const Plane& p, const Plane& q, const Plane& r, const Plane& s) noexcept;
/// The meet of three planes in units of 2^48 sites, from the integers: correct to about 2^-51 of its size.
[[nodiscard]] std::array<double, 3> position_exact(const Plane& p, const Plane& q, const Plane& r) noexcept;
/// The same in double where the proven error is below 2^-44, from the integers otherwise; `point` is their `meet`.
/// Precondition: the planes meet in one point.
[[nodiscard]] inline std::array<double, 3> meet_position(const PointApprox& point, const Plane& p, const Plane& q,
                                                         const Plane& r) noexcept {
  constexpr double w_min = 0x1p-2;  // error <= (1024 u + |x| 1024 u) / |W|, and |x| <= 1/2
  if (std::abs(point.w) >= w_min) return {point.x[0] / point.w, point.x[1] / point.w, point.x[2] / point.w};
  return position_exact(p, q, r);
}

/// Where P and Q's line runs parallel to S (their det3 is zero): the side of S on which the line lies, zero when it
/// lies in S. Precondition: P and Q are not parallel.
[[nodiscard]] Sign side_of_parallel_line(const Plane& p, const Plane& q, const Plane& s) noexcept;

}  // namespace cleave::exact
