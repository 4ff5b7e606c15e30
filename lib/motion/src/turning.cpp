#include <algorithm>
#include <cmath>

#include "cleave/motion/world.hpp"

namespace cleave::motion {
namespace {

/// Solves the 3x3 system with these columns by Cramer's rule; zero where it is singular.
Vec3 solve3(Vec3 a, Vec3 b, Vec3 c, Vec3 right) noexcept {
  const Vec3 bc = cross(b, c);
  const double det = dot(a, bc);
  if (det == 0) return {};
  return Vec3{dot(right, bc), dot(a, cross(right, c)), dot(a, cross(b, right))} / det;
}

double largest(Vec3 v) noexcept { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

}  // namespace

Vec3 Turn::operator*(Vec3 v) const noexcept {
  const Vec3 u{x, y, z};
  const Vec3 t = 2 * cross(u, v);
  return v + w * t + cross(u, t);
}

Vec3 Turn::back(Vec3 v) const noexcept { return Turn{w, -x, -y, -z} * v; }

Turn operator*(Turn a, Turn b) noexcept {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + b.w * a.x + a.y * b.z - a.z * b.y,
          a.w * b.y + b.w * a.y + a.z * b.x - a.x * b.z, a.w * b.z + b.w * a.z + a.x * b.y - a.y * b.x};
}

Turn normalized(Turn t) noexcept {
  const double length = std::sqrt(t.w * t.w + t.x * t.x + t.y * t.y + t.z * t.z);
  return {t.w / length, t.x / length, t.y / length, t.z / length};
}

Turn cayley(Vec3 u) noexcept {
  const double s = 1 / std::sqrt(1 + 0.25 * dot(u, u));
  return {s, 0.5 * s * u.x, 0.5 * s * u.y, 0.5 * s * u.z};
}

Turn turn_by(Vec3 rotation) noexcept {
  const double angle = norm(rotation);
  if (angle == 0) return {};
  const double s = std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), s * rotation.x, s * rotation.y, s * rotation.z};
}

double angle_of(Turn t) noexcept { return 2 * std::atan2(norm(Vec3{t.x, t.y, t.z}), std::abs(t.w)); }

Vec3 solve(const Symmetric& j, Vec3 momentum) noexcept {
  return solve3({j.xx, j.xy, j.zx}, {j.xy, j.yy, j.yz}, {j.zx, j.yz, j.zz}, momentum);
}

Spinning drift(const Symmetric& j, const Spinning& start, double h) noexcept {
  // Implicit midpoint: 2 (J w - P0) + h w x J w = 0, then P1 = cay(h w)^T P0 (Newton in w).
  Vec3 w = solve(j, start.momentum);
  const double enough = 1e-16 * largest(w);
  for (int round = 0; round < 30 && largest(w) > 0; ++round) {
    const Vec3 jw = j * w;
    const Vec3 off = 2 * (jw - start.momentum) + h * cross(w, jw);
    const auto column = [&](Vec3 e) { return 2 * (j * e) + h * (cross(w, j * e) + cross(e, jw)); };
    const Vec3 change = solve3(column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 1}), -off);
    w += change;
    if (largest(change) <= enough) break;
  }
  const Turn step = cayley(h * w);
  return {start.turn * step, step.back(start.momentum)};
}

}  // namespace cleave::motion
