#include "cleave/exact/predicates.hpp"

#include <cmath>
#include <optional>

#include "cleave/core/assert.hpp"
#include "cleave/exact/wide.hpp"

namespace cleave::exact {
namespace {

std::array<Int512, 3> wide_normal(const Plane& plane) noexcept {
  return {Int512{plane.normal()[0]}, Int512{plane.normal()[1]}, Int512{plane.normal()[2]}};
}

}  // namespace

ExactLine exact_line(const Plane& p, const Plane& q) noexcept {
  const auto a = wide_normal(p);
  const auto b = wide_normal(q);
  const Int512 d = widened(p.offset());
  const Int512 e = widened(q.offset());
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]},
          {d * b[0] - e * a[0], d * b[1] - e * a[1], d * b[2] - e * a[2]}};
}

ExactPoint exact_meet(const ExactLine& line, const Plane& r) noexcept {
  const auto n = wide_normal(r);
  const Int512 d = widened(r.offset());
  const auto& m = line.m;
  const auto& w = line.w;
  return {{n[1] * w[2] - n[2] * w[1] - d * m[0], n[2] * w[0] - n[0] * w[2] - d * m[1],
           n[0] * w[1] - n[1] * w[0] - d * m[2]},
          m[0] * n[0] + m[1] * n[1] + m[2] * n[2]};
}

Sign det3_exact(const Plane& p, const Plane& q, const Plane& r) noexcept {
  const auto a = wide_normal(p);
  const auto b = wide_normal(q);
  const auto c = wide_normal(r);
  return sign_of<Int512>((a[1] * b[2] - a[2] * b[1]) * c[0] + (a[2] * b[0] - a[0] * b[2]) * c[1] +
                         (a[0] * b[1] - a[1] * b[0]) * c[2]);
}

namespace {

/// The meet of three planes, kept until other planes are asked for: where many planes meet in one point, the sides of
/// that point are asked for again and again. Each thread keeps its own.
const ExactPoint& kept_meet(const Plane& p, const Plane& q, const Plane& r) noexcept {
  struct Kept {
    Plane p, q, r;
    ExactLine line;
    ExactPoint point;
  };
  thread_local std::optional<Kept> kept;
  if (kept && kept->p == p && kept->q == q) {
    if (kept->r == r) return kept->point;
    kept->point = exact_meet(kept->line, r);
    kept->r = r;
    return kept->point;
  }
  const ExactLine line = exact_line(p, q);
  kept = Kept{p, q, r, line, exact_meet(line, r)};
  return kept->point;
}

}  // namespace

Sign side_exact(const Plane& p, const Plane& q, const Plane& r, const Plane& s) noexcept {
  const ExactPoint& point = kept_meet(p, q, r);
  const auto n = wide_normal(s);
  const Int512 value = n[0] * point.x[0] + n[1] * point.x[1] + n[2] * point.x[2] + widened(s.offset()) * point.w;
  return sign_of(value) * sign_of(point.w);
}

PointApprox refined_meet(const Plane& p, const Plane& q, const Plane& r) noexcept {
  const ExactPoint& exact = kept_meet(p, q, r);
  PointApprox point{{}, exact.w.convert_to<double>()};  // 343 bits fit a double's range
  int exponent = 0;
  std::frexp(point.w, &exponent);
  const int scale = -2 - exponent;
  point.w = std::ldexp(point.w, scale);
  for (std::size_t i = 0; i < 3; ++i) point.x[i] = std::ldexp(exact.x[i].convert_to<double>(), scale - 48);
  return point;
}

Sign side_of_parallel_line(const Plane& p, const Plane& q, const Plane& s) noexcept {
  // Nearly always one of the planes is parallel to S: equal normals (up to sign), and the offsets tell.
  for (const Plane* plane : {&p, &q}) {
    if (!plane->parallel_to(s)) continue;
    const bool same = plane->normal() == s.normal();
    const double own = same ? plane->approx()[3] : -plane->approx()[3];
    // Same power of two for both, and each good to 4 u of at most 3.
    if (const auto sign = sign_filtered(s.approx()[3] - own, 64 * unit_roundoff)) return *sign;
    return sign_of<Int512>(widened(s.offset()) - widened(same ? plane->offset() : -plane->offset()));
  }
  // x = nS x w - dS m equals -S(any point of the line) m there, so one non-zero component of m tells.
  const ExactLine line = exact_line(p, q);
  const ExactPoint point = exact_meet(line, s);
  std::size_t i = 0;
  while (i < 3 && line.m[i] == 0) ++i;
  CLEAVE_ASSERT(i < 3);  // else P and Q are parallel
  return -(sign_of(point.x[i]) * sign_of(line.m[i]));
}

bool same_sense_exact(const Plane& p, const Plane& q, const Plane& r, const Plane& s) noexcept {
  const ExactLine first = exact_line(p, q);
  const ExactLine second = exact_line(r, s);
  std::size_t k = 0;
  while (k < 2 && second.m[k] == 0) ++k;
  return (first.m[k] > 0) == (second.m[k] > 0);
}

std::array<double, 3> position_exact(const Plane& p, const Plane& q, const Plane& r) noexcept {
  const ExactPoint point = exact_meet(exact_line(p, q), r);
  std::array<double, 3> position{};
  for (std::size_t i = 0; i < 3; ++i) {
    // Numerator and denominator may have 343 bits: both fit a double's range.
    position[i] = std::ldexp(point.x[i].convert_to<double>() / point.w.convert_to<double>(), -48);
  }
  return position;
}

}  // namespace cleave::exact
