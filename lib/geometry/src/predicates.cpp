#include "cleave/geometry/predicates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace cleave::geometry {
namespace {

using exact::Sign;

/// a + b = high + low exactly.
struct Pair {
  double high, low;
};

Pair two_sum(double a, double b) noexcept {  // Knuth 1969; needs no order of a and b
  const double sum = a + b;
  const double b_virtual = sum - a;
  const double a_virtual = sum - b_virtual;
  return {sum, (a - a_virtual) + (b - b_virtual)};
}

Pair split(double a) noexcept {             // Veltkamp
  constexpr double splitter = 134217729.0;  // 2^27 + 1
  const double c = splitter * a;
  const double high = c - (c - a);
  return {high, a - high};
}

Pair two_product(double a, double b) noexcept {  // Dekker 1971; without fma, which the baseline machine lacks
  const double product = a * b;
  const Pair s = split(a);
  const Pair t = split(b);
  const double error = ((s.high * t.high - product) + s.high * t.low + s.low * t.high) + s.low * t.low;
  return {product, error};
}

/// An exact sum of at most N doubles that do not overlap, smallest first, zeros left out.
template <std::size_t N>
class Expansion final {
 public:
  void add(double value) noexcept {  // Shewchuk's grow-expansion
    std::size_t kept = 0;
    double carry = value;
    for (std::size_t i = 0; i < count_; ++i) {
      const Pair s = two_sum(carry, terms_[i]);
      carry = s.high;
      if (s.low != 0) terms_[kept++] = s.low;
    }
    if (carry != 0) terms_[kept++] = carry;
    count_ = kept;
  }
  void add_product(double a, double b) noexcept {
    const Pair p = two_product(a, b);
    add(p.low);
    add(p.high);
  }
  [[nodiscard]] Sign sign() const noexcept { return count_ == 0 ? Sign::zero : exact::sign_of(terms_[count_ - 1]); }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] double operator[](std::size_t i) const noexcept { return terms_[i]; }

 private:
  std::array<double, N> terms_{};
  std::size_t count_ = 0;
};

using Difference = Expansion<2>;

Difference difference(double a, double b) noexcept {
  const Pair s = two_sum(a, -b);
  Difference d;
  d.add(s.low);
  d.add(s.high);
  return d;
}

/// target += sign * a * b
template <std::size_t N, std::size_t A, std::size_t B>
void add_product(Expansion<N>& target, const Expansion<A>& a, const Expansion<B>& b, double sign) noexcept {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) target.add_product(sign * a[i], b[j]);
  }
}

Sign orient2d_exact(Vec2 a, Vec2 b, Vec2 c) noexcept {
  Expansion<16> det;
  add_product(det, difference(b.x, a.x), difference(c.y, a.y), 1);
  add_product(det, difference(b.y, a.y), difference(c.x, a.x), -1);
  return det.sign();
}

Sign orient3d_exact(Vec3 a, Vec3 b, Vec3 c, Vec3 d) noexcept {
  const std::array p{difference(b.x, a.x), difference(b.y, a.y), difference(b.z, a.z)};
  const std::array q{difference(c.x, a.x), difference(c.y, a.y), difference(c.z, a.z)};
  const std::array r{difference(d.x, a.x), difference(d.y, a.y), difference(d.z, a.z)};
  Expansion<192> det;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    Expansion<16> minor;
    add_product(minor, p[i], q[j], 1);
    add_product(minor, p[j], q[i], -1);
    add_product(det, minor, r[k], 1);
  }
  return det.sign();
}

bool opposite(Sign a, Sign b) noexcept { return a * b == Sign::negative; }

/// For p on the line through a and b: is it between them, ends included?
bool between(Vec2 p, Vec2 a, Vec2 b) noexcept {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

bool coplanar_segment_meets_triangle(Vec3 p, Vec3 q, Vec3 a, Vec3 b, Vec3 c) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    std::array t{drop(a, axis), drop(b, axis), drop(c, axis)};
    const Sign turn = orient2d(t[0], t[1], t[2]);
    if (turn == Sign::zero) continue;
    if (turn == Sign::negative) std::swap(t[1], t[2]);
    const Vec2 u = drop(p, axis);
    const Vec2 v = drop(q, axis);
    return in_closed_triangle(u, t[0], t[1], t[2]) || in_closed_triangle(v, t[0], t[1], t[2]) ||
           segments_meet(u, v, t[0], t[1]) || segments_meet(u, v, t[1], t[2]) || segments_meet(u, v, t[2], t[0]);
  }
  return false;
}

}  // namespace

