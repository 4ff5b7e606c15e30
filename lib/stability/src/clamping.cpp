#include "cleave/stability/strength.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace cleave::stability {
namespace {

using geometry::cross;
using geometry::dot;
using geometry::norm;
using geometry::Vec3;

/// Rows of a 3x3 matrix.
struct Matrix {
  std::array<Vec3, 3> rows{};
  /// += s a b'
  void add(double s, Vec3 a, Vec3 b) {
    rows[0] += s * a.x * b;
    rows[1] += s * a.y * b;
    rows[2] += s * a.z * b;
  }
  /// x of A x = b; empty where A is singular to rounding.
  [[nodiscard]] std::optional<Vec3> solve(Vec3 b) const {
    const Vec3 c12 = cross(rows[1], rows[2]), c20 = cross(rows[2], rows[0]), c01 = cross(rows[0], rows[1]);
    const double det = dot(rows[0], c12);
    const double size = norm(rows[0]) * norm(rows[1]) * norm(rows[2]);
    if (!(std::abs(det) > 1e-13 * size)) return std::nullopt;
    return (b.x * c12 + b.y * c20 + b.z * c01) / det;
  }
};

/// Rigid block on springs: those of the contacts, or of unit shear stiffness per area where they have none.
class Springs {
 public:
  Springs(std::span<const ClampedContact> contacts, Vec3 applied, double ratio, double factor,
          const PartialFactors& partial)
      : contacts_{contacts}, applied_{applied}, ratio_{ratio}, factor_{factor}, partial_{&partial} {
    size_ = norm(applied);
    for (const ClampedContact& c : contacts) {
      size_ += std::abs(c.normal) + norm(c.shear);
      stick(c, elastic_);
      open(c, elastic_);
    }
  }

  [[nodiscard]] double size() const noexcept { return size_; }

  /// Out-of-balance force at displacement u, N; `stiffness`: minus its derivative.
  [[nodiscard]] Vec3 force(Vec3 u, Matrix& stiffness) const {
    Vec3 sum = applied_;
    for (const ClampedContact& c : contacts_) {
      const double normal = c.normal - normal_of(c) * c.area * dot(u, c.inward);
      if (!(normal > 1e-12 * size_)) continue;
      open(c, stiffness);
      const Vec3 trial = c.shear - shear_of(c) * c.area * (u - dot(u, c.inward) * c.inward);
      const double most = cap(c, normal), tried = norm(trial);
      sum += normal * c.inward;
      if (tried <= most) {
        sum += trial;
        stick(c, stiffness);
        continue;
      }
      const Vec3 along = trial / tried;
      sum += most * along;
      // The strength falls with the normal force; its direction turns with the shear.
      const double step = 1e-6 * normal;
      stiffness.add((cap(c, normal + step) - most) / step * normal_of(c) * c.area, along, c.inward);
      const double turn = most / tried;
      Matrix part;
      stick(c, part);
      part.add(-shear_of(c) * c.area, along, along);
      for (std::size_t i = 0; i < 3; ++i) stiffness.rows[i] += turn * part.rows[i];
    }
    return sum;
  }

  [[nodiscard]] Vec3 elastic_step(Vec3 force) const {
    return elastic_.solve(force).value_or(force / stiffness_scale());
  }

 private:
  [[nodiscard]] double cap(const ClampedContact& c, double normal) const {
    double friction = 0, cohesion = 0;
    for (const auto& [joint, area] : c.strengths) {
      friction += joint->tan_friction(pascals(normal / c.area)) * area / c.area;
      cohesion += joint->cohesion().si() * area;
    }
    return (normal * friction / partial_->friction() + cohesion / partial_->cohesion()) / factor_;
  }
  [[nodiscard]] double normal_of(const ClampedContact& c) const {
    return c.stiffness ? c.stiffness->normal.si() : ratio_;
  }
  [[nodiscard]] static double shear_of(const ClampedContact& c) { return c.stiffness ? c.stiffness->shear.si() : 1; }
  static void stick(const ClampedContact& c, Matrix& to) {
    const double k = shear_of(c) * c.area;
    to.rows[0].x += k;
    to.rows[1].y += k;
    to.rows[2].z += k;
    to.add(-k, c.inward, c.inward);
  }
  void open(const ClampedContact& c, Matrix& to) const { to.add(normal_of(c) * c.area, c.inward, c.inward); }
  [[nodiscard]] double stiffness_scale() const {
    double sum = 0;
    for (const ClampedContact& c : contacts_) sum += normal_of(c) * c.area;
    return std::max(sum, std::numeric_limits<double>::min());
  }

  std::span<const ClampedContact> contacts_;
  Vec3 applied_;
  double ratio_, factor_;
  const PartialFactors* partial_;
  double size_ = 0;
  Matrix elastic_;
};

/// From u to where the force is `left`: Newton's method with shorter steps where the force does not fall, and the
/// first stiffness where that does not help.
bool settle(const Springs& springs, Vec3 left, Vec3& u) {
  constexpr int most = 60;
  const double close = 1e-11 * springs.size();
  Matrix stiffness;
  Vec3 force = springs.force(u, stiffness) - left;
  for (int pass = 0; pass < most; ++pass) {
    if (norm(force) <= close) return true;
    Vec3 next = u + springs.elastic_step(force);
    if (const auto step = stiffness.solve(force)) {
      double share = 1;
      for (int halving = 0; halving < 8; ++halving, share *= 0.5) {
        Matrix unused;
        const Vec3 there = u + share * *step;
        if (norm(springs.force(there, unused) - left) >= (1 - 0.1 * share) * norm(force)) continue;
        next = there;
        break;
      }
    }
    u = next;
    stiffness = {};
    force = springs.force(u, stiffness) - left;
    if (!geometry::is_finite(u)) return false;
  }
  return false;
}

}  // namespace

bool clamped_balances(std::span<const ClampedContact> contacts, Vec3 applied, double stiffness_ratio, double factor,
                      const PartialFactors& partial) {
  const Springs springs{contacts, applied, stiffness_ratio, factor, partial};
  Vec3 u;
  if (settle(springs, {}, u)) return true;
  // In small steps from rest: what is out of balance before the block moves is let go bit by bit.
  constexpr int steps = 16;
  Matrix unused;
  u = {};
  const Vec3 first = springs.force(u, unused);
  for (int i = 1; i <= steps; ++i) {
    if (!settle(springs, (1 - static_cast<double>(i) / steps) * first, u)) return false;
  }
  return true;
}

double clamped_factor(std::span<const ClampedContact> contacts, Vec3 applied, std::optional<double> stiffness_ratio,
                      const PartialFactors& partial) {
  constexpr std::array<double, 4> ratios{1, 10, 100, 1000};
  constexpr double largest = 0x1p30;
  double least = std::numeric_limits<double>::infinity();
  // With stiffnesses of their own the ratio has no meaning.
  if (!contacts.empty() && contacts.front().stiffness) stiffness_ratio = 1;
  for (const double ratio :
       stiffness_ratio ? std::span<const double>{&*stiffness_ratio, 1} : std::span<const double>{ratios}) {
    const auto holds = [&](double factor) { return clamped_balances(contacts, applied, ratio, factor, partial); };
    double low = 1, high = 1;
    while (low > 1 / largest && !holds(low)) low /= 2;
    if (!(low > 1 / largest)) return 0;
    if (low == 1) {
      while (high < largest && holds(2 * high)) high *= 2;
      if (high == largest) continue;
      low = high;
    }
    high = 2 * low;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      (holds(middle) ? low : high) = middle;
    }
    least = std::min(least, low);
  }
  return least;
}

}  // namespace cleave::stability