int dominant_axis(Vec3 direction) noexcept {
  const double x = std::abs(direction.x);
  const double y = std::abs(direction.y);
  const double z = std::abs(direction.z);
  if (x >= y && x >= z) return 0;
  return y >= z ? 1 : 2;
}

exact::Sign orient2d(Vec2 a, Vec2 b, Vec2 c) noexcept {
  const double left = (b.x - a.x) * (c.y - a.y);
  const double right = (b.y - a.y) * (c.x - a.x);
  const double det = left - right;
  // Shewchuk's bound (3 + 16 eps) eps with eps = 2^-53, rounded up; the summand covers underflow.
  const double bound = 3.34e-16 * (std::abs(left) + std::abs(right)) + 1e-110;
  if (std::abs(det) > bound) return exact::sign_of(det);
  return orient2d_exact(a, b, c);
}

exact::Sign orient3d(Vec3 a, Vec3 b, Vec3 c, Vec3 d) noexcept {
  const Vec3 p = b - a;
  const Vec3 q = c - a;
  const Vec3 r = d - a;
  const double xy1 = p.x * q.y, xy2 = p.y * q.x;
  const double yz1 = p.y * q.z, yz2 = p.z * q.y;
  const double zx1 = p.z * q.x, zx2 = p.x * q.z;
  const double det = (yz1 - yz2) * r.x + (zx1 - zx2) * r.y + (xy1 - xy2) * r.z;
  const double permanent = (std::abs(yz1) + std::abs(yz2)) * std::abs(r.x) +
                           (std::abs(zx1) + std::abs(zx2)) * std::abs(r.y) +
                           (std::abs(xy1) + std::abs(xy2)) * std::abs(r.z);
  // Shewchuk's bound (7 + 56 eps) eps with eps = 2^-53, rounded up; the summand covers underflow.
  if (std::abs(det) > 7.78e-16 * permanent + 1e-160) return exact::sign_of(det);
  return orient3d_exact(a, b, c, d);
}

bool collinear(Vec3 a, Vec3 b, Vec3 c) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    if (orient2d(drop(a, axis), drop(b, axis), drop(c, axis)) != Sign::zero) return false;
  }
  return true;
}

bool segments_meet(Vec2 a, Vec2 b, Vec2 c, Vec2 d) noexcept {
  const Sign c_side = orient2d(a, b, c);
  const Sign d_side = orient2d(a, b, d);
  const Sign a_side = orient2d(c, d, a);
  const Sign b_side = orient2d(c, d, b);
  if (opposite(c_side, d_side) && opposite(a_side, b_side)) return true;
  return (c_side == Sign::zero && between(c, a, b)) || (d_side == Sign::zero && between(d, a, b)) ||
         (a_side == Sign::zero && between(a, c, d)) || (b_side == Sign::zero && between(b, c, d));
}

bool in_closed_triangle(Vec2 p, Vec2 a, Vec2 b, Vec2 c) noexcept {
  return orient2d(a, b, p) != Sign::negative && orient2d(b, c, p) != Sign::negative &&
         orient2d(c, a, p) != Sign::negative;
}

bool encloses(std::span<const Vec2> outline, Vec2 p) noexcept {
  bool in = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 a = outline[i], b = outline[i + 1 < outline.size() ? i + 1 : 0];
    if ((a.y > p.y) == (b.y > p.y)) continue;  // by crossings of the ray to the right
    if ((orient2d(a, b, p) == Sign::positive) == (b.y > a.y)) in = !in;
  }
  return in;
}

bool segment_meets_triangle(Vec3 p, Vec3 q, Vec3 a, Vec3 b, Vec3 c) noexcept {
  const Sign p_side = orient3d(a, b, c, p);
  const Sign q_side = orient3d(a, b, c, q);
  if (p_side == Sign::zero && q_side == Sign::zero) return coplanar_segment_meets_triangle(p, q, a, b, c);
  if (p_side == q_side) return false;
  // The line meets the plane in one point of the segment: is that point in the triangle?
  const std::array s{orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)};
  return !(opposite(s[0], s[1]) || opposite(s[1], s[2]) || opposite(s[2], s[0]));
}

}  // namespace cleave::geometry
